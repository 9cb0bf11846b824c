#include "omnitag/localization/motion_model.h"

#include <Eigen/LU>
#include <cmath>

#include "omnitag/common/symmetric_matrix.h"

namespace omnitag {

MotionModelConfig readMotionModelConfig(const YamlReader& reader) {
  reader.allowOnly({"acceleration_deviation", "angular_acceleration_deviation",
                    "initial_speed_deviation", "initial_turn_rate_deviation",
                    "odometry_rotation_per_rotation", "odometry_rotation_per_metre",
                    "odometry_translation_per_metre", "odometry_translation_per_rotation",
                    "initial_position_deviation", "initial_heading_deviation",
                    "max_dead_reckoning_time", "max_position_deviation", "max_heading_deviation",
                    "max_initial_time", "max_initial_position_deviation",
                    "max_initial_heading_deviation"});
  MotionModelConfig config;
  reader.read("acceleration_deviation", &config.acceleration_deviation, kPositive);
  reader.read("angular_acceleration_deviation", &config.angular_acceleration_deviation, kPositive);
  reader.read("initial_speed_deviation", &config.initial_speed_deviation, kPositive);
  reader.read("initial_turn_rate_deviation", &config.initial_turn_rate_deviation, kPositive);
  reader.read("odometry_rotation_per_rotation", &config.odometry_rotation_per_rotation,
              kNonNegative);
  reader.read("odometry_rotation_per_metre", &config.odometry_rotation_per_metre, kNonNegative);
  reader.read("odometry_translation_per_metre", &config.odometry_translation_per_metre,
              kNonNegative);
  reader.read("odometry_translation_per_rotation", &config.odometry_translation_per_rotation,
              kNonNegative);
  reader.read("initial_position_deviation", &config.initial_position_deviation, kPositive);
  reader.read("initial_heading_deviation", &config.initial_heading_deviation, kPositive);
  reader.read("max_dead_reckoning_time", &config.max_dead_reckoning_time, kNonNegative);
  reader.read("max_position_deviation", &config.max_position_deviation, kPositive);
  reader.read("max_heading_deviation", &config.max_heading_deviation, kPositive);
  reader.read("max_initial_time", &config.max_initial_time, kNonNegative);
  reader.read("max_initial_position_deviation", &config.max_initial_position_deviation, kPositive);
  reader.read("max_initial_heading_deviation", &config.max_initial_heading_deviation, kPositive);
  return config;
}

void MotionModel::reset(const PoseEstimate& map_from_base, double stamp,
                        const std::optional<Pose2>& odom_from_base) {
  restart(map_from_base);
  stamp_ = stamp;
  corrected_stamp_ = stamp;
  known_stamp_ = stamp;
  odom_from_base_ = odom_from_base;
  is_given_ = false;
}

void MotionModel::resetToGiven(const PoseEstimate& map_from_base, double stamp,
                               const std::optional<Pose2>& odom_from_base) {
  reset(map_from_base, stamp, odom_from_base);
  is_given_ = true;
}

void MotionModel::restart(const PoseEstimate& map_from_base) {
  pose_ = map_from_base.pose;
  velocity_.setZero();
  const double speed = config_.initial_speed_deviation;
  const double turn_rate = config_.initial_turn_rate_deviation;
  covariance_.setZero();
  covariance_.topLeftCorner<3, 3>() = map_from_base.covariance;
  covariance_.diagonal().tail<3>() << speed * speed, speed * speed, turn_rate * turn_rate;
}

PoseEstimate MotionModel::predict(double stamp, const std::optional<Pose2>& odom_from_base) {
  if (odom_from_base_ && odom_from_base) {
    moveByOdometry(inverse(*odom_from_base_) * *odom_from_base);
    known_stamp_ = stamp;
  } else {
    moveByVelocity(stamp - stamp_);
  }
  stamp_ = stamp;
  odom_from_base_ = odom_from_base;
  return estimate();
}

void MotionModel::correct(const PoseEstimate& map_from_base) {
  // What the image told about the pose, the velocity learns through their correlation.
  const Eigen::Matrix3d predicted = covariance_.topLeftCorner<3, 3>();
  const Eigen::Matrix3d gain = covariance_.bottomLeftCorner<3, 3>() * predicted.inverse();
  const Eigen::Vector3d correction(map_from_base.pose.x - pose_.x, map_from_base.pose.y - pose_.y,
                                   normalizeAngle(map_from_base.pose.yaw - pose_.yaw));
  velocity_ += gain * correction;
  pose_ = map_from_base.pose;
  const Eigen::Matrix3d velocity_covariance =
      covariance_.bottomRightCorner<3, 3>() -
      gain * (predicted - map_from_base.covariance) * gain.transpose();
  covariance_.topLeftCorner<3, 3>() = map_from_base.covariance;
  covariance_.bottomLeftCorner<3, 3>() = gain * map_from_base.covariance;
  covariance_.topRightCorner<3, 3>() = covariance_.bottomLeftCorner<3, 3>().transpose();
  covariance_.bottomRightCorner<3, 3>() =
      0.5 * (velocity_covariance + velocity_covariance.transpose());
  corrected_stamp_ = stamp_;
  known_stamp_ = stamp_;
  is_given_ = false;
}

bool MotionModel::isTrustworthy() const {
  const Eigen::Matrix2d position_covariance = covariance_.topLeftCorner<2, 2>();
  const double position_variance = eigenPairs(position_covariance).values(1);
  const double without_knowledge = stamp_ - known_stamp_;
  if (is_given_ && without_knowledge > 0.0) return without_knowledge <= config_.max_initial_time;
  const double max_position =
      is_given_ ? config_.max_initial_position_deviation : config_.max_position_deviation;
  const double max_heading =
      is_given_ ? config_.max_initial_heading_deviation : config_.max_heading_deviation;
  const bool is_certain =
      std::sqrt(position_variance) <= max_position && std::sqrt(covariance_(2, 2)) <= max_heading;
  return is_certain && without_knowledge <= config_.max_dead_reckoning_time;
}

void MotionModel::moveByOdometry(const Pose2& motion) {
  const double distance = std::hypot(motion.x, motion.y);
  const double turn = std::abs(motion.yaw);
  const auto variance = [](double a, double b) { return a * a + b * b; };
  const double translation_variance = variance(config_.odometry_translation_per_metre * distance,
                                               config_.odometry_translation_per_rotation * turn);
  const double rotation_variance = variance(config_.odometry_rotation_per_rotation * turn,
                                            config_.odometry_rotation_per_metre * distance);
  const Pose2 moved = pose_ * motion;
  Eigen::Matrix3d by_pose = Eigen::Matrix3d::Identity();
  by_pose(0, 2) = -(moved.y - pose_.y);
  by_pose(1, 2) = moved.x - pose_.x;
  Eigen::Matrix3d pose_covariance =
      by_pose * covariance_.topLeftCorner<3, 3>() * by_pose.transpose();
  pose_covariance.diagonal() +=
      Eigen::Vector3d(translation_variance, translation_variance, rotation_variance);
  // Odometry tells the motion whatever the velocity; should it fail, the velocity starts unknown.
  restart({moved, pose_covariance});
}

void MotionModel::moveByVelocity(double interval) {
  const double turn = velocity_.z() * interval;
  const double heading = pose_.yaw + 0.5 * turn;
  const Eigen::Matrix2d map_from_heading = Eigen::Rotation2Dd(heading).toRotationMatrix();
  const Eigen::Vector2d way = map_from_heading * velocity_.head<2>() * interval;
  const Eigen::Vector2d across(-way.y(), way.x());

  Covariance transition = Covariance::Identity();
  transition.block<2, 1>(0, 2) = across;
  transition.block<2, 2>(0, 3) = map_from_heading * interval;
  transition.block<2, 1>(0, 5) = 0.5 * interval * across;
  transition(2, 5) = interval;

  // An acceleration that is constant between two images and independent of the one before.
  Eigen::Matrix<double, 6, 3> by_acceleration = Eigen::Matrix<double, 6, 3>::Zero();
  by_acceleration.block<2, 2>(0, 0) = 0.5 * interval * interval * map_from_heading;
  by_acceleration(2, 2) = 0.5 * interval * interval;
  by_acceleration.bottomRows<3>() = interval * Eigen::Matrix3d::Identity();
  const Eigen::Vector3d deviations(config_.acceleration_deviation, config_.acceleration_deviation,
                                   config_.angular_acceleration_deviation);

  pose_ = {pose_.x + way.x(), pose_.y + way.y(), normalizeAngle(pose_.yaw + turn)};
  covariance_ = transition * covariance_ * transition.transpose() +
                by_acceleration * deviations.cwiseAbs2().asDiagonal() * by_acceleration.transpose();
}

PoseEstimate MotionModel::estimate() const { return {pose_, covariance_.topLeftCorner<3, 3>()}; }

}  // namespace omnitag
