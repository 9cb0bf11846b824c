#pragma once

#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <geometry_msgs/TransformStamped.h>
#include <omnitag/LocalizationStatus.h>
#include <omnitag/MarkerDetectionArray.h>

#include <memory>
#include <optional>

#include "ros/image_localizer.h"
#include "ros/parameters.h"

namespace omnitag {

/// What is published for one image.
struct ResultMessages {
  std::optional<geometry_msgs::PoseStamped> pose;
  std::optional<geometry_msgs::PoseWithCovarianceStamped> pose_with_covariance;
  /// From the image alone; none if it was not wanted or the image shows no marker.
  std::optional<geometry_msgs::PoseWithCovarianceStamped> pose_measured;
  std::optional<geometry_msgs::TransformStamped> transform;
  MarkerDetectionArray detections;
  LocalizationStatus status;
};

/// Everything has the stamp of the image except map -> odom. This correction is valid until the
/// next one, so it is stamped `transform_tolerance` later to be usable until then, as in amcl.
///
/// The transform is map -> odom if an odometry frame is set, else map -> base. There is none
/// without a pose, or if odometry is set but missing.
ResultMessages toMessages(const LocalizedImage& localized, const MarkerMap& map,
                          const FrameNames& frames, double transform_tolerance);

/// Adds to each detection its pose in the camera's frame (markerInCamera()), which takes a few
/// tenths of a millisecond each.
void addMarkerPoses(const LocalizedImage& localized, const MarkerMap& map,
                    const std::shared_ptr<const CameraModel>& camera, const EstimatorConfig& config,
                    MarkerDetectionArray* detections);

}  // namespace omnitag
