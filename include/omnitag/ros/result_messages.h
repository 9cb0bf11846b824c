#pragma once

#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <geometry_msgs/TransformStamped.h>
#include <omnitag/LocalizationStatus.h>
#include <omnitag/MarkerDetectionArray.h>

#include <optional>

#include "omnitag/ros/image_localizer.h"
#include "omnitag/ros/parameters.h"

namespace omnitag {

/// What is published for one image.
struct ResultMessages {
  std::optional<geometry_msgs::PoseStamped> pose;
  std::optional<geometry_msgs::PoseWithCovarianceStamped> pose_with_covariance;
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

}  // namespace omnitag
