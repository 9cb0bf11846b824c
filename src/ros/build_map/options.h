#pragma once

#include <optional>
#include <string>

#include "omnitag/ros/parameters.h"

namespace omnitag {

/// The command line of build_map. Empty texts stand for options that were not given.
struct BuildOptions {
  std::string bag;
  std::string camera;
  std::string seed;
  std::string output;
  std::string drawing;
  std::string trajectory;
  std::string image_topic;
  std::string params;
  std::string family;
  /// m; 0: the seed's default.
  double size = 0.0;
  bool estimates_sizes = false;
  std::string odom_frame = "odom";
  int max_images = 600;
};

/// Nothing where help was asked for, which is then printed. Throws InputError for an option that is
/// missing, unknown or has a bad value, and for a result that would overwrite an input.
std::optional<BuildOptions> parseBuildOptions(int argc, char** argv);

}  // namespace omnitag
