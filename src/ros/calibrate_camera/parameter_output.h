#pragma once

#include <string>

#include "omnitag/adjustment/time_calibration.h"

namespace omnitag {

/// What the tool says of the times: each with its deviation, or why it was held.
std::string timeReport(const TimeCalibration& time, int rows);

/// A parameter file to write times into; there may be one already.
class ParameterOutput {
 public:
  /// Throws InputError, which names the file, where what is there is none that localize_bag would
  /// take, or where the times' keys cannot be put into it without changing the rest.
  explicit ParameterOutput(std::string path);

  /// Writes the times that the drive tells; other keys and all comments stay. Returns the keys
  /// that were written; empty, and nothing is written, where the drive tells none.
  std::string write(const TimeCalibration& time) const;

 private:
  std::string withNumber(const std::string& text, const std::string& key,
                         const std::string& number) const;

  std::string path_;
  std::string text_;
};

}  // namespace omnitag
