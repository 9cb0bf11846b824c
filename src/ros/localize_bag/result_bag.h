#pragma once

#include <rosbag/bag.h>
#include <rosbag/message_instance.h>

#include <string>

#include "omnitag/marker/marker_map.h"
#include "ros/debug_image.h"
#include "ros/frame_markers.h"
#include "ros/image_localizer.h"
#include "ros/parameters.h"
#include "ros/path_recorder.h"

namespace omnitag {

/// A copy of the input together with what the localizer publishes on a robot, the debug image in
/// image_transport's format `compressed`. /diagnostics stay as they are: they describe a running
/// node. Messages and transforms of the input that the localizer publishes itself are left out.
class ResultBag {
 public:
  /// `sends_transform`: whether to write the robot's transform. Throws InputError if the bag cannot
  /// be written.
  ResultBag(const std::string& path, const LocalizerParameters& parameters,
            const ImageLocalizer& localizer, bool sends_transform);

  /// Copies a message of the input, to be recorded at `time`.
  void copy(const rosbag::MessageInstance& message, const ros::Time& time);

  /// Adds the result of an image. `time`: when the image was recorded.
  void add(const ros::Time& time, const LocalizedImage& localized, const ImageLocalizer& localizer);

  void close() { bag_.close(); }

 private:
  /// Whether the localizer publishes on a topic itself.
  bool isOwn(const std::string& topic) const;
  void addMap(const ros::Time& time, const ImageLocalizer& localizer);
  void addDebugImage(const ros::Time& time, const LocalizedImage& localized);

  FrameNames frames_;
  double transform_tolerance_;
  bool sends_transform_;
  bool sends_marker_transforms_;
  EstimatorConfig estimation_;
  FrameMarkers frame_markers_;
  /// By camera: topic and painter of its debug images.
  std::vector<std::string> debug_image_topics_;
  std::vector<DebugImagePainter> debug_image_painters_;
  PathRecorder path_;
  bool has_map_markers_ = false;
  rosbag::Bag bag_;
};

}  // namespace omnitag
