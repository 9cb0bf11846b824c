#pragma once

#include "omnitag/common/angle.h"

namespace omnitag {

class YamlReader;

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

}  // namespace omnitag
