#include "common/correlation_threshold.h"

#include <algorithm>
#include <cmath>

namespace omnitag {

double correlationThreshold(double dimensions, double rate) {
  if (dimensions <= 1.0) return 1.0;
  return std::sqrt(1.0 - std::min(1.0, std::pow(2.0 * rate, 2.0 / (dimensions - 1.0))));
}

}  // namespace omnitag
