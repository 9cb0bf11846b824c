#include "ros/conversions.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "localization/marker_in_camera.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

/// The indices of x, y and yaw in (x, y, z, roll, pitch, yaw).
constexpr std::array<std::size_t, 3> kPlanarIndices = {0, 1, 5};

std::size_t covarianceIndex(int row, int column) {
  return 6 * kPlanarIndices[static_cast<std::size_t>(row)] +
         kPlanarIndices[static_cast<std::size_t>(column)];
}

std::uint8_t modeOf(Mode mode) {
  switch (mode) {
    case Mode::kTracking:
      return LocalizationStatus::TRACKING;
    case Mode::kDeadReckoning:
      return LocalizationStatus::DEAD_RECKONING;
    case Mode::kFound:
      return LocalizationStatus::FOUND;
    case Mode::kSearching:
      break;
  }
  return LocalizationStatus::SEARCHING;
}

}  // namespace

std::string withoutSlash(const std::string& frame) {
  return !frame.empty() && frame.front() == '/' ? frame.substr(1) : frame;
}

geometry_msgs::Point toMessage(const Eigen::Vector3d& point) {
  geometry_msgs::Point message;
  message.x = point.x();
  message.y = point.y();
  message.z = point.z();
  return message;
}

geometry_msgs::Quaternion toMessage(const Eigen::Quaterniond& rotation) {
  geometry_msgs::Quaternion message;
  message.w = rotation.w();
  message.x = rotation.x();
  message.y = rotation.y();
  message.z = rotation.z();
  return message;
}

geometry_msgs::Pose toMessage(const Pose& pose) {
  geometry_msgs::Pose message;
  message.position.x = pose.x;
  message.position.y = pose.y;
  message.position.z = pose.z;
  message.orientation = toMessage(Eigen::Quaterniond(pose.toIsometry().linear()));
  return message;
}

geometry_msgs::Pose poseOf(const Marker& marker) {
  geometry_msgs::Pose pose;
  pose.position = toMessage(marker.center());
  pose.orientation = toMessage(Eigen::Quaterniond(marker.map_from_marker.linear()).normalized());
  return pose;
}

geometry_msgs::Transform toMessage(const Eigen::Isometry3d& target_from_source) {
  geometry_msgs::Transform message;
  message.translation.x = target_from_source.translation().x();
  message.translation.y = target_from_source.translation().y();
  message.translation.z = target_from_source.translation().z();
  message.rotation = toMessage(Eigen::Quaterniond(target_from_source.linear()).normalized());
  return message;
}

geometry_msgs::PoseWithCovariance toMessage(const PoseEstimate& estimate) {
  geometry_msgs::PoseWithCovariance message;
  message.pose = toMessage(estimate.pose);
  // PoseEstimate's rotations are about the base's own axes, ROS's about those of the target frame.
  const Eigen::Matrix3d map_from_base = estimate.pose.toIsometry().linear();
  Eigen::Matrix<double, 6, 6> turned;
  for (int i = 0; i < 6; ++i) {
    const PoseVector unit = PoseVector::Unit(i);
    turned.col(i) << translationPart(unit), map_from_base * rotationPart(unit);
  }
  const Eigen::Matrix<double, 6, 6> covariance = turned * estimate.covariance * turned.transpose();
  const Eigen::Matrix<double, 6, 6, Eigen::RowMajor> symmetric =
      0.5 * (covariance + covariance.transpose());
  std::copy_n(symmetric.data(), symmetric.size(), message.covariance.begin());
  return message;
}

std::optional<Eigen::Matrix3d> planarCovariance(const geometry_msgs::PoseWithCovariance& pose) {
  Eigen::Matrix3d covariance;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      covariance(row, column) = pose.covariance[covarianceIndex(row, column)];
    }
  }
  const Eigen::Matrix3d symmetric = (covariance + covariance.transpose()) / 2.0;
  if (!symmetric.allFinite()) return std::nullopt;
  if (symmetric.llt().info() != Eigen::Success) return std::nullopt;
  return symmetric;
}

Eigen::Isometry3d fromMessage(const geometry_msgs::Transform& target_from_source) {
  const geometry_msgs::Vector3& t = target_from_source.translation;
  const geometry_msgs::Quaternion& q = target_from_source.rotation;
  return Eigen::Translation3d(t.x, t.y, t.z) * Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized();
}

std::optional<Eigen::Isometry3d> findTransform(const tf2::BufferCore& transforms,
                                               const std::string& target, const std::string& source,
                                               const ros::Time& time) {
  if (!transforms.canTransform(target, source, time)) return std::nullopt;
  return fromMessage(transforms.lookupTransform(target, source, time).transform);
}

