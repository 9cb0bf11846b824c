#pragma once

#include <array>
#include <cstddef>

namespace omnitag {

/// The standard normal distribution from a table, linear in between: probabilities are off by less
/// than 4e-5, mostly in the tails.
class NormalDistribution {
 public:
  /// In standard deviations; the tails beyond are neglected.
  static constexpr double kReach = 4.0;

  struct Value {
    /// The probability of a smaller value, and its derivative.
    double probability;
    double density;
  };

  static const NormalDistribution& tabulated();

  Value at(double x) const {
    const double place = (x + kReach) * kPerUnit;
    if (!(place > 0.0)) return {0.0, 0.0};
    if (!(place < kSteps)) return {1.0, 0.0};
    const auto below = static_cast<std::size_t>(place);
    const double rise = table_[below + 1] - table_[below];
    return {table_[below] + (place - static_cast<double>(below)) * rise, rise * kPerUnit};
  }

 private:
  NormalDistribution();

  static constexpr double kPerUnit = 128.0;
  static constexpr int kSteps = 1024;
  std::array<double, kSteps + 1> table_{};
};

}  // namespace omnitag
