#include "common/quantile.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace omnitag {

double quantile(std::vector<double> sample, double share) {
  if (sample.empty()) return 0.0;
  std::sort(sample.begin(), sample.end());
  const auto last = static_cast<double>(sample.size() - 1);
  return sample[static_cast<std::size_t>(std::lround(share * last))];
}

}  // namespace omnitag
