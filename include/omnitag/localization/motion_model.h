#pragma once

#include <Eigen/Core>
#include <optional>

#include "omnitag/common/angle.h"
#include "omnitag/common/pose2.h"
#include "omnitag/common/yaml_reader.h"

namespace omnitag {

/// How the robot moves between two images. All deviations are standard deviations.
struct MotionModelConfig {
  /// m/s^2 and rad/s^2: without odometry, how much the velocity changes.
  double acceleration_deviation = 1.0;
  double angular_acceleration_deviation = 1.5;
  /// m/s and rad/s: without odometry, what the velocity may be at the start.
  double initial_speed_deviation = 0.5;
  double initial_turn_rate_deviation = 0.5;
  /// With odometry, errors of its motion: rad per rad turned and per metre driven, metres per metre
  /// driven and per rad turned (the square roots of amcl's alpha1 to alpha4).
  double odometry_rotation_per_rotation = 0.1;
  double odometry_rotation_per_metre = 0.05;
  double odometry_translation_per_metre = 0.05;
  double odometry_translation_per_rotation = 0.02;
  /// m and rad: of a pose that is given without a covariance.
  double initial_position_deviation = 0.1;
  double initial_heading_deviation = radians(5.0);
  /// s, how long a pose is carried on with neither a marker nor odometry.
  double max_dead_reckoning_time = 1.0;
  /// m and rad: a pose that is less certain than this is given up.
  double max_position_deviation = 0.5;
  double max_heading_deviation = radians(20.0);
  /// The same for a pose from outside, until a marker confirms it: a person points at a place to
  /// half a metre, and the first marker may be some way off. Without odometry the time alone
  /// counts.
  double max_initial_time = 10.0;
  double max_initial_position_deviation = 2.0;
  double max_initial_heading_deviation = radians(60.0);
};

/// Reads the keys above; absent ones keep their defaults. Throws InputError.
MotionModelConfig readMotionModelConfig(const YamlReader& reader);

/// Carries the robot's pose from image to image, by odometry where both images have it, otherwise
/// at constant velocity. A Kalman filter over (x, y, yaw, vx, vy, yaw rate), the velocity in
/// base_link; the images' share comes as a finished pose.
class MotionModel {
 public:
  explicit MotionModel(const MotionModelConfig& config) : config_(config) {}

  /// Starts from a pose that markers told at a stamp (s), at unknown velocity.
  void reset(const PoseEstimate& map_from_base, double stamp,
             const std::optional<Pose2>& odom_from_base);

  /// The same from a pose that comes from outside: a hypothesis until it is corrected.
  void resetToGiven(const PoseEstimate& map_from_base, double stamp,
                    const std::optional<Pose2>& odom_from_base);

  /// Carries the pose on to a later stamp and returns it.
  PoseEstimate predict(double stamp, const std::optional<Pose2>& odom_from_base);

  /// Takes the pose that the image at the last stamp led to, the prediction included in it.
  void correct(const PoseEstimate& map_from_base);

  /// s from the last correction or start to the last stamp.
  double uncorrectedTime() const { return stamp_ - corrected_stamp_; }

  /// Whether the pose at the last stamp is still worth having without a marker.
  bool isTrustworthy() const;

 private:
  using State = Eigen::Matrix<double, 6, 1>;
  using Covariance = Eigen::Matrix<double, 6, 6>;

  void restart(const PoseEstimate& map_from_base);
  void moveByOdometry(const Pose2& motion);
  void moveByVelocity(double interval);
  PoseEstimate estimate() const;

  MotionModelConfig config_;
  Pose2 pose_;
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();
  Covariance covariance_ = Covariance::Zero();
  double stamp_ = 0.0;
  double corrected_stamp_ = 0.0;
  /// When a correction, a start or odometry last told where the robot is.
  double known_stamp_ = 0.0;
  std::optional<Pose2> odom_from_base_;
  /// Whether the pose comes from outside and no marker has confirmed it.
  bool is_given_ = false;
};

}  // namespace omnitag
