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

/// s: the last stamp of ros::Time, which throws beyond it.
constexpr double kTimesEnd = 4294967295.0;

/// A frame's name as tf2 compares it.
std::string withoutSlash(const std::string& frame);

geometry_msgs::Point toMessage(const Eigen::Vector3d& point);
geometry_msgs::Quaternion toMessage(const Eigen::Quaterniond& rotation);
geometry_msgs::Pose toMessage(const Pose& pose);
/// Where a marker hangs in the map.
geometry_msgs::Pose poseOf(const Marker& marker);
geometry_msgs::Transform toMessage(const Eigen::Isometry3d& target_from_source);

/// The covariance is of (x, y, z) and of rotations about the x, y and z axes of the target frame.
geometry_msgs::PoseWithCovariance toMessage(const PoseEstimate& estimate);

/// The part for (x, y, yaw) of a 6 x 6 covariance; nothing if it is not finite or not positive
/// definite, i.e. was not filled in.
std::optional<Eigen::Matrix3d> planarCovariance(const geometry_msgs::PoseWithCovariance& pose);

Eigen::Isometry3d fromMessage(const geometry_msgs::Transform& target_from_source);

/// target_from_source at a time; nothing if tf does not know it.
std::optional<Eigen::Isometry3d> findTransform(const tf2::BufferCore& transforms,
                                               const std::string& target, const std::string& source,
                                               const ros::Time& time);

/// Throws InputError for coordinates that are not finite, or a quaternion whose length is not
/// within 1 % of 1.
Eigen::Isometry3d fromMessage(const geometry_msgs::Pose& pose);

/// An unknown pose: NaN, and -1 as the first variance.
geometry_msgs::PoseWithCovariance noPose();

/// `header`: the image's. The poses are noPose() until addMarkerPoses() fills them in.
MarkerDetectionArray toMessage(const std_msgs::Header& header,
                               const std::vector<MarkerDetection>& detections,
                               const MarkerMap& map);

/// `header`: with the map's frame. Leaves out the image's age and the counts of images, which are
/// not in the result.
LocalizationStatus toMessage(const std_msgs::Header& header, const FrameResult& result);

}  // namespace omnitag
