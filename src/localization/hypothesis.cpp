#include "omnitag/localization/hypothesis.h"

namespace omnitag {

void Hypothesis::restart(const std::optional<PosePrior>& pose) {
  start = pose;
  start_error.setIdentity();
  log_of_carried = 0.0;
}

Hypothesis Hypothesis::carried(const Evidence& evidence, bool has_odometry) const {
  Hypothesis child = *this;
  child.log_of_carried += evidence.logOfCarried(has_odometry);
  return child;
}

Hypothesis Hypothesis::elsewhere(const Eigen::Isometry3d& motion, const Evidence& evidence) const {
  Hypothesis child = *this;
  child.memory.moveBy(motion, evidence.contradiction());
  child.start_error = motion * start_error;
  return child;
}

double Hypothesis::logProbability(const Evidence& evidence) const {
  double sum = log_of_carried + evidence.logOfPlaces(memory);
  if (start) sum += evidence.logOfStart(*start, start_error, memory.hasElsewhere());
  return sum;
}

}  // namespace omnitag
