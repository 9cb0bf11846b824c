#pragma once

#include <algorithm>
#include <limits>

namespace omnitag {

/// The smallest and the largest of some values; empty at first.
struct Bounds {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  bool isEmpty() const { return !(low <= high); }
  void include(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

}  // namespace omnitag
