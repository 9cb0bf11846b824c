#include "options.h"

#include <boost/program_options.hpp>
#include <cmath>
#include <filesystem>

#include "../bag_tools/command_line.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

namespace po = boost::program_options;

const char* const kUsage =
    "usage: build_map --bag B.bag [--camera C.yaml] [--map SEED.yaml] --output M.yaml [options]\n"
    "\n"
    "Builds a marker map from a recording, by bundle adjustment over all poses and markers. The\n"
    "seed's markers stay where they are; without a seed the marker that is read first is the "
    "map's\n"
    "frame: the origin on the floor below it, x along the normal out of its face. Needs no "
    "roscore.\n"
    "Where the recording cannot tell a map, it says why and what to do, and writes nothing.\n";

}  // namespace

std::optional<BuildOptions> parseBuildOptions(int argc, char** argv) {
  BuildOptions options;
  po::options_description description("options");
  description.add_options()("help,h", "print this")(
      "bag", textOption(&options.bag, "B.bag")->required(), "bag with images and transforms")(
      "camera", textOption(&options.camera, "C.yaml"),
      "camera file; default: the bag's camera_info beside the images")(
      "map", textOption(&options.seed, "SEED.yaml"), "marker map with some of the markers")(
      "output", textOption(&options.output, "M.yaml")->required(),
      "the map: the seed's text with the new markers at its end")(
      "drawing", textOption(&options.drawing, "M.png"),
      "drawing of the map; default: the output's name with .png")(
      "trajectory", textOption(&options.trajectory, "OUT.tum"),
      "the robot's poses as well: stamp x y z qx qy qz qw")(
      "image-topic", textOption(&options.image_topic, "T"),
      "with or without /compressed; default: the bag's only image topic")(
      "family", textOption(&options.family, "F"),
      "of unknown markers; default: the seed's, else tag36h11")(
      "size", po::value<double>(&options.size)->value_name("S"),
      "of unknown markers (m); default: the seed's")(
      "estimate-sizes", po::bool_switch(&options.estimates_sizes),
      "estimate the sizes of unknown markers, too, from --size on; needs a seed or odometry")(
      "odom-frame", textOption(&options.odom_frame, "F")->default_value("odom"),
      "odometry frame of the bag's tf, used where the bag has it; '' for none")(
      "params", textOption(&options.params, "P.yaml"), "parameters, as in config/localizer.yaml")(
      "max-images",
      po::value<int>(&options.max_images)->value_name("N")->default_value(options.max_images),
      "of a longer recording so many are used, evenly spread");
  if (!parseCommandLine(argc, argv, kUsage, description)) return std::nullopt;
  if (options.seed.empty() && options.size == 0.0) {
    throw InputError("--size: expected the size of the markers (m), as there is no --map");
  }
  if (!std::isfinite(options.size) || options.size < 0.0) {
    throw InputError("--size: expected a number > 0");
  }
  if (options.max_images < 2) throw InputError("--max-images: expected a number >= 2");
  if (options.drawing.empty()) {
    options.drawing = std::filesystem::path(options.output).replace_extension(".png").string();
  }
  checkOutputs({options.camera, options.seed, options.bag, options.params},
               {{"--output", options.output},
                {"--drawing", options.drawing},
                {"--trajectory", options.trajectory}});
  return options;
}

}  // namespace omnitag
