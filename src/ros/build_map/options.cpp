#include "ros/build_map/options.h"

#include <boost/program_options.hpp>
#include <cmath>
#include <filesystem>

#include "omnitag/common/error.h"
#include "ros/bag_tools/command_line.h"

namespace omnitag {
namespace {

namespace po = boost::program_options;

const char* const kUsage =
    "usage: build_map --bag B.bag [--bag B2.bag] [--camera C.yaml] [--map SEED.yaml] --output "
    "M.yaml\n"
    "                 [options]\n"
    "\n"
    "Builds a marker map from a recording, by bundle adjustment over all poses and markers. A "
    "seed's\n"
    "markers are as soft as their deviations say; without a seed the marker that is read first is\n"
    "the map's frame: the origin on the floor below it, x along the normal out of its face. With\n"
    "--output-camera the camera is found, too, from a rough guess. Needs no roscore. Where the\n"
    "recording cannot tell a map, it says why and what to do, and writes nothing.\n";

}  // namespace

std::optional<BuildOptions> parseBuildOptions(int argc, char** argv) {
  BuildOptions options;
  po::options_description description("options");
  description.add_options()("help,h", "print this")(
      "bag", textsOption(&options.bags, "B.bag")->required(),
      "bag with images and transforms; may be repeated")(
      "camera", textOption(&options.camera, "C.yaml"),
      "camera file; default: the bag's camera_info beside the images")(
      "map", textOption(&options.seed, "SEED.yaml"), "marker map with some of the markers")(
      "output", textOption(&options.output, "M.yaml")->required(),
      "the map: the seed's text with the new markers at its end")(
      "output-camera", textOption(&options.output_camera, "C2.yaml"),
      "find the camera and its mounting, too, --camera being a guess, and write it")(
      "drawing", textOption(&options.drawing, "M.png"),
      "drawing of the map; default: the output's name with .png")(
      "picture", textOption(&options.picture, "P.png"),
      "picture of the residuals; default: beside the output, M_residuals.png")(
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
      "of a longer recording this many are used, evenly spread");
  addAlignmentOptions(&options.alignment, &description);
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
  if (options.picture.empty()) {
    const std::filesystem::path output(options.output);
    options.picture = (output.parent_path() / (output.stem().string() + "_residuals.png")).string();
  }
  if (!options.output_camera.empty() && options.camera.empty()) {
    throw InputError("--output-camera: needs --camera, a guess to start from");
  }
  checkAlignment(options.alignment);
  std::vector<std::string> inputs = {options.camera, options.seed, options.params};
  inputs.insert(inputs.end(), options.bags.begin(), options.bags.end());
  checkOutputs(inputs, {{"--output", options.output},
                        {"--output-camera", options.output_camera},
                        {"--drawing", options.drawing},
                        {"--picture", options.picture},
                        {"--trajectory", options.trajectory}});
  return options;
}

}  // namespace omnitag
