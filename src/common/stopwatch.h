#pragma once

#include <chrono>
#include <utility>

namespace omnitag {

/// Measures wall-clock time from step to step.
class Stopwatch {
 public:
  /// Seconds since the start or the last call.
  double lap() {
    const Clock::time_point now = Clock::now();
    return std::chrono::duration<double>(now - std::exchange(start_, now)).count();
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

}  // namespace omnitag
