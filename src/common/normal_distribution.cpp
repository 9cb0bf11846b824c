#include "common/normal_distribution.h"

#include <cmath>

namespace omnitag {

NormalDistribution::NormalDistribution() {
  for (int i = 0; i <= kSteps; ++i) {
    const double x = i / kPerUnit - kReach;
    table_[static_cast<std::size_t>(i)] = 0.5 * std::erfc(-x / std::sqrt(2.0));
  }
}

const NormalDistribution& NormalDistribution::tabulated() {
  static const NormalDistribution table;
  return table;
}

}  // namespace omnitag
