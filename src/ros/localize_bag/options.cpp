#include "ros/localize_bag/options.h"

#include <boost/program_options.hpp>
#include <cmath>
#include <sstream>

#include "omnitag/common/error.h"
#include "ros/bag_tools/command_line.h"
#include "ros/bag_tools/mounting_option.h"

namespace omnitag {
namespace {

namespace po = boost::program_options;

const char* const kUsage =
    "usage: localize_bag [--camera C.yaml] --map M.yaml --bag IN.bag --trajectory OUT.tum "
    "[options]\n"
    "\n"
    "Runs the localizer over every image of a bag, as fast as it can and with the same result\n"
    "every time. Transforms come from the bag's /tf and /tf_static. Several bags are taken in the\n"
    "order in which they are given; transforms of one count for all. Needs no roscore.\n";

/// The value of an option in seconds. Throws InputError unless it is finite and at least 0.
double checkedSeconds(const char* option, double seconds) {
  if (std::isfinite(seconds) && seconds >= 0.0) return seconds;
  throw InputError(std::string(option) + ": expected seconds from 0 on, found " +
                   std::to_string(seconds));
}

Pose parsePose(const std::string& text) {
  std::istringstream stream(text);
  Pose pose;
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

}  // namespace

std::optional<BagOptions> parseOptions(int argc, char** argv) {
  BagOptions options;
  po::options_description description("options");
  description.add_options()("help,h", "print this")(
      "camera", textOption(&options.camera, "C.yaml"),
      "camera file; default: that of --params, else the bag's camera_info")(
      "map", textOption(&options.map, "M.yaml")->required(), "marker map")(
      "bag", textsOption(&options.bags, "IN.bag")->required(),
      "bag with images and transforms; may be given several times")(
      "trajectory", textOption(&options.trajectory, "OUT.tum")->required(),
      "poses of base_link in the map: stamp x y z qx qy qz qw")(
      "image-topic", textOption(&options.image_topic, "T"),
      "with or without /compressed; default: the bag's only image topic")(
      "from", po::value<double>()->value_name("S")->notifier([&options](double seconds) {
        options.span.from = checkedSeconds("--from", seconds);
      }),
      "begin this many seconds after the first message was recorded")(
      "until", po::value<double>()->value_name("S")->notifier([&options](double seconds) {
        options.span.until = checkedSeconds("--until", seconds);
      }),
      "and end this many after it")(
      "initial-pose",
      po::value<std::string>()->value_name("X,Y,YAW")->notifier(
          [&options](const std::string& text) { options.initial_pose = parsePose(text); }),
      "base_link in the map at the first image (m, rad); default: that of --params, else search")(
      "odom-frame",
      po::value<std::string>()->value_name("F")->notifier(
          [&options](const std::string& frame) { options.odom_frame = frame; }),
      "odometry frame of the bag's tf; default: none")(
      "mounting",
      po::value<std::string>()
          ->value_name("X,Y,Z,R,P,Y")
          ->notifier([&options](const std::string& text) {
            options.mounting = parseMounting("--mounting", text);
          }),
      "the camera on the robot (m, and roll, pitch, yaw in rad); default: as the bag's tf says")(
      "params", textOption(&options.params, "P.yaml"),
      "parameters, as in config/localizer.yaml; `cameras` there for several cameras")(
      "poses", textOption(&options.poses, "OUT.csv"), "every frame with its covariance and mode")(
      "detections", textOption(&options.detections, "OUT.csv"), "every marker that was read")(
      "output", textOption(&options.output, "OUT.bag"),
      "the bag's messages and, with them, what the localizer publishes on a robot, with "
      "/debug_image compressed")(
      "save-map", textOption(&options.mapped, "OUT.yaml"),
      "map unknown markers, as with the parameter mapping, and write the map with them");
  if (!parseCommandLine(argc, argv, kUsage, description)) return std::nullopt;
  if (options.span.until < options.span.from) {
    throw InputError("--until: expected no less than --from");
  }
  std::vector<std::string> inputs = options.bags;
  inputs.insert(inputs.end(), {options.camera, options.map, options.params});
  checkOutputs(inputs, {{"--trajectory", options.trajectory},
                        {"--poses", options.poses},
                        {"--detections", options.detections},
                        {"--output", options.output},
                        {"--save-map", options.mapped}});
  return options;
}

LocalizerParameters parametersOf(const BagOptions& options) {
  LocalizerParameters parameters;
  if (!options.params.empty()) {
    parameters = readParameters(YamlReader::fromFile(options.params));
  }
  if (parameters.hasCameraList()) {
    const auto refuse = [](const std::string& option) {
      throw InputError(option + ": expected no such option, as --params has `cameras`");
    };
    if (!options.camera.empty()) refuse("--camera");
    if (!options.image_topic.empty()) refuse("--image-topic");
    if (options.mounting) refuse("--mounting");
  } else {
    // The node's `image` is the topic of the bag, whatever its name.
    parameters.cameras.front().image = options.image_topic;
    if (!options.camera.empty()) parameters.cameras.front().camera_file = options.camera;
  }
  parameters.map_file = options.map;
  if (options.initial_pose) parameters.initial_pose = options.initial_pose;
  if (options.odom_frame) parameters.frames.odom = *options.odom_frame;
  if (!options.mapped.empty()) {
    parameters.mapping = true;
    parameters.localizer.exploring_views = parameters.mapper.views_per_frame;
  }
  return parameters;
}

}  // namespace omnitag
