#include "options.h"

#include <boost/program_options.hpp>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <sstream>
#include <vector>

#include "omnitag/common/error.h"

namespace omnitag {
namespace {

namespace po = boost::program_options;

const char* const kUsage =
    "usage: localize_bag [--camera C.yaml] --map M.yaml --bag IN.bag --trajectory OUT.tum "
    "[options]\n"
    "\n"
    "Runs the localizer over every image of a bag, as fast as it can and with the same result\n"
    "every time. Transforms come from the bag's /tf and /tf_static. Needs no roscore.\n";

Pose2 parsePose(const std::string& text) {
  std::istringstream stream(text);
  Pose2 pose;
  char first_comma = 0;
  char second_comma = 0;
  stream >> pose.x >> first_comma >> pose.y >> second_comma >> pose.yaw;
  const bool is_read =
      !stream.fail() && first_comma == ',' && second_comma == ',' && (stream >> std::ws).eof();
  if (!is_read || !std::isfinite(pose.x + pose.y + pose.yaw)) {
    throw InputError("--initial-pose: expected X,Y,YAW in metres and radians, found '" + text +
                     "'");
  }
  return pose;
}

bool isSameFile(const std::string& a, const std::string& b) {
  std::error_code ignored;
  return std::filesystem::equivalent(a, b, ignored);
}

[[noreturn]] void refuseOutput(const std::string& option, const std::string& path,
                               const std::string& why) {
  throw InputError(option + ": " + path + " " + why);
}

/// Results are written over what was there, but never over an input or another result.
void checkOutputs(const BagOptions& options) {
  const std::vector<std::string> inputs = {options.camera, options.map, options.bag,
                                           options.params};
  const std::vector<std::pair<std::string, std::string>> outputs = {
      {"--trajectory", options.trajectory},
      {"--poses", options.poses},
      {"--detections", options.detections},
      {"--output", options.output}};
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const auto& [option, path] = outputs[i];
    if (path.empty()) continue;
    for (const std::string& input : inputs) {
      if (isSameFile(path, input)) {
        refuseOutput(option, path, "is an input and would be overwritten");
      }
    }
    for (std::size_t j = 0; j < i; ++j) {
      if (path == outputs[j].second) {
        refuseOutput(option, path, "is given twice");
      }
    }
  }
}

}  // namespace

std::optional<BagOptions> parseOptions(int argc, char** argv) {
  BagOptions options;
  std::string initial_pose;
  std::string odom_frame;
  po::options_description description("options");
  const auto text = [](std::string* value, const char* name) {
    return po::value<std::string>(value)->value_name(name);
  };
  description.add_options()("help,h", "print this")(
      "camera", text(&options.camera, "C.yaml"),
      "camera file; default: the bag's camera_info beside the images, of a fisheye")(
      "map", text(&options.map, "M.yaml")->required(), "marker map")(
      "bag", text(&options.bag, "IN.bag")->required(), "bag with images and transforms")(
      "trajectory", text(&options.trajectory, "OUT.tum")->required(),
      "poses of base_link in the map: stamp x y z qx qy qz qw")(
      "image-topic", text(&options.image_topic, "T"),
      "with or without /compressed; default: the bag's only image topic")(
      "initial-pose", text(&initial_pose, "X,Y,YAW"),
      "base_link in the map at the first image (m, rad); default: search")(
      "odom-frame", text(&odom_frame, "F"), "odometry frame of the bag's tf; default: none")(
      "params", text(&options.params, "P.yaml"), "parameters, as in config/localizer.yaml")(
      "poses", text(&options.poses, "OUT.csv"), "every frame with its covariance and mode")(
      "detections", text(&options.detections, "OUT.csv"), "every marker that was read")(
      "output", text(&options.output, "OUT.bag"),
      "the bag's messages and, with them, what the localizer publishes");
  try {
    const auto style = static_cast<int>(po::command_line_style::default_style) &
                       ~static_cast<int>(po::command_line_style::allow_guessing);
    po::variables_map values;
    po::store(po::command_line_parser(argc, argv)
                  .options(description)
                  .positional(po::positional_options_description())
                  .style(style)
                  .run(),
              values);
    if (values.count("help") > 0) {
      std::cout << kUsage << '\n' << description;
      return std::nullopt;
    }
    po::notify(values);
    if (values.count("initial-pose") > 0) options.initial_pose = parsePose(initial_pose);
    if (values.count("odom-frame") > 0) options.odom_frame = odom_frame;
  } catch (const po::error& error) {
    throw InputError(error.what());
  }
  checkOutputs(options);
  return options;
}

LocalizerParameters parametersOf(const BagOptions& options) {
  LocalizerParameters parameters;
  if (!options.params.empty()) {
    parameters = readParameters(YamlReader::fromFile(options.params));
  }
  parameters.camera_file = options.camera;
  parameters.map_file = options.map;
  parameters.initial_pose = options.initial_pose;
  if (options.odom_frame) parameters.frames.odom = *options.odom_frame;
  return parameters;
}

}  // namespace omnitag
