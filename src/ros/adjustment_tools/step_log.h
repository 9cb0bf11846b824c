#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <utility>

#include "ros/bag_tools/progress.h"

namespace omnitag {

/// Shows the steps of an adjustment on standard error: a line for each, or while a step counts
/// something, its Progress.
class StepLog {
 public:
  /// `what` precedes the names of steps, e.g. "calibrating".
  explicit StepLog(std::string what) : what_(std::move(what)) {}

  /// `total`: 0 for a step that does not count. Shows a step that goes on only if it counts.
  void show(const std::string& step, std::size_t done = 0, std::size_t total = 0);

 private:
  std::string what_;
  std::string last_;
  /// Of a step that counts.
  std::unique_ptr<Progress> progress_;
};

}  // namespace omnitag
