#pragma once

#include <Eigen/Core>
#include <optional>

#include "omnitag/camera/shutter.h"
#include "omnitag/common/angle.h"
#include "omnitag/common/pose.h"
#include "omnitag/common/yaml_reader.h"
#include "omnitag/measurement/pose_prior.h"

namespace omnitag {

/// Which of the pose's six numbers are estimated freely.
enum class PoseModel {
  kFloor,  ///< x, y and yaw; the floor and the mounting let z, roll and pitch vary a little
  kFree,   ///< all six: ramps, legs, a hand, a drone
};

/// How a robot stands on a floor.
struct FloorConfig {
  /// rad and m: standard deviations of roll and pitch each, and of the height of base_link. Each
  /// has a part that varies slowly, from the mounting, and one that varies from image to image,
  /// from the floor; both have this deviation.
  double lean_deviation = 0.0087;
  double height_deviation = 0.005;
  /// s: the time in which the slow part may change completely.
  double settling_time = 60.0;
};

/// How the robot moves between two images. All deviations are standard deviations.
struct MotionModelConfig {
  PoseModel pose_model = PoseModel::kFloor;
  FloorConfig floor;
  /// m/s^2 and rad/s^2: without odometry, how much the velocity changes.
  double acceleration_deviation = 1.0;
  double angular_acceleration_deviation = 1.5;
  /// m/s and rad/s: without odometry, the velocity at the start.
  double initial_speed_deviation = 0.5;
  double initial_turn_rate_deviation = 0.5;
  /// With odometry, errors of its motion: rad per rad turned and per metre driven, metres per metre
  /// driven and per rad turned (the square roots of amcl's alpha1 to alpha4).
  double odometry_rotation_per_rotation = 0.1;
  double odometry_rotation_per_metre = 0.05;
  double odometry_translation_per_metre = 0.05;
  double odometry_translation_per_rotation = 0.02;
  /// m and rad: deviations of a pose given without a covariance.
  double initial_position_deviation = 0.1;
  double initial_heading_deviation = radians(5.0);
  /// m: with PoseModel::kFree, deviation of the height of a pose that is given on the floor. Its
  /// roll and pitch have the deviation of the heading.
  double initial_height_deviation = 0.3;
  /// s: how long a pose is carried on with neither markers nor odometry.
  double max_dead_reckoning_time = 1.0;
  /// m and rad: a less certain pose is given up.
  double max_position_deviation = 0.5;
  double max_heading_deviation = radians(20.0);
  /// The same for a pose from outside, until a marker confirms it: a person points at a place to
  /// within half a metre, and the first marker may be some way off. Without odometry, only the time
  /// limit applies.
  double max_initial_time = 10.0;
  double max_initial_position_deviation = 2.0;
  double max_initial_heading_deviation = radians(60.0);

  bool isOnFloor() const { return pose_model == PoseModel::kFloor; }
};

/// Reads the keys of FloorConfig; absent ones keep their defaults. Throws InputError.
FloorConfig readFloorConfig(const YamlReader& reader);

/// Reads the keys above except `pose_model` and `floor`; absent ones keep their defaults.
/// Throws InputError.
MotionModelConfig readMotionModelConfig(const YamlReader& reader);

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
