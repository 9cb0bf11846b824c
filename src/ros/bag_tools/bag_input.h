#pragma once

#include <cv_bridge/cv_bridge.h>
#include <geometry_msgs/TransformStamped.h>
#include <rosbag/bag.h>
#include <rosbag/message_instance.h>
#include <tf2/buffer_core.h>

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ros/camera_info.h"
#include "ros/parent_watch.h"

namespace omnitag {

/// A part of a recording, in seconds of recording time since its first message.
struct RecordedSpan {
  double from = 0.0;
  double until = std::numeric_limits<double>::infinity();
};

/// A recording in one bag or several: its images and its transforms.
class BagInput {
 public:
  using MessageUser = std::function<void(const rosbag::MessageInstance&)>;

  /// `paths`: bags, read one after another; the transforms of each apply to all. `image_topics`:
  /// those of the cameras, which may be the same, with or without /compressed; empty: the only
  /// topic with images. Throws InputError if a bag cannot be read, or if a topic is missing or
  /// ambiguous.
  BagInput(const std::vector<std::string>& paths, const std::vector<std::string>& image_topics,
           const RecordedSpan& span = {});
  BagInput(const std::vector<std::string>& paths, const std::string& image_topic,
           const RecordedSpan& span = {})
      : BagInput(paths, std::vector<std::string>{image_topic}, span) {}
  BagInput(const std::string& path, const std::string& image_topic)
      : BagInput(std::vector<std::string>{path}, image_topic) {}

  /// As in the bag. `camera`: its index among the topics.
  const std::string& imageTopic(std::size_t camera = 0) const { return image_topics_[camera]; }
  /// Whether a message is on one of the cameras' topics.
  bool isImage(const rosbag::MessageInstance& message) const;
  /// The number of images in the span.
  std::size_t imageCount() const;
  /// Passes on the images of the span in the order of recording: bag by bag, or merged if there are
  /// several topics, which may be in separate bags. Their messages must not outlive this object.
  void forEachImage(const MessageUser& use) const;
  /// The same for all messages.
  void forEachMessage(const MessageUser& use) const;
  /// Static transforms from before the span.
  void forEachEarlierStatic(const MessageUser& use) const;
  /// When the span begins.
  ros::Time begin() const { return begin_; }

  /// All transforms of /tf and /tf_static, including those outside the span.
  const tf2::BufferCore& transforms() const { return *transforms_; }

  /// Why no transform from the map can be sent in this recording, from ParentWatch; nothing if it
  /// can. `frames`: with the map's frame filled in.
  std::optional<std::string> parentConflict(const FrameNames& frames) const;

  /// Mounts the frame of the only camera's images on `base_frame` as given, whatever the bag's
  /// transforms say.
  void replaceMounting(const std::string& base_frame, const Eigen::Isometry3d& base_from_camera);

  /// The camera that the first camera_info beside an image topic describes. Throws InputError if
  /// there is none, or it describes no camera.
  DescribedCamera describedCamera(std::size_t camera = 0) const;

  /// The camera of a file, or of camera_info if `file` is empty; scaled to the bag's images if the
  /// file says so.
  DescribedCamera cameraOf(const std::string& file, std::size_t camera = 0) const;

  /// An image message in grey. Throws InputError if it cannot be read.
  static cv_bridge::CvImageConstPtr grayImageOf(const rosbag::MessageInstance& message);

 private:
  template <typename... Query>
  void forEach(const MessageUser& use, const Query&... query) const;
  void setSpan(const RecordedSpan& span);
  /// Of the first image; nothing if there is none or it cannot be read.
  std::optional<ImageSize> imageSize(std::size_t camera) const;
  /// The first frame that an image names. Throws InputError if none does.
  std::string cameraFrame() const;
  /// Passes on each transform of the bags, and whether it is static.
  void forEachTransform(
      const std::function<void(const geometry_msgs::TransformStamped&, bool)>& take) const;
  /// All transforms except those of one child frame, if it is named.
  void loadTransforms(const std::string& without_child);

  /// The bags' paths, for errors.
  std::string path_;
  std::vector<std::unique_ptr<rosbag::Bag>> bags_;
  /// The span in recording time.
  ros::Time begin_ = ros::TIME_MIN;
  ros::Time end_ = ros::TIME_MAX;
  /// By camera.
  std::vector<std::string> image_topics_;
  std::unique_ptr<tf2::BufferCore> transforms_;
};

}  // namespace omnitag
