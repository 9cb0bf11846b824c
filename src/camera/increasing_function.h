#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "camera/safeguarded_step.h"

namespace omnitag {

/// The value of a function of one variable and its derivative.
struct ValueAndSlope {
  double value;
  double slope;
};

/// Up to where a function grows: the last of evenly spaced positions in [0, end] before its value
/// or slope is not finite, or its slope not positive; 0 if it does not grow at all.
template <typename Function>
double increasingUpTo(const Function& function, double end) {
  constexpr int kSteps = 4096;
  double last = 0.0;
  for (int i = 0; i <= kSteps; ++i) {
    const double x = end * i / kSteps;
    const ValueAndSlope at = function(x);
    if (!(at.slope > 0.0 && std::isfinite(at.slope) && std::isfinite(at.value))) return last;
    last = x;
  }
  return last;
}

/// The inverse of a function that grows over [0, end], by a safeguarded Newton iteration that
/// starts from a table. `Function` maps x to a ValueAndSlope.
template <typename Function>
class InverseFunction {
 public:
  InverseFunction(Function function, double end) : function_(std::move(function)) {
    first_value_ = function_(0.0).value;
    value_step_ = (function_(end).value - first_value_) / (kSamples - 1);
    starts_.assign(kSamples, end);
    starts_.front() = 0.0;
    for (int i = 1; i + 1 < kSamples; ++i) {
      const auto index = static_cast<std::size_t>(i);
      starts_[index] = solve(first_value_ + i * value_step_, starts_[index - 1], 0.0, end);
    }
  }

  const Function& function() const { return function_; }

  /// The x at which the function has this value; the nearer end if it never does.
  double operator()(double value) const {
    const double position = (value - first_value_) / value_step_;
    if (!(position > 0.0)) return starts_.front();
    if (!(position < kSamples - 1)) return starts_.back();
    const auto below = static_cast<std::size_t>(position);
    const double low = starts_[below];
    const double high = starts_[below + 1];
    return solve(value, low + (position - static_cast<double>(below)) * (high - low), low, high);
  }

 private:
  static constexpr int kSamples = 256;

  double solve(double value, double start, double low, double high) const {
    // Newton doubles the digits with every step: one this small leaves an error at
    // machine precision.
    constexpr double kSmallStep = 1e-9;
    constexpr int kMaxIterations = 100;
    const double largest_x = starts_.back();
    double x = start;
    for (int i = 0; i < kMaxIterations; ++i) {
      const ValueAndSlope at = function_(x);
      const double next = safeguardedStep(x, at.value - value, at.slope, &low, &high);
      const double step = std::abs(next - x);
      x = next;
      if (!(step > kSmallStep * largest_x)) break;
    }
    return x;
  }

  Function function_;
  double first_value_ = 0.0;
  double value_step_ = 0.0;
  /// Positions at which the function has evenly spaced values, from its first to its last.
  std::vector<double> starts_;
};

}  // namespace omnitag
