#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "ros/adjustment_tools/alignment_options.h"

namespace omnitag {

/// The command line of calibrate_camera. Texts of options that were not given are empty.
struct CalibrationOptions {
  std::vector<std::string> bags;
  /// Empty: only the size of the markers is known.
  std::string map;
  /// A calibration board in place of the map; empty if there is none.
  std::string board;
  std::string camera;
  std::string output;
  /// The picture of the residuals; filled in if it was not given.
  std::string picture;
  std::string image_topic;
  std::string params;
  /// A frame in the bag's tf; if given, the times of the rows are estimated.
  std::string odom_frame;
  /// The file to write those times to.
  std::string output_params;
  /// The file to write the markers to.
  std::string output_map;
  /// The drawing of that map; filled in if it was not given, empty without that map.
  std::string drawing;
  /// For markers that the map does not have. The default family is the map's, or tag36h11; the
  /// default size (m) is the map's. 0: unknown markers are not used.
  std::string family;
  double size = 0.0;
  /// The frame to put that map into; none: it stays in its own.
  AlignmentRequest alignment;
  /// base_from_camera, in place of the bag's.
  std::optional<Eigen::Isometry3d> mounting;
  /// Names of parameters to keep at their values in the guess.
  std::set<std::string> fixed;
  /// How many images are read, spread over the bags.
  int images = 150;
};

/// Nothing if help was asked for, which is then printed. Throws InputError for an option that is
/// missing, unknown or has a bad value, and for a result that would overwrite an input.
std::optional<CalibrationOptions> parseCalibrationOptions(int argc, char** argv);

}  // namespace omnitag
