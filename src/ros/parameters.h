#pragma once

#include <optional>
#include <string>
#include <vector>

#include "adjustment/marker_mapper.h"
#include "omnitag/common/pose.h"
#include "omnitag/localization/localizer_config.h"

namespace omnitag {

/// The frames of REP 105 that the localizer connects.
struct FrameNames {
  /// Empty: the frame that the marker map names.
  std::string map;
  /// Empty: the robot has no odometry.
  std::string odom;
  std::string base = "base_link";
};

/// One of the robot's cameras.
struct CameraParameters {
  /// In messages and topics; empty where there is no list of cameras.
  std::string name;
  /// May be empty only if there is no list: then `camera_info` beside the images describes the
  /// camera.
  std::string camera_file;
  /// Topic of its images, which other cameras may share; and its transport, as image_transport
  /// calls it.
  std::string image = "image";
  std::string image_transport = "raw";
  /// Its optical frame; empty: the frame that the images name.
  std::string frame;
  /// If none, the one in LocalizerConfig.
  std::optional<ShutterConfig> shutter;
};

/// Every parameter of the nodelet, the node and localize_bag; config/localizer.yaml documents them
/// for users.
struct LocalizerParameters {
  /// At least one.
  std::vector<CameraParameters> cameras{1};
  std::string map_file;
  FrameNames frames;
  /// Markers to leave out, as names, ids or FAMILY:ID (MarkerSelection).
  std::vector<std::string> ignore_markers;
  /// Whether people can move the map's markers in RViz.
  bool drag_markers = false;

  /// The base frame in the map at the start; none: search.
  std::optional<Pose> initial_pose;

  /// Where the pose is kept for the next start; empty: nowhere.
  std::string pose_file;
  /// s of wall time between two saves; 0: the pose is neither saved nor read.
  double save_pose_period = 0.0;

  /// Images of a topic that wait while one is processed; the oldest gives way.
  int queue_size = 1;

  /// Whether the robot's transform goes to tf; not if another node fuses the poses and sends one.
  bool publish_tf = true;
  /// Whether the markers' poses in the map go to tf.
  bool publish_marker_tf = false;
  /// s of wall time to wait for the transforms at an image's stamp.
  double transform_timeout = 0.1;
  /// s: how much later than the image map -> odom is stamped, so that it is valid until the next
  /// one.
  double transform_tolerance = 0.1;
  /// s of ROS's clock between repetitions of map -> odom while images give none.
  double transform_period = 0.05;
  /// s: if stamps step back by more, time counts as set back and the localizer starts afresh;
  /// images that are late by less are dropped.
  double restart_time_jump = 1.0;

  /// m between poses of the published path, and how many poses it keeps.
  double path_min_step = 0.05;
  int path_max_poses = 5000;
  /// m: radius of the robot's body as RViz shows it.
  double robot_radius = 0.2;

  LocalizerConfig localizer;

  /// Whether the map is extended by markers that it lacks, and how.
  bool mapping = false;
  MarkerMapperConfig mapper;
  /// Whether the map's own markers are moved to where images show them, within their deviations.
  bool refine_map = false;

  /// Whether there is a list `cameras`, so that messages and topics name the camera.
  bool hasCameraList() const { return !cameras.front().name.empty(); }
};

/// Reads every parameter from a mapping; absent ones keep their defaults. Throws InputError with
/// one line that names the key if one is missing, unknown, not a number, or out of range.
LocalizerParameters readParameters(const YamlReader& reader);

/// The same from the parameter server: all parameters below `name_space`, e.g. "/localizer". There
/// must be a map_file.
LocalizerParameters readParameters(const std::string& name_space);

}  // namespace omnitag
