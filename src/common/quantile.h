#pragma once

#include <vector>

namespace omnitag {

/// The value below which the share (0 to 1) of the sample lies; 0 for an empty one.
double quantile(std::vector<double> sample, double share);

}  // namespace omnitag
