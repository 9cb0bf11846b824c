#pragma once

#include <memory>
#include <random>
#include <string>
#include <vector>

#include "omnitag/camera/camera_model.h"
#include "omnitag/localization/localizer_config.h"
#include "recorded_sequence.h"

namespace omnitag {

/// By what a robot, its map and its camera file differ from what a recorded frame shows: the files
/// and the mounting are disturbed, the image stays. "Per frame" is drawn anew for each.
struct Disturbance {
  std::string name;
  /// Standard deviations per frame: of roll and pitch each (rad), of the height (m).
  double lean = 0.0;
  double height = 0.0;
  /// The same in all frames: the angle by which the base leans, in a direction that is drawn, and
  /// its height.
  double constant_lean = 0.0;
  double constant_height = 0.0;
  /// Standard deviations of the markers' places (m) and orientations (rad), per axis, and what the
  /// map says of them.
  double marker = 0.0;
  double marker_orientation = 0.0;
  double stated_marker = 0.0;
  double stated_marker_orientation = 0.0;
  /// Standard deviations of the lens's centre (pixels, per axis) and of what the focal length shows
  /// at the rim (pixels).
  double center = 0.0;
  double rim = 0.0;
  /// Fixed errors: of the centre in a direction that is drawn (pixels), of the focal length
  /// (relative), of the mirror's distance (m).
  double fixed_center = 0.0;
  double focal = 0.0;
  double apex = 0.0;
  /// What the camera file says that it is off by, in pixels for each mode where the image is 500
  /// pixels high.
  double stated_camera = 0.0;
  /// NEES that is allowed: its 95 % bounds, or up to this.
  double most_nees = 0.0;
};

std::vector<Disturbance> disturbances();

/// The camera that took the images, with what a disturbed file says that it is off by.
std::shared_ptr<const CameraModel> trueCamera(const Disturbance& disturbance,
                                              const CameraModel& exact,
                                              const std::string& camera_file);

/// A frame with its truth, and the files as somebody has them.
struct DisturbedFrame {
  std::shared_ptr<const CameraModel> camera;
  MarkerMap map;
  Frame frame;
  Pose truth;
};

/// Draws what a disturbance makes of a frame of a sequence whose camera file is `camera_file`.
DisturbedFrame disturbed(const Disturbance& disturbance, const RecordedSequence& sequence,
                         const std::string& camera_file, std::size_t frame,
                         std::mt19937* generator);

}  // namespace omnitag
