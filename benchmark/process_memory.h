#pragma once

#include <fstream>
#include <string>

#include "omnitag/common/error.h"

namespace omnitag {

/// MB of this process by a name of /proc/self/status: VmRSS is what is in memory, VmHWM what was in
/// memory at most. Throws InputError for other names.
inline double processMemory(const std::string& name) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    double kilobytes = 0.0;
    if (word == name + ":" && status >> kilobytes) return kilobytes / 1024.0;
  }
  throw InputError("/proc/self/status: expected " + name + ", found none");
}

/// Lets VmHWM start anew from what is in memory now.
inline void forgetPeakMemory() { std::ofstream("/proc/self/clear_refs") << 5; }

}  // namespace omnitag
