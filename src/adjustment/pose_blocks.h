#pragma once

#include <array>
#include <cmath>

#include "../common/least_squares.h"

/// A robot's pose as the parameters of an adjustment.
namespace omnitag {

/// A robot's parameters, in two blocks, of which the second is held on a floor: x, y and yaw; z,
/// roll and pitch.
struct PoseBlocks {
  PoseBlock on_floor{};
  std::array<double, 3> off_floor{};

  static PoseBlocks of(const Pose& pose) {
    return {blockOf(pose), {pose.z, pose.roll, pose.pitch}};
  }
  static Pose poseOf(const double* on_floor, const double* off_floor) {
    Pose pose = omnitag::poseOf(on_floor);
    pose.z = off_floor[0];
    pose.roll = off_floor[1];
    pose.pitch = off_floor[2];
    return pose;
  }
  Pose pose() const { return poseOf(on_floor.data(), off_floor.data()); }
};

/// How a pose changes, as PoseVectors, with each parameter of its two blocks.
struct PoseDerivatives {
  Eigen::Matrix<double, 6, 3> by_on_floor;
  Eigen::Matrix<double, 6, 3> by_off_floor;

  explicit PoseDerivatives(const Pose& pose) {
    const Eigen::Vector3d none = Eigen::Vector3d::Zero();
    const double sin_roll = std::sin(pose.roll);
    const double cos_roll = std::cos(pose.roll);
    // The axes about which yaw, roll and pitch turn, in base_link.
    const Eigen::Vector3d yaw_axis(-std::sin(pose.pitch), std::cos(pose.pitch) * sin_roll,
                                   std::cos(pose.pitch) * cos_roll);
    const Eigen::Vector3d roll_axis = Eigen::Vector3d::UnitX();
    const Eigen::Vector3d pitch_axis(0.0, cos_roll, -sin_roll);
    by_on_floor << PoseVector::Unit(0), PoseVector::Unit(1), poseVector(none, yaw_axis);
    by_off_floor << PoseVector::Unit(3), poseVector(none, roll_axis), poseVector(none, pitch_axis);
  }
};

}  // namespace omnitag
