#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "adjustment/corner_alignment.h"
#include "adjustment/joint_estimate.h"
#include "camera/mounted_camera.h"
#include "localization/motion_model.h"
#include "omnitag/common/pose.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// The numbers with which a joint estimate of a map begins: the constant part of the robot's
/// height (m), roll and pitch (rad).
constexpr int kStandingNumbers = 3;

/// Their standard deviations, and those of the part that varies from image to image; not zero.
Eigen::Vector3d standingDeviations(const FloorConfig& floor);

/// An image that shows how markers hang relative to each other.
struct KeyFrame {
  struct Sight {
    std::size_t entry = 0;
    /// From where its increment counts.
    Marker prior;
    AlignedCorners corners;
    /// Where its MarkerIncrement begins in the joint estimate; none if it is exactly in its place.
    std::optional<Eigen::Index> increment;
  };

  /// As it took the image, without an error.
  MountedCamera camera;
  /// Of the robot, roughly.
  Pose pose;
  std::vector<Sight> sights;
  /// Of height, roll and pitch from image to image; none if the robot is free.
  std::optional<Eigen::Vector3d> standing_deviations;
  /// Roll and pitch by odometry; all else is 0.
  Pose lean;
  /// Where the camera's modes begin in the joint estimate, in standard deviations.
  Eigen::Index first_mode = 0;
};

/// Updates a joint estimate by what the frame shows: iterated least squares (Gauss-Newton) over the
/// robot's pose and velocities and all numbers that the frame depends on, with the present estimate
/// as the prior. Markers that are off by more than chance count less. False, and no change, if the
/// camera does not see one of the markers or they leave the pose undetermined.
bool learnFrom(const KeyFrame& frame, JointEstimate* joint);

}  // namespace omnitag
