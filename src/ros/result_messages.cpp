#include "omnitag/ros/result_messages.h"

#include "omnitag/ros/conversions.h"

namespace omnitag {
namespace {

std::optional<geometry_msgs::TransformStamped> robotTransform(const AssembledFrame& input,
                                                              const FrameResult& result,
                                                              const FrameNames& frames,
                                                              double transform_tolerance) {
  geometry_msgs::TransformStamped message;
  message.header.frame_id = frames.map;
  message.header.stamp = input.header.stamp;
  const Eigen::Isometry3d map_from_base = result.publishedPose().pose.toIsometry();
  if (frames.odom.empty()) {
    message.child_frame_id = frames.base;
    message.transform = toMessage(map_from_base);
    return message;
  }
  if (!input.odom_from_base) return std::nullopt;
  message.header.stamp += ros::Duration(transform_tolerance);
  message.child_frame_id = frames.odom;
  // On a floor, what odometry says of leaning stays with odometry.
  const Eigen::Isometry3d odom_from_base =
      result.is_on_floor ? Pose::fromIsometry(*input.odom_from_base).onFloor().toIsometry()
                         : *input.odom_from_base;
  const Eigen::Isometry3d map_from_odom = map_from_base * odom_from_base.inverse();
  message.transform = toMessage(map_from_odom);
  return message;
}

}  // namespace

ResultMessages toMessages(const LocalizedImage& localized, const MarkerMap& map,
                          const FrameNames& frames, double transform_tolerance) {
  const std_msgs::Header& image_header = localized.input.header;
  ResultMessages messages;
  messages.detections = toMessage(image_header, localized.result.detections, map);
  messages.status = toMessage(image_header, localized.result);
  if (!localized.result.map_from_base) return messages;

  std_msgs::Header map_header = image_header;
  map_header.frame_id = frames.map;
  const PoseEstimate estimate = localized.result.publishedPose();
  messages.pose.emplace();
  messages.pose->header = map_header;
  messages.pose->pose = toMessage(estimate.pose);
  messages.pose_with_covariance.emplace();
  messages.pose_with_covariance->header = map_header;
  messages.pose_with_covariance->pose = toMessage(estimate);
  messages.transform =
      robotTransform(localized.input, localized.result, frames, transform_tolerance);
  return messages;
}

}  // namespace omnitag
