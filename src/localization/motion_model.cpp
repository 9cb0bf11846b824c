#include "localization/motion_model.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "common/rotation.h"
#include "common/symmetric_matrix.h"
#include "common/yaml_reader.h"

namespace omnitag {
namespace {

/// How an error of the pose propagates when the base then moves: from the PoseVector of errors
/// before to the one after. A rotation error also rotates the motion.
PoseMatrix byPose(const Eigen::Isometry3d& pose, const Eigen::Isometry3d& motion) {
  PoseMatrix transition;
  for (int i = 0; i < 6; ++i) {
    const PoseVector unit = PoseVector::Unit(i);
    const Eigen::Vector3d turn = rotationPart(unit);
    transition.col(i) =
        poseVector(translationPart(unit) + pose.linear() * turn.cross(motion.translation()),
                   motion.linear().transpose() * turn);
  }
  return transition;
}

}  // namespace

void MotionModel::reset(const PoseEstimate& map_from_base, double stamp,
                        const std::optional<Pose>& odom_from_base) {
  restart(map_from_base);
  stamp_ = stamp;
  corrected_stamp_ = stamp;
  known_stamp_ = stamp;
  predicted_stamp_.reset();
  odom_from_base_ = odom_from_base;
  is_given_ = false;
}

void MotionModel::resetToGiven(const PoseEstimate& map_from_base, double stamp,
                               const std::optional<Pose>& odom_from_base) {
  PoseEstimate given = map_from_base;
  if (!isOnFloor()) {
    // A person who points at a place on the floor says neither how high the robot is nor how it
    // leans.
    const Eigen::Vector3d unknown(config_.initial_height_deviation,
                                  config_.initial_heading_deviation,
                                  config_.initial_heading_deviation);
    for (int i = 0; i < 3; ++i) {
      double& variance = given.covariance(3 + i, 3 + i);
      if (variance == 0.0) variance = unknown[i] * unknown[i];
    }
  }
  reset(given, stamp, odom_from_base);
  is_given_ = true;
}

void MotionModel::restart(const PoseEstimate& map_from_base) {
  pose_ = map_from_base.pose;
  velocity_.setZero();
  const double speed = config_.initial_speed_deviation;
  const double turn_rate = config_.initial_turn_rate_deviation;
  // Keep what was learned of the mounting.
  const Eigen::Matrix3d slow = slowCovariance();
  covariance_.setZero();
  covariance_.topLeftCorner<6, 6>() = map_from_base.covariance;
  covariance_.diagonal().segment<3>(6) << speed * speed, speed * speed, turn_rate * turn_rate;
  if (isOnFloor()) {
    covariance_.bottomRightCorner<3, 3>() = slow;
  } else {
    covariance_.diagonal().segment<3>(9) << speed * speed, turn_rate * turn_rate,
        turn_rate * turn_rate;
  }
  shared_ = map_from_base.shared;
}

Eigen::Matrix3d MotionModel::slowCovariance() const {
  const auto known = covariance_.bottomRightCorner<3, 3>();
  if (!isOnFloor() || !known.isZero(0.0)) return known;
  const FloorConfig& floor = config_.floor;
  return Eigen::Vector3d(floor.height_deviation, floor.lean_deviation, floor.lean_deviation)
      .cwiseAbs2()
      .asDiagonal();
}

PoseEstimate MotionModel::predict(double stamp, const std::optional<Pose>& odom_from_base) {
  const double interval = stamp - stamp_;
  // Another camera's image of the same moment shows the robot standing as before.
  const bool is_same = predicted_stamp_ == stamp;
  if (isOnFloor() && !is_same) pose_ = pose_.onFloor();
  if (odom_from_base_ && odom_from_base) {
    moveByOdometry(isOnFloor() ? inverse(odom_from_base_->onFloor()) * odom_from_base->onFloor()
                               : inverse(*odom_from_base_) * *odom_from_base);
    known_stamp_ = stamp;
  } else {
    moveByVelocity(interval);
  }
  if (isOnFloor() && !is_same) standAnew(std::abs(interval), odom_from_base);
  stamp_ = stamp;
  predicted_stamp_ = stamp;
  odom_from_base_ = odom_from_base;
  return estimate();
}

void MotionModel::correct(const PoseEstimate& map_from_base) {
  // The other states learn from the image through their correlation with the pose.
  constexpr int kRest = kSize - 6;
  constexpr double kRounding = 1e-14;
  const PoseMatrix predicted =
      covariance_.topLeftCorner<6, 6>() + kRounding * PoseMatrix::Identity();
  const Eigen::Matrix<double, kRest, 6> gain =
      predicted.ldlt().solve(covariance_.topRightCorner<6, kRest>()).transpose();
  const Eigen::Matrix<double, kRest, 1> correction = gain * difference(map_from_base.pose, pose_);
  velocity_ += correction.head<6>();
  slow_lean_ += correction.tail<3>();
  pose_ = map_from_base.pose;
  const Eigen::Matrix<double, kRest, kRest> rest =
      covariance_.bottomRightCorner<kRest, kRest>() -
      gain * (predicted - map_from_base.covariance) * gain.transpose();
  covariance_.topLeftCorner<6, 6>() = map_from_base.covariance;
  covariance_.bottomLeftCorner<kRest, 6>() = gain * map_from_base.covariance;
  covariance_.topRightCorner<6, kRest>() = covariance_.bottomLeftCorner<kRest, 6>().transpose();
  covariance_.bottomRightCorner<kRest, kRest>() = 0.5 * (rest + rest.transpose());
  shared_ = map_from_base.shared;
  corrected_stamp_ = stamp_;
  known_stamp_ = stamp_;
  is_given_ = false;
}

void MotionModel::configure(const MotionModelConfig& config) {
  const PoseModel model = config_.pose_model;
  config_ = config;
  config_.pose_model = model;
}

PosePrior MotionModel::standing(const std::optional<Pose>& odom_from_base) const {
  if (!isOnFloor()) return {};
  const FloorConfig& floor = config_.floor;
  const Eigen::Matrix3d slow = slowCovariance();
  return PosePrior::standing(
      leanAt(odom_from_base), std::hypot(floor.height_deviation, std::sqrt(slow(0, 0))),
      std::hypot(floor.lean_deviation, std::sqrt(std::max(slow(1, 1), slow(2, 2)))));
}

bool MotionModel::isCertain(double max_position, double max_heading) const {
  const Eigen::Matrix2d position_covariance = covariance_.topLeftCorner<2, 2>();
  const double position = std::sqrt(eigenPairs(position_covariance).values(1));
  const Eigen::Vector3d rest = covariance_.diagonal().segment<3>(3).cwiseSqrt();
  const bool is_lean_certain =
      isOnFloor() || (rest[0] <= max_position && rest.tail<2>().maxCoeff() <= max_heading);
  return position <= max_position && std::sqrt(covariance_(2, 2)) <= max_heading && is_lean_certain;
}

bool MotionModel::isTrustworthy() const {
  const double without_knowledge = stamp_ - known_stamp_;
  if (is_given_ && without_knowledge > 0.0) return without_knowledge <= config_.max_initial_time;
  const double max_position =
      is_given_ ? config_.max_initial_position_deviation : config_.max_position_deviation;
  const double max_heading =
      is_given_ ? config_.max_initial_heading_deviation : config_.max_heading_deviation;
  return isCertain(max_position, max_heading) &&
         without_knowledge <= config_.max_dead_reckoning_time;
}

double MotionModel::translationDeviation(double way, double turn) const {
  return std::hypot(config_.odometry_translation_per_metre * way,
                    config_.odometry_translation_per_rotation * turn);
}

double MotionModel::rotationDeviation(double way, double turn) const {
  return std::hypot(config_.odometry_rotation_per_rotation * turn,
                    config_.odometry_rotation_per_metre * way);
}

BaseMotion MotionModel::motionBy(const PoseVector& odometry) const {
  const double speed = translationPart(odometry).norm();
  const double turn_rate = rotationPart(odometry).norm();
  const double translation = translationDeviation(speed, turn_rate);
  return {odometry, {translation, translation, rotationDeviation(speed, turn_rate)}};
}

BaseMotion MotionModel::motion() const {
  return {velocity_, covariance_.diagonal().segment<3>(6).cwiseSqrt()};
}

BaseMotion MotionModel::unknownMotion() const {
  return {PoseVector::Zero(),
          {config_.initial_speed_deviation, config_.initial_speed_deviation,
           config_.initial_turn_rate_deviation}};
}

void MotionModel::moveByOdometry(const Pose& motion) {
  const Eigen::Isometry3d isometry = motion.toIsometry();
  const double distance = isometry.translation().norm();
  const double turn = std::abs(Eigen::AngleAxisd(isometry.linear()).angle());
  const double translation_variance = std::pow(translationDeviation(distance, turn), 2);
  const double rotation_variance = std::pow(rotationDeviation(distance, turn), 2);
  Covariance noise = Covariance::Zero();
  noise.diagonal().head<3>() << translation_variance, translation_variance, rotation_variance;
  if (!isOnFloor()) {
    noise.diagonal().segment<3>(3) << translation_variance, rotation_variance, rotation_variance;
  }
  move(motion, Covariance::Identity(), noise);
  // With odometry, the velocity does not matter; if odometry fails, the velocity starts unknown.
  const Eigen::Matrix<double, 6, 3> pose_and_slow = covariance_.topRightCorner<6, 3>();
  restart(estimate());
  if (!isOnFloor()) return;
  covariance_.topRightCorner<6, 3>() = pose_and_slow;
  covariance_.bottomLeftCorner<3, 6>() = pose_and_slow.transpose();
}

void MotionModel::moveByVelocity(double interval) {
  const Eigen::Isometry3d motion = this->motion().after(interval);
  const Eigen::Matrix3d halfway = rotationOf(0.5 * interval * rotationPart(velocity_));
  const Eigen::Isometry3d pose = pose_.toIsometry();
  const PoseMatrix map_from_velocity = changeByMotion(pose.linear() * halfway);
  Covariance transition = Covariance::Identity();
  transition.block<6, 6>(0, 6) = interval * map_from_velocity;
  for (int i = 0; i < 6; ++i) {
    // A turn deflects the second half of the motion.
    const Eigen::Vector3d rotation = rotationPart(PoseVector::Unit(i));
    transition.block<6, 1>(0, 6 + i) +=
        poseVector(0.5 * interval * pose.linear() * rotation.cross(motion.translation()),
                   Eigen::Vector3d::Zero());
  }

  // The acceleration is constant between two images and independent of the previous one.
  Eigen::Matrix<double, kSize, 6> by_acceleration = Eigen::Matrix<double, kSize, 6>::Zero();
  by_acceleration.topRows<6>() = 0.5 * interval * interval * map_from_velocity;
  by_acceleration.middleRows<6>(6) = interval * PoseMatrix::Identity();
  PoseVector deviations = PoseVector::Zero();
  deviations.head<3>() << config_.acceleration_deviation, config_.acceleration_deviation,
      config_.angular_acceleration_deviation;
  if (!isOnFloor()) {
    deviations.tail<3>() << config_.acceleration_deviation, config_.angular_acceleration_deviation,
        config_.angular_acceleration_deviation;
  }
  move(Pose::fromIsometry(motion), transition,
       by_acceleration * deviations.cwiseAbs2().asDiagonal() * by_acceleration.transpose());
}

void MotionModel::move(const Pose& motion, const Covariance& transition, const Covariance& noise) {
  const PoseMatrix by_pose = byPose(pose_.toIsometry(), motion.toIsometry());
  Covariance whole = transition;
  whole.topLeftCorner<6, 6>() = by_pose;
  pose_ = pose_ * motion;
  covariance_ = whole * covariance_ * whole.transpose() + noise;
  shared_ = by_pose * shared_ * by_pose.transpose();
}

void MotionModel::standAnew(double interval, const std::optional<Pose>& odom_from_base) {
  pose_ = leaningAs(leanAt(odom_from_base), pose_);
  const Eigen::Vector3d fast(config_.floor.height_deviation, config_.floor.lean_deviation,
                             config_.floor.lean_deviation);
  const Eigen::Vector3d whole = fast.cwiseAbs2();
  auto slow = covariance_.bottomRightCorner<3, 3>();
  slow.diagonal() += whole * (interval / config_.floor.settling_time);
  slow.diagonal() = slow.diagonal().cwiseMin(whole).eval();
  // This image's height, roll and pitch are the slow part plus a new random one.
  Covariance take = Covariance::Identity();
  take.middleRows<3>(3).setZero();
  take.block<3, 3>(3, kSize - 3).setIdentity();
  covariance_ = take * covariance_ * take.transpose();
  covariance_.diagonal().segment<3>(3) += whole;
  shared_.bottomRows<3>().setZero();
  shared_.rightCols<3>().setZero();
}

Pose MotionModel::leanAt(const std::optional<Pose>& odom_from_base) const {
  Pose lean;
  lean.z = slow_lean_.x();
  lean.roll = slow_lean_.y() + (odom_from_base ? odom_from_base->roll : 0.0);
  lean.pitch = slow_lean_.z() + (odom_from_base ? odom_from_base->pitch : 0.0);
  return lean;
}

PoseEstimate MotionModel::estimate() const {
  return {pose_, covariance_.topLeftCorner<6, 6>(), shared_};
}

}  // namespace omnitag
