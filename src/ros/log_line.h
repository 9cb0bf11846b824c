#pragma once

#include <ros/console.h>

#include <string>

namespace omnitag {

/// A line of the log, shorter to write than roscpp's macros.
inline void inform(const std::string& text) { ROS_INFO_STREAM(text); }
inline void complain(const std::string& text) { ROS_ERROR_STREAM(text); }

}  // namespace omnitag
