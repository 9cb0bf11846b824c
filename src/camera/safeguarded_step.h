#pragma once

namespace omnitag {

/// Next position of a Newton iteration for a function that grows from negative to positive between
/// `low` and `high`; the interval is narrowed, and bisected if Newton leaves it.
inline double safeguardedStep(double position, double value, double derivative, double* low,
                              double* high) {
  (value < 0.0 ? *low : *high) = position;
  const double next = position - value / derivative;
  return next >= *low && next <= *high ? next : 0.5 * (*low + *high);
}

}  // namespace omnitag
