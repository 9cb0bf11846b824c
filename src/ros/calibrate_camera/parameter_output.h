#pragma once

#include <string>

#include "adjustment/time_calibration.h"

namespace omnitag {

/// The report on the times: each with its deviation, or why it was held.
std::string timeReport(const TimeCalibration& time, int rows);

/// A parameter file to write times to, which may already exist.
class ParameterOutput {
 public:
  /// Throws InputError that names the file if localize_bag would refuse an existing one, or if the
  /// keys of the times cannot be put into it without changing the rest.
  explicit ParameterOutput(std::string path);

  /// Writes the times that the drive determines; other keys and all comments stay. Returns the keys
  /// that were written. If the drive determines none, returns nothing and writes nothing.
  std::string write(const TimeCalibration& time) const;

 private:
  std::string withNumber(const std::string& text, const std::string& key,
                         const std::string& number) const;

  std::string path_;
  std::string text_;
};

}  // namespace omnitag
