#pragma once

#include <optional>
#include <string>
#include <vector>

#include "omnitag/common/pose.h"
#include "ros/bag_tools/bag_input.h"
#include "ros/parameters.h"

namespace omnitag {

/// The command line of localize_bag. Texts of options that were not given are empty.
struct BagOptions {
  std::string camera;
  std::string map;
  /// In their order.
  std::vector<std::string> bags;
  RecordedSpan span;
  std::string trajectory;
  std::string image_topic;
  std::optional<Pose> initial_pose;
  std::optional<std::string> odom_frame;
  /// base_from_camera, in place of the bag's.
  std::optional<Eigen::Isometry3d> mounting;
  std::string params;
  std::string poses;
  std::string detections;
  std::string output;
  std::string mapped;
};

/// Nothing if help was asked for, which is then printed. Throws InputError for an option that is
/// missing, unknown or has a bad value, and for a result that would overwrite an input.
std::optional<BagOptions> parseOptions(int argc, char** argv);

/// The localizer's parameters: the file `--params`, overridden by the other options.
LocalizerParameters parametersOf(const BagOptions& options);

}  // namespace omnitag
