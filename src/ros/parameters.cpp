#include "ros/parameters.h"

#include <ros/param.h>

#include <algorithm>

#include "ros/xmlrpc_yaml.h"

namespace omnitag {
namespace {

void readFrame(const YamlReader& reader, const std::string& key, std::string* frame) {
  reader.read(key, frame);
  if (!frame->empty() && frame->front() == '/') {
    reader.refuse(key, "the name of a frame, without a slash in front");
  }
}

/// An empty list means none.
std::optional<Pose> readInitialPose(const YamlReader& reader) {
  const std::string key = "initial_pose";
  if (!reader.has(key)) return std::nullopt;
  const std::vector<double> pose = reader.numbers(key);
  if (pose.empty()) return std::nullopt;
  if (pose.size() != 3) reader.refuse(key, "[x, y, yaw] or an empty list");
  return Pose{pose[0], pose[1], pose[2]};
}

/// A list on a command line (`_initial_pose:=[1,2,0]`) arrives as text. Other texts stay as they
/// are, and are refused as texts.
void parseList(YAML::Node node) {
  if (!node.IsDefined() || !node.IsScalar()) return;
  try {
    const YAML::Node parsed = YAML::Load(node.Scalar());
    if (!parsed.IsSequence()) return;
    // Without the positions in the text, which are not those of a file.
    YAML::Node list(YAML::NodeType::Sequence);
    for (const YAML::Node& item : parsed) list.push_back(item.as<std::string>());
    node = list;
  } catch (const YAML::Exception&) {
  }
}

/// Whether it can be a name in ROS, for topics and namespaces.
bool isRosName(const std::string& name) {
  const auto isLetter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  return !name.empty() && isLetter(name.front()) &&
         std::all_of(name.begin(), name.end(), [&isLetter](char c) {
           return isLetter(c) || (c >= '0' && c <= '9') || c == '_';
         });
}

/// One of several cameras. `usual`: the values of keys that it does not have.
CameraParameters readCamera(const YamlReader& reader, const CameraParameters& usual,
                            const ShutterConfig& shutter) {
  reader.allowOnly({"name", "camera_file", "image", "image_transport", "frame", "image_time_offset",
                    "row_readout_time", "exposure_time"});
  CameraParameters camera = usual;
  camera.name = reader.text("name");
  if (!isRosName(camera.name)) {
    reader.refuse("name", "a letter, followed by letters, digits and underscores");
  }
  camera.camera_file = reader.text("camera_file");
  camera.image = reader.text("image");
  for (const char* key : {"camera_file", "image"}) {
    if (reader.text(key).empty()) reader.refuse(key, "a text");
  }
  reader.read("image_transport", &camera.image_transport);
  readFrame(reader, "frame", &camera.frame);
  const bool has_own_shutter = reader.has("image_time_offset") || reader.has("row_readout_time") ||
                               reader.has("exposure_time");
  if (has_own_shutter) camera.shutter = readShutterConfig(reader, shutter);
  return camera;
}

/// The list `cameras`, or the only camera if the list is empty.
std::vector<CameraParameters> readCameras(const YamlReader& reader, const ShutterConfig& shutter) {
  CameraParameters usual;
  reader.read("camera_file", &usual.camera_file);
  reader.read("image_transport", &usual.image_transport);
  std::vector<YamlReader> list;
  if (reader.has("cameras")) list = reader.mappings("cameras");
  if (list.empty()) return {usual};
  if (!usual.camera_file.empty()) {
    reader.refuse("camera_file", "none beside the list `cameras`, where each camera has its own");
  }
  std::vector<CameraParameters> cameras;
  for (const YamlReader& each : list) {
    cameras.push_back(readCamera(each, usual, shutter));
    const auto isNamedSo = [&](const CameraParameters& camera) {
      return camera.name == cameras.back().name;
    };
    if (std::count_if(cameras.begin(), cameras.end(), isNamedSo) > 1) {
      each.refuse("name", "another name than the cameras before");
    }
  }
  return cameras;
}

}  // namespace

LocalizerParameters readParameters(const YamlReader& reader) {
  reader.allowOnly({"camera_file", "cameras", "map_file", "map_frame", "odom_frame", "base_frame",
                    "initial_pose", "publish_tf", "publish_marker_tf", "ignore_markers",
                    "drag_markers", "pose_file", "save_pose_period", "image_transport",
                    "queue_size", "transform_timeout", "transform_tolerance", "transform_period",
                    "restart_time_jump", "path_min_step", "path_max_poses", "robot_radius",
                    "visibility", "view", "detector", "association", "recognition", "estimation",
                    "look_around", "attention", "evidence", "relocalization", "motion", "floor",
                    "pose_model", "image_time_offset", "row_readout_time", "exposure_time",
                    "threads", "estimator", "mapping", "mapper", "refine_map",
                    // Read by nodelet in the same namespace.
                    "num_worker_threads"});
  LocalizerParameters parameters;
  reader.read("map_file", &parameters.map_file);
  readFrame(reader, "map_frame", &parameters.frames.map);
  readFrame(reader, "odom_frame", &parameters.frames.odom);
  readFrame(reader, "base_frame", &parameters.frames.base);
  if (parameters.frames.base.empty()) reader.refuse("base_frame", "the name of a frame");

  parameters.initial_pose = readInitialPose(reader);
  reader.read("queue_size", &parameters.queue_size, Interval{1, 1e6});
  reader.read("publish_tf", &parameters.publish_tf);
  reader.read("publish_marker_tf", &parameters.publish_marker_tf);
  if (reader.has("ignore_markers")) parameters.ignore_markers = reader.texts("ignore_markers");
  reader.read("drag_markers", &parameters.drag_markers);
  reader.read("pose_file", &parameters.pose_file);
  reader.read("save_pose_period", &parameters.save_pose_period, Interval{0.0, 3600.0});
  if (parameters.save_pose_period > 0.0 && parameters.pose_file.empty()) {
    reader.refuse("save_pose_period", "0, as there is no pose_file");
  }
  reader.read("transform_timeout", &parameters.transform_timeout, Interval{0.0, 60.0});
  reader.read("transform_tolerance", &parameters.transform_tolerance, Interval{0.0, 60.0});
  reader.read("transform_period", &parameters.transform_period, {0.001, 10.0});
  reader.read("restart_time_jump", &parameters.restart_time_jump, kNonNegative);
  reader.read("path_min_step", &parameters.path_min_step, kNonNegative);
  reader.read("path_max_poses", &parameters.path_max_poses, Interval{1, 1e6});
  reader.read("robot_radius", &parameters.robot_radius, kPositive);
  parameters.localizer = readLocalizerConfig(reader);
  parameters.cameras = readCameras(reader, parameters.localizer.shutter);
  reader.read("mapping", &parameters.mapping);
  if (reader.has("mapper")) parameters.mapper = readMarkerMapperConfig(reader.mapping("mapper"));
  reader.read("refine_map", &parameters.refine_map);
  if (parameters.mapping) parameters.localizer.exploring_views = parameters.mapper.views_per_frame;
  return parameters;
}

LocalizerParameters readParameters(const std::string& name_space) {
  XmlRpc::XmlRpcValue tree;
  YAML::Node node(YAML::NodeType::Map);
  if (ros::param::get(name_space, tree)) node = yamlFromXmlRpc(tree, name_space);
  for (const char* list : {"initial_pose", "ignore_markers"}) {
    if (node.IsMap() && node[list]) parseList(node[list]);
  }
  const YamlReader reader(node, name_space);
  const std::string map_file = "map_file";
  if (!reader.has(map_file) || reader.text(map_file).empty()) {
    reader.refuse(map_file, "the path of a file");
  }
  return readParameters(reader);
}

}  // namespace omnitag
