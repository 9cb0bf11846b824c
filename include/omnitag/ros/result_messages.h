#pragma once

#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <geometry_msgs/TransformStamped.h>
#include <omnitag/LocalizationStatus.h>
#include <omnitag/MarkerDetectionArray.h>

#include <memory>
#include <optional>

#include "omnitag/ros/image_localizer.h"
#include "omnitag/ros/parameters.h"

namespace omnitag {

/// What is published for one image.
struct ResultMessages {
  std::optional<geometry_msgs::PoseStamped> pose;
  std::optional<geometry_msgs::PoseWithCovarianceStamped> pose_with_covariance;
  /// Of the image alone; none where it shows no marker.
  std::optional<geometry_msgs::PoseWithCovarianceStamped> pose_measured;
  std::optional<geometry_msgs::TransformStamped> transform;
  MarkerDetectionArray detections;
  LocalizationStatus status;
};

/// Everything is stamped with the image, but for map -> odom: a correction that holds until the
/// next one, it is stamped `transform_tolerance` later so that tf can be used meanwhile, as amcl
/// does.
///
/// The transform is map -> odom where an odometry frame is set, else map -> base. There is none
/// without a pose, and none without odometry where there should be one.
ResultMessages toMessages(const LocalizedImage& localized, const MarkerMap& map,
                          const FrameNames& frames, double transform_tolerance);

/// Adds to each detection its pose in the camera's frame (markerInCamera()), which takes some
/// tenths of a millisecond for each.
void addMarkerPoses(const LocalizedImage& localized, const MarkerMap& map,
                    const std::shared_ptr<const CameraModel>& camera, const EstimatorConfig& config,
                    MarkerDetectionArray* detections);

}  // namespace omnitag
