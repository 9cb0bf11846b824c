#pragma once

#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/PoseWithCovariance.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <geometry_msgs/Quaternion.h>
#include <geometry_msgs/Transform.h>
#include <omnitag/LocalizationStatus.h>
#include <omnitag/MarkerDetectionArray.h>
#include <std_msgs/Header.h>
#include <tf2/buffer_core.h>

#include <Eigen/Geometry>
#include <optional>
#include <string>

#include "omnitag/common/pose.h"
#include "omnitag/localization/localizer.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// s, beyond which ros::Time has no stamps and throws.
constexpr double kTimesEnd = 4294967295.0;

/// The name of a frame as tf2 compares it.
std::string withoutSlash(const std::string& frame);

geometry_msgs::Point toMessage(const Eigen::Vector3d& point);
geometry_msgs::Quaternion toMessage(const Eigen::Quaterniond& rotation);
geometry_msgs::Pose toMessage(const Pose& pose);
/// Where a marker hangs in the map.
geometry_msgs::Pose poseOf(const Marker& marker);
geometry_msgs::Transform toMessage(const Eigen::Isometry3d& target_from_source);

/// The covariance is of (x, y, z) and of rotations about the target frame's x, y and z.
geometry_msgs::PoseWithCovariance toMessage(const PoseEstimate& estimate);

/// The floor's share of a 6 x 6 covariance; nothing where it is not finite or not positive
/// definite, i.e. was not filled in.
std::optional<Eigen::Matrix3d> planarCovariance(const geometry_msgs::PoseWithCovariance& pose);

Eigen::Isometry3d fromMessage(const geometry_msgs::Transform& target_from_source);

/// From one frame to another at a time; nothing where tf does not know that.
std::optional<Eigen::Isometry3d> findTransform(const tf2::BufferCore& transforms,
                                               const std::string& target, const std::string& source,
                                               const ros::Time& time);

/// Throws InputError for coordinates that are not finite or a quaternion that is not of length 1
/// within 1 %.
Eigen::Isometry3d fromMessage(const geometry_msgs::Pose& pose);

/// Where nothing is known: NaN, and -1 as the first variance.
geometry_msgs::PoseWithCovariance noPose();

/// The header is the image's. Without poses: addMarkerPoses().
MarkerDetectionArray toMessage(const std_msgs::Header& header,
                               const std::vector<MarkerDetection>& detections,
                               const MarkerMap& map);

/// `header`: with the map's frame. Without the counts of images, which the result does not know.
LocalizationStatus toMessage(const std_msgs::Header& header, const FrameResult& result);

}  // namespace omnitag
