#include "ros/bag_tools/progress.h"

#include <unistd.h>

#include <iostream>
#include <utility>

namespace omnitag {

Progress::Progress(std::size_t total, std::string what)
    : total_(total), what_(std::move(what)), is_terminal_(isatty(STDERR_FILENO) != 0) {}

void Progress::show(std::size_t done) {
  constexpr std::chrono::milliseconds kPeriod(100);
  const auto now = std::chrono::steady_clock::now();
  const bool is_last = done == total_;
  if (is_terminal_) {
    if (now - last_shown_ < kPeriod && !is_last) return;
    std::cerr << '\r' << done << " of " << total_ << ' ' << what_ << (is_last ? "\n" : "")
              << std::flush;
  } else {
    const std::size_t tenth = 10 * done / total_;
    if (tenth == last_tenth_) return;
    last_tenth_ = tenth;
    std::cerr << done << " of " << total_ << ' ' << what_ << '\n';
  }
  last_shown_ = now;
}

void Progress::warn(const std::string& line) const {
  std::cerr << (is_terminal_ ? "\r" : "") << line << '\n';
}

}  // namespace omnitag
