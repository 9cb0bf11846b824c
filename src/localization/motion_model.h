#pragma once

#include <Eigen/Core>
#include <optional>

#include "camera/shutter.h"
#include "measurement/pose_prior.h"
#include "omnitag/common/pose.h"
#include "omnitag/localization/motion_model_config.h"

namespace omnitag {

/// Carries the robot's pose from image to image, by odometry if both images have it, otherwise at
/// constant velocity. A Kalman filter over the pose, the velocity in base_link and, on a floor, the
/// slow part of height, roll and pitch; each image contributes a finished pose.
///
/// On a floor, the pose is carried on within the plane, and height, roll and pitch are predicted
/// for each image independently: odometry's roll and pitch plus the slow part, with the deviation
/// of the fast part.
class MotionModel {
 public:
  explicit MotionModel(const MotionModelConfig& config) : config_(config) {}

  /// Changes deviations and limits from the next image on; the pose model stays.
  void configure(const MotionModelConfig& config);

  /// Starts from a pose that markers gave at a stamp (s), at unknown velocity.
  void reset(const PoseEstimate& map_from_base, double stamp,
             const std::optional<Pose>& odom_from_base);

  /// The same with a pose from outside, which is a hypothesis until it is corrected.
  void resetToGiven(const PoseEstimate& map_from_base, double stamp,
                    const std::optional<Pose>& odom_from_base);

  /// Carries the pose on to the stamp of the next image, which a slower camera may have taken at
  /// the same time as the last one or a little before.
  PoseEstimate predict(double stamp, const std::optional<Pose>& odom_from_base);

  /// Takes over the pose estimated from the image at the last stamp, which includes the prediction.
  void correct(const PoseEstimate& map_from_base);

  /// s from the last correction or start to the last stamp.
  double uncorrectedTime() const { return stamp_ - corrected_stamp_; }

  /// The base's motion by odometry; and at the last stamp, by the images.
  BaseMotion motionBy(const PoseVector& odometry) const;
  BaseMotion motion() const;
  /// The same if nothing is known about the motion.
  BaseMotion unknownMotion() const;

  /// What is known of an image's pose without a prediction: on a floor, how the robot stands;
  /// otherwise nothing. `odom_from_base`: odometry at the image's stamp.
  PosePrior standing(const std::optional<Pose>& odom_from_base) const;

  /// Whether the pose at the last stamp is still worth having without a marker.
  bool isTrustworthy() const;

 private:
  /// Pose, velocity, and the slow part of (z, roll, pitch).
  static constexpr int kSize = 15;
  using Covariance = Eigen::Matrix<double, kSize, kSize>;

  bool isOnFloor() const { return config_.isOnFloor(); }
  void restart(const PoseEstimate& map_from_base);
  /// Whether the deviations of the pose's estimated components are within these limits (m and rad).
  bool isCertain(double max_position, double max_heading) const;
  /// m and rad: standard deviations of odometry over a distance (m) and a turn (rad).
  double translationDeviation(double way, double turn) const;
  double rotationDeviation(double way, double turn) const;
  void moveByOdometry(const Pose& motion);
  void moveByVelocity(double interval);
  /// Moves the pose by a motion, and propagates the covariance.
  void move(const Pose& motion, const Covariance& transition, const Covariance& noise);
  /// On a floor: predicts height, roll and pitch after an interval (s).
  void standAnew(double interval, const std::optional<Pose>& odom_from_base);
  /// Covariance of the slow part: the configured one until there is an estimate.
  Eigen::Matrix3d slowCovariance() const;
  Pose leanAt(const std::optional<Pose>& odom_from_base) const;
  PoseEstimate estimate() const;

  MotionModelConfig config_;
  Pose pose_;
  /// In base_link, per second; in the order of a PoseVector.
  PoseVector velocity_ = PoseVector::Zero();
  /// m, rad, rad: the slow part of z, roll and pitch.
  Eigen::Vector3d slow_lean_ = Eigen::Vector3d::Zero();
  Covariance covariance_ = Covariance::Zero();
  /// The part of the pose's covariance that the images share.
  PoseMatrix shared_ = PoseMatrix::Zero();
  double stamp_ = 0.0;
  double corrected_stamp_ = 0.0;
  /// Stamp at which a correction, a start or odometry last showed where the robot is.
  double known_stamp_ = 0.0;
  /// Of the last prediction since the start.
  std::optional<double> predicted_stamp_;
  std::optional<Pose> odom_from_base_;
  /// Whether the pose comes from outside and no marker has confirmed it.
  bool is_given_ = false;
};

}  // namespace omnitag
