#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <set>
#include <string>

namespace omnitag {

/// The command line of calibrate_camera. Empty texts stand for options that were not given.
struct CalibrationOptions {
  std::string bag;
  std::string map;
  std::string camera;
  std::string output;
  /// Of the residuals; filled in where it was not given.
  std::string picture;
  std::string image_topic;
  std::string params;
  /// Of the bag's tf; where it is given, the rows' times are estimated.
  std::string odom_frame;
  /// To write these into.
  std::string output_params;
  /// base_from_camera, in place of the bag's.
  std::optional<Eigen::Isometry3d> mounting;
  /// Names of parameters to keep as the guess has them.
  std::set<std::string> fixed;
  /// How many images are looked at, spread over the bag.
  int images = 150;
};

/// Nothing where help was asked for, which is then printed. Throws InputError for an option that is
/// missing, unknown or has a bad value, and for a result that would overwrite an input.
std::optional<CalibrationOptions> parseCalibrationOptions(int argc, char** argv);

}  // namespace omnitag