Eigen::Isometry3d fromMessage(const geometry_msgs::Pose& pose) {
  const Eigen::Vector3d position(pose.position.x, pose.position.y, pose.position.z);
  const Eigen::Quaterniond rotation(pose.orientation.w, pose.orientation.x, pose.orientation.y,
                                    pose.orientation.z);
  if (!position.allFinite() || !rotation.coeffs().allFinite()) {
    throw InputError("expected a pose of finite numbers, found NaN or infinity");
  }
  if (std::abs(rotation.norm() - 1.0) > 0.01) {
    throw InputError("expected a quaternion of length 1, found one of length " +
                     std::to_string(rotation.norm()));
  }
  return Eigen::Translation3d(position) * rotation.normalized();
}

geometry_msgs::PoseWithCovariance noPose() {
  geometry_msgs::PoseWithCovariance none;
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  none.pose.position.x = none.pose.position.y = none.pose.position.z = kNaN;
  none.pose.orientation.w = none.pose.orientation.x = kNaN;
  none.pose.orientation.y = none.pose.orientation.z = kNaN;
  none.covariance.front() = -1.0;
  return none;
}

DetectedMarker detectedMarkerOf(const MarkerDetection& detection, const MarkerMap& map) {
  DetectedMarker message;
  message.id = detection.id;
  message.family = detection.family;
  message.map_entry = -1;
  if (detection.map_entry) {
    message.name = map.markers[*detection.map_entry].name;
    message.map_entry = static_cast<std::int32_t>(*detection.map_entry);
  }
  message.accepted = static_cast<std::uint8_t>(detection.accepted);
  message.reason = detection.reason;
  message.bearing.x = detection.sight.x();
  message.bearing.y = detection.sight.y();
  message.bearing.z = detection.sight.z();
  message.range = detection.range;
  message.residual = detection.residual;
  for (std::size_t i = 0; i < detection.corners.size(); ++i) {
    message.corners[i].x = detection.corners[i].x();
    message.corners[i].y = detection.corners[i].y();
  }
  message.hamming = detection.hamming;
  message.margin = detection.margin;
  message.size = sizeOf(detection, map);
  message.pose = noPose();
  return message;
}

MarkerDetectionArray toMessage(const std_msgs::Header& header,
                               const std::vector<MarkerDetection>& detections,
                               const MarkerMap& map) {
  MarkerDetectionArray message;
  message.header = header;
  for (const MarkerDetection& detection : detections) {
    message.detections.push_back(detectedMarkerOf(detection, map));
  }
  return message;
}

LocalizationStatus toMessage(const std_msgs::Header& header, const FrameResult& result) {
  LocalizationStatus message;
  message.header = header;
  message.mode = modeOf(result.mode);
  message.has_pose = static_cast<std::uint8_t>(result.map_from_base.has_value());
  message.remark = result.remark;
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  message.height = result.map_from_base ? result.map_from_base->pose.z : kNaN;
  message.roll = result.map_from_base ? result.map_from_base->pose.roll : kNaN;
  message.pitch = result.map_from_base ? result.map_from_base->pose.pitch : kNaN;
  message.position_deviation = message.heading_deviation = kNaN;
  if (result.map_from_base) {
    const PoseEstimate published = result.publishedPose();
    message.position_deviation = positionDeviation(published);
    message.heading_deviation = std::sqrt(published.covariance(2, 2));
  }
  for (const WeightedPose& hypothesis : result.hypotheses) {
    const Pose& pose = hypothesis.map_from_base.pose;
    message.hypotheses.push_back(toMessage(result.is_on_floor ? pose.onFloor() : pose));
    message.probabilities.push_back(hypothesis.probability);
  }
  message.markers_predicted = static_cast<std::uint32_t>(result.predicted.size());
  message.markers_detected = static_cast<std::uint32_t>(result.detections.size());
  message.markers_used = static_cast<std::uint32_t>(result.acceptedMarkers());
  message.residual_ratio = std::sqrt(result.excess);
  message.blur = result.blur.largestDeviation();
  message.blur_turn = std::sqrt(result.blur.turn_square);
  message.image_lag = result.image_lag.value_or(kNaN);
  message.exposure = toString(result.exposure);
  message.advice = result.advice;
  message.predict_time = result.timings.predict;
  message.recognize_time = result.timings.recognize;
  message.warp_time = result.timings.warp;
  message.decode_time = result.timings.decode;
  message.solve_time = result.timings.solve;
  message.total_time = result.timings.total;
  return message;
}

}  // namespace omnitag
