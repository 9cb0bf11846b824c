#pragma once

#include <memory>
#include <string>
#include <vector>

#include "omnitag/camera/camera_model.h"
#include "omnitag/localization/frame_result.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// A rendered sequence with its truth.
struct RecordedSequence {
  std::shared_ptr<const CameraModel> camera;
  MarkerMap map;
  /// With the camera's mounting, and with odometry where it was asked for and the bag has it.
  std::vector<Frame> frames;
  /// base_link in the map, for each frame.
  std::vector<Pose> truth;
};

/// Loads camera file, map, images, the mounting from /tf_static and the truth from
/// /ground_truth/pose of a bag of render_sequence. `odom_frame`: takes odometry from there to
/// base_link from /tf, as localize_bag does; empty: none. Throws InputError.
RecordedSequence loadSequence(const std::string& bag, const std::string& camera_file,
                              const std::string& map_file, const std::string& odom_frame = "");

/// The shipped one: the paper's experiment.
RecordedSequence shippedSequence();

/// The one that the arguments BAG CAMERA MAP name, or the shipped one without arguments, which has
/// no odometry. Throws InputError.
RecordedSequence sequenceFrom(int argc, char** argv, const std::string& odom_frame = "");

/// Its camera file.
std::string cameraFileFrom(int argc, char** argv);

}  // namespace omnitag
