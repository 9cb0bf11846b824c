#include "ros/result_messages.h"

#include "localization/marker_in_camera.h"
#include "ros/conversions.h"

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
  // On a floor, odometry's lean stays in odom -> base.
  const Eigen::Isometry3d odom_from_base =
      result.is_on_floor ? Pose::fromIsometry(*input.odom_from_base).onFloor().toIsometry()
                         : *input.odom_from_base;
  const Eigen::Isometry3d map_from_odom = map_from_base * odom_from_base.inverse();
  message.transform = toMessage(map_from_odom);
  return message;
}

/// Where the marker should be in the camera's frame according to the map and the frame's pose;
/// nothing without an entry or a pose.
std::optional<Eigen::Isometry3d> expectedPlace(const LocalizedImage& localized,
                                               const MarkerDetection& detection,
                                               const MarkerMap& map) {
  if (!localized.result.map_from_base || !detection.map_entry) return std::nullopt;
  const Eigen::Isometry3d map_from_camera =
      localized.result.map_from_base->pose.toIsometry() * localized.input.frame.base_from_camera;
  return map_from_camera.inverse() * map.markers[*detection.map_entry].map_from_marker;
}

}  // namespace

void addMarkerPoses(const LocalizedImage& localized, const MarkerMap& map,
                    const std::shared_ptr<const CameraModel>& camera, const EstimatorConfig& config,
                    MarkerDetectionArray* detections) {
  for (std::size_t i = 0; i < localized.result.detections.size(); ++i) {
    const MarkerDetection& detection = localized.result.detections[i];
    const double size = sizeOf(detection, map);
    if (size <= 0.0) continue;
    const auto place =
        markerInCamera(camera, detection, size, expectedPlace(localized, detection, map), config);
    if (place) detections->detections[i].pose = toMessage(*place);
  }
}

ResultMessages toMessages(const LocalizedImage& localized, const MarkerMap& map,
                          const FrameNames& frames, double transform_tolerance) {
  const std_msgs::Header& image_header = localized.input.header;
  ResultMessages messages;
  messages.detections = toMessage(image_header, localized.result.detections, map);
  std_msgs::Header map_header = image_header;
  map_header.frame_id = frames.map;
  messages.status = toMessage(map_header, localized.result);
  messages.status.camera = localized.camera_name;
  if (!localized.result.map_from_base) return messages;

  const PoseEstimate estimate = localized.result.publishedPose();
  messages.pose.emplace();
  messages.pose->header = map_header;
  messages.pose->pose = toMessage(estimate.pose);
  messages.pose_with_covariance.emplace();
  messages.pose_with_covariance->header = map_header;
  messages.pose_with_covariance->pose = toMessage(estimate);
  if (const auto measured = localized.result.publishedMeasurement()) {
    messages.pose_measured.emplace();
    messages.pose_measured->header = map_header;
    messages.pose_measured->pose = toMessage(*measured);
  }
  // tf accepts no second transform with the same stamp.
  if (!localized.is_newest) return messages;
  messages.transform =
      robotTransform(localized.input, localized.result, frames, transform_tolerance);
  return messages;
}

}  // namespace omnitag
