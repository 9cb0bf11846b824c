#include "ros/calibrate_camera/options.h"

#include <boost/program_options.hpp>
#include <cmath>
#include <filesystem>
#include <sstream>

#include "omnitag/common/error.h"
#include "ros/bag_tools/command_line.h"
#include "ros/bag_tools/mounting_option.h"

namespace omnitag {
namespace {

namespace po = boost::program_options;

const char* const kUsage =
    "usage: calibrate_camera --bag B.bag [--bag B2.bag] (--map M.yaml | --size S | --board "
    "B.yaml)\n"
    "                        --camera GUESS.yaml --output C.yaml [--output-map M2.yaml] [options]\n"
    "\n"
    "Estimates the lens, the mirror and how the camera is mounted (height, roll, pitch) from a\n"
    "drive among markers, and where these hang, as far as the map leaves that open. The guess is a "
    "camera file that may be 10 % off, or that only "
    "has\n"
    "the image's circle right. What the images do not tell is held as the guess has it, and said.\n"
    "Where the recording cannot calibrate a camera, no file is written. Needs no roscore.\n"
    "\n"
    "With --board, the lens and the mirror alone, from a board that is held before the camera, or\n"
    "past which the camera is carried: near and far, tilted, in all parts of the image. The guess\n"
    "must be right to some percent.\n"
    "\n"
    "With --odom-frame, it also estimates how long after its stamp an image is exposed and how "
    "long\n"
    "its rows take (image_time_offset, row_readout_time), from a drive that turns left and right,\n"
    "and the camera as it is without what the rows' times do to its images.\n";

std::set<std::string> splitNames(const std::string& text) {
  std::istringstream stream(text);
  std::set<std::string> names;
  for (std::string name; std::getline(stream, name, ',');) names.insert(name);
  return names;
}

/// A board has its own frame, in which no robot stands.
void checkBoardOptions(const CalibrationOptions& options) {
  const auto refuse = [](const char* option, bool is_given) {
    if (is_given) throw InputError(std::string(option) + ": not together with --board");
  };
  refuse("--map", !options.map.empty());
  refuse("--size", options.size != 0.0);
  refuse("--family", !options.family.empty());
  refuse("--mounting", options.mounting.has_value());
  refuse("--odom-frame", !options.odom_frame.empty());
  refuse("--output-map", !options.output_map.empty());
  refuse("--align-to, --align-point", !options.alignment.isNone());
}

}  // namespace

std::optional<CalibrationOptions> parseCalibrationOptions(int argc, char** argv) {
  CalibrationOptions options;
  po::options_description description("options");
  description.add_options()("help,h", "print this")(
      "bag", textsOption(&options.bags, "B.bag")->required(),
      "bag with images and transforms; may be repeated")(
      "map", textOption(&options.map, "M.yaml"),
      "marker map, as exact as its deviations say; without, give --size")(
      "size", po::value<double>(&options.size)->value_name("S"),
      "of markers that the map does not have (m): use them, too")(
      "board", textOption(&options.board, "B.yaml"),
      "calibration board: Kalibr's AprilGrid (its target file), or a ChArUco board")(
      "family", textOption(&options.family, "F"), "of these; default: the map's, else tag36h11")(
      "output-map", textOption(&options.output_map, "M2.yaml"),
      "marker map to write, with what the drive tells of the markers' places")(
      "drawing", textOption(&options.drawing, "M2.png"),
      "drawing of that map; default: its name with .png")(
      "camera", textOption(&options.camera, "GUESS.yaml")->required(), "camera file to start from")(
      "output", textOption(&options.output, "C.yaml")->required(), "camera file to write")(
      "picture", textOption(&options.picture, "P.png"),
      "picture of the residuals to write; default: beside the output, C_residuals.png")(
      "image-topic", textOption(&options.image_topic, "T"),
      "with or without /compressed; default: the bag's only image topic")(
      "mounting",
      po::value<std::string>()
          ->value_name("X,Y,Z,R,P,Y")
          ->notifier([&options](const std::string& text) {
            options.mounting = parseMounting("--mounting", text);
          }),
      "guess of the camera on the robot (m, and roll, pitch, yaw in rad); default: as the bag's tf "
      "says")(
      "fix",
      po::value<std::string>()
          ->value_name("NAME,...")
          ->notifier([&options](const std::string& text) { options.fixed = splitNames(text); }),
      "parameters to keep as the guess has them, e.g. apex_distance,roll,pitch")(
      "images", po::value<int>(&options.images)->value_name("N"),
      "how many images to look at, spread over the bag; default: 150")(
      "params", textOption(&options.params, "P.yaml"),
      "parameters, as in config/localizer.yaml: base_frame, detector, motion and floor count")(
      "odom-frame", textOption(&options.odom_frame, "F"),
      "odometry frame of the bag's tf: estimate when the rows of the images are exposed, too")(
      "output-params", textOption(&options.output_params, "P.yaml"),
      "parameter file to write image_time_offset and row_readout_time into; what else is in it "
      "stays");
  addAlignmentOptions(&options.alignment, &description);
  if (!parseCommandLine(argc, argv, kUsage, description)) return std::nullopt;
  if (!options.board.empty()) {
    checkBoardOptions(options);
  } else if (options.map.empty() && options.size == 0.0) {
    throw InputError(
        "--size: expected the size of the markers (m), as there is neither --map nor --board");
  }
  if (!std::isfinite(options.size) || options.size < 0.0) {
    throw InputError("--size: expected a number > 0");
  }
  checkAlignment(options.alignment);
  if (!options.alignment.isNone() && options.output_map.empty()) {
    throw InputError("--align-to, --align-point: need --output-map, the map to be aligned");
  }
  if (options.images < 1) {
    throw InputError("--images: expected at least 1, found " + std::to_string(options.images));
  }
  if (options.picture.empty()) {
    const std::filesystem::path output(options.output);
    options.picture = (output.parent_path() / (output.stem().string() + "_residuals.png")).string();
  }
  if (!options.drawing.empty() && options.output_map.empty()) {
    throw InputError("--drawing: needs --output-map, the map to be drawn");
  }
  if (options.drawing.empty() && !options.output_map.empty()) {
    options.drawing = std::filesystem::path(options.output_map).replace_extension(".png").string();
  }
  if (!options.output_params.empty() && options.odom_frame.empty()) {
    throw InputError("--output-params: needs --odom-frame, without which no times are estimated");
  }
  std::vector<std::string> inputs = {options.camera, options.map, options.board};
  inputs.insert(inputs.end(), options.bags.begin(), options.bags.end());
  // --output-params may be the file of --params, since its other contents stay.
  checkOutputs(inputs, {{"--output", options.output},
                        {"--output-map", options.output_map},
                        {"--picture", options.picture},
                        {"--drawing", options.drawing},
                        {"--output-params", options.output_params}});
  inputs.push_back(options.params);
  checkOutputs(inputs, {{"--output", options.output},
                        {"--output-map", options.output_map},
                        {"--picture", options.picture},
                        {"--drawing", options.drawing}});
  return options;
}

}  // namespace omnitag
