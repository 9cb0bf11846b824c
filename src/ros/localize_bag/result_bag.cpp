#include "result_bag.h"

#include <tf2_msgs/TFMessage.h>

#include <algorithm>

#include "omnitag/common/error.h"
#include "omnitag/ros/conversions.h"
#include "omnitag/ros/map_markers.h"
#include "omnitag/ros/parent_watch.h"
#include "omnitag/ros/result_messages.h"

namespace omnitag {
namespace {

bool isOwn(const std::string& topic) {
  return topic == "/pose" || topic == "/pose_with_covariance" || topic == "/pose_measured" ||
         topic == "/detections" || topic == "/status" || topic == "/path" || topic == "/markers";
}

}  // namespace

ResultBag::ResultBag(const std::string& path, const FrameNames& frames,
                     const LocalizerParameters& parameters, bool sends_transform)
    : frames_(frames),
      transform_tolerance_(parameters.transform_tolerance),
      sends_transform_(sends_transform),
      frame_markers_(frames.map, parameters.robot_radius),
      path_(parameters.path_min_step, parameters.path_max_poses) {
  try {
    bag_.open(path, rosbag::bagmode::Write);
  } catch (const std::exception&) {
    throw InputError(path + ": cannot be written");
  }
}

void ResultBag::copy(const rosbag::MessageInstance& message) {
  if (isOwn(message.getTopic())) return;
  if (message.getTopic() == "/tf") {
    if (const auto transforms = message.instantiate<tf2_msgs::TFMessage>()) {
      tf2_msgs::TFMessage kept = *transforms;
      kept.transforms.erase(std::remove_if(kept.transforms.begin(), kept.transforms.end(),
                                           [&](const geometry_msgs::TransformStamped& transform) {
                                             return withoutSlash(transform.header.frame_id) ==
                                                        withoutSlash(frames_.map) &&
                                                    withoutSlash(transform.child_frame_id) ==
                                                        withoutSlash(sentFrame(frames_));
                                           }),
                            kept.transforms.end());
      if (!kept.transforms.empty()) bag_.write("/tf", message.getTime(), kept);
      return;
    }
  }
  bag_.write(message.getTopic(), message.getTime(), message, message.getConnectionHeader());
}

void ResultBag::add(const ros::Time& time, const LocalizedImage& localized,
                    const ImageLocalizer& localizer) {
  const MarkerMap& map = localizer.map();
  if (!has_map_markers_ || localized.map_changed) {
    bag_.write("/markers", time, mapMarkers(map, localizer.provisional(), frames_.map));
  }
  has_map_markers_ = true;
  if (localized.went_back > 0.0) path_.clear();

  const ResultMessages messages = toMessages(localized, map, frames_, transform_tolerance_);
  if (messages.transform && sends_transform_) {
    tf2_msgs::TFMessage transforms;
    transforms.transforms.push_back(*messages.transform);
    bag_.write("/tf", time, transforms);
  }
  if (messages.pose) {
    bag_.write("/pose", time, *messages.pose);
    bag_.write("/pose_with_covariance", time, *messages.pose_with_covariance);
    if (path_.add(*messages.pose)) bag_.write("/path", time, path_.path());
  }
  if (messages.pose_measured) bag_.write("/pose_measured", time, *messages.pose_measured);
  bag_.write("/detections", time, messages.detections);
  bag_.write("/status", time, messages.status);
  bag_.write("/markers", time, frame_markers_.draw(localized, map));
}

}  // namespace omnitag
