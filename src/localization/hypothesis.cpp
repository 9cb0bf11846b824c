#include "localization/hypothesis.h"

namespace omnitag {

void Hypothesis::restart(const std::optional<PosePrior>& pose) {
  start = pose;
  start_error.setIdentity();
  log_of_carried = 0.0;
  log_of_returned = 0.0;
}

bool Hypothesis::isWithinStart() const {
  constexpr double kFar = 4.0;  // standard deviations, exceeded once in a thousand
  return start && deviationsOfStart(*start, start_error) <= kFar;
}

double Hypothesis::logProbability(const Evidence& evidence) const {
  double sum = log_of_carried + log_of_returned + evidence.logOfPlaces(memory);
  if (start) sum += evidence.logOfStart(*start, start_error, memory.hasElsewhere());
  return sum;
}

}  // namespace omnitag
