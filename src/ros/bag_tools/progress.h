#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace omnitag {

/// Shows on standard error how far a run has come: on a terminal in one line, elsewhere in a line
/// for every tenth of the run.
class Progress {
 public:
  /// `what`: what is counted, e.g. "images".
  Progress(std::size_t total, std::string what);

  void show(std::size_t done);

  /// Writes a separate line.
  void warn(const std::string& line) const;

 private:
  const std::size_t total_;
  const std::string what_;
  const bool is_terminal_;
  std::size_t last_tenth_ = 0;
  std::chrono::steady_clock::time_point last_shown_;
};

}  // namespace omnitag
