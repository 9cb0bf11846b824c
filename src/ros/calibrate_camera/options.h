#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "../adjustment_tools/alignment_options.h"

namespace omnitag {

/// The command line of calibrate_camera. Empty texts stand for options that were not given.
struct CalibrationOptions {
  std::vector<std::string> bags;
  /// Empty: nothing is known of the markers but their size.
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
  /// To write the markers into.
  std::string output_map;
  /// Of markers that the map does not have: the default family is the map's, or tag36h11, and the
  /// size (m) the map's; 0: unknown markers are not used.
  std::string family;
  double size = 0.0;
  /// Into which frame that map is put; none: it stays in its own.
  AlignmentRequest alignment;
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
