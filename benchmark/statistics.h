#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace omnitag {

/// The value that this share (0 to 1) of a sample does not exceed; 0 for an empty sample.
inline double quantile(std::vector<double> sample, double share) {
  if (sample.empty()) return 0.0;
  std::sort(sample.begin(), sample.end());
  return sample[static_cast<std::size_t>(share * static_cast<double>(sample.size() - 1))];
}

}  // namespace omnitag
