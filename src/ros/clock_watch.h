#pragma once

#include <cmath>
#include <ctime>
#include <optional>

namespace omnitag {

/// s, by a clock that is never set and that also runs while the machine is suspended.
inline double steadyTime() {
  timespec now{};
  clock_gettime(CLOCK_BOOTTIME, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// A clock and steadyTime() at the same moment, s.
struct ClockReading {
  double clock = 0.0;
  double steady = 0.0;
};

/// Reads a clock together with steadyTime(). If the thread was interrupted in between, tries again,
/// a few times at most.
template <typename Clock>
ClockReading readClocks(const Clock& clock) {
  constexpr double kSameMoment = 1e-3;  // s
  constexpr int kMostTries = 5;
  ClockReading best;
  double shortest = 0.0;
  for (int i = 0; i < kMostTries; ++i) {
    const double before = steadyTime();
    const double read = clock();
    const double took = steadyTime() - before;
    if (i == 0 || took < shortest) {
      shortest = took;
      best = {read, before + 0.5 * took};
    }
    if (took < kSameMoment) break;
  }
  return best;
}

/// Notices when a clock is set, e.g. by NTP, by comparing it with one that is never set.
class ClockWatch {
 public:
  /// s: how far the clock was set since the previous call, negative if set back; 0 if it was not
  /// set. Takes readings of both clocks at the same moment, in s.
  double step(double clock, double steady) {
    const double offset = clock - steady;
    const double change = last_offset_ ? offset - *last_offset_ : 0.0;
    last_offset_ = offset;
    return std::abs(change) >= kLeastStep ? change : 0.0;
  }

 private:
  /// s: less than what makes an image late, more than the time between the two clocks' readings.
  static constexpr double kLeastStep = 0.01;

  std::optional<double> last_offset_;
};

}  // namespace omnitag
