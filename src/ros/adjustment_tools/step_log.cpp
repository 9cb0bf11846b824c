#include "ros/adjustment_tools/step_log.h"

#include <iostream>

namespace omnitag {

void StepLog::show(const std::string& step, std::size_t done, std::size_t total) {
  if (step != last_) {
    last_ = step;
    progress_ = total > 0 ? std::make_unique<Progress>(total, step) : nullptr;
    if (total == 0) std::cerr << what_ << ": " << step << '\n';
  }
  if (progress_) progress_->show(done);
}

}  // namespace omnitag
