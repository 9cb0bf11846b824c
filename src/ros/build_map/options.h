#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ros/adjustment_tools/alignment_options.h"
#include "ros/parameters.h"

namespace omnitag {

/// The command line of build_map. Texts of options that were not given are empty.
struct BuildOptions {
  std::vector<std::string> bags;
  std::string camera;
  std::string seed;
  std::string output;
  /// If given, the camera is also calibrated, and written there.
  std::string output_camera;
  std::string drawing;
  /// The picture of the residuals; filled in if it was not given, as `drawing` is.
  std::string picture;
  std::string trajectory;
  std::string image_topic;
  std::string params;
  std::string family;
  /// m; 0: the seed's default.
  double size = 0.0;
  bool estimates_sizes = false;
  std::string odom_frame = "odom";
  int max_images = 600;
  /// The frame to put the map into; none: it stays in its own.
  AlignmentRequest alignment;
};

/// Nothing if help was asked for, which is then printed. Throws InputError for an option that is
/// missing, unknown or has a bad value, and for a result that would overwrite an input.
std::optional<BuildOptions> parseBuildOptions(int argc, char** argv);

}  // namespace omnitag
