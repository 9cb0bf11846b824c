#pragma once

#include <chrono>
#include <cmath>
#include <optional>

namespace omnitag {

/// s, of a clock that nobody sets.
inline double steadyTime() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Notices when a clock is set, as by NTP, against one that nobody sets.
class ClockWatch {
 public:
  /// s by which the clock was set since the call before, negative for back; 0 where it was not.
  /// Takes both clocks' readings of the same moment, in s.
  double step(double clock, double steady) {
    const double offset = clock - steady;
    const double change = last_offset_ ? offset - *last_offset_ : 0.0;
    last_offset_ = offset;
    return std::abs(change) >= kLeastStep ? change : 0.0;
  }

 private:
  /// s: less than what makes an image late; more than what passes between two readings and than
  /// what a clock that is merely adjusted gains.
  static constexpr double kLeastStep = 0.01;

  std::optional<double> last_offset_;
};

}  // namespace omnitag
