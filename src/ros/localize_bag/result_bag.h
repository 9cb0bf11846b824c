#pragma once

#include <rosbag/bag.h>
#include <rosbag/message_instance.h>

#include <string>

#include "omnitag/marker/marker_map.h"
#include "omnitag/ros/frame_markers.h"
#include "omnitag/ros/image_localizer.h"
#include "omnitag/ros/parameters.h"
#include "omnitag/ros/path_recorder.h"

namespace omnitag {

/// A copy of the input bag together with what the localizer publishes on its topics, but for the
/// debug image and the diagnostics. Messages and transforms of the input that it publishes itself
/// are left out.
class ResultBag {
 public:
  /// `sends_transform`: whether tf has a place for the robot's. Throws InputError where the bag
  /// cannot be written.
  ResultBag(const std::string& path, const FrameNames& frames,
            const LocalizerParameters& parameters, bool sends_transform);

  /// A message of the input.
  void copy(const rosbag::MessageInstance& message);

  /// What an image gave; `time`: when it was recorded.
  void add(const ros::Time& time, const LocalizedImage& localized, const ImageLocalizer& localizer);

  void close() { bag_.close(); }

 private:
  FrameNames frames_;
  double transform_tolerance_;
  bool sends_transform_;
  FrameMarkers frame_markers_;
  PathRecorder path_;
  bool has_map_markers_ = false;
  rosbag::Bag bag_;
};

}  // namespace omnitag
