#pragma once

#include <ctime>

namespace omnitag {

/// Seconds that all threads of this process have been computing.
inline double processorTime() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace omnitag
