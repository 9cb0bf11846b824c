#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "omnitag/common/pose.h"

namespace omnitag {

/// A landmark at a known place and the line of sight on which the robot sees it, both seen
/// from above.
struct LandmarkBearing {
  /// m, in the map.
  Eigen::Vector2d landmark;
  /// m, standard deviation of its place along either axis.
  double landmark_deviation = 0.0;
  /// m, in base_link: a point of the line of sight, where the camera is.
  Eigen::Vector2d viewpoint;
  /// rad, direction of the line of sight in base_link (the paper's theta_l).
  double bearing = 0.0;
  /// rad, standard deviation of the bearing.
  double bearing_deviation = 0.0;
  /// How much the sight counts; the paper's equal confidence is 1 for all.
  double weight = 1.0;
};

/// The paper's triangulation (Section 4): the pose whose lines of sight pass nearest to their
/// landmarks, by the weighted sum of squared perpendicular distances (Eqn 2). For a given heading
/// the position follows in closed form (Eqn 1); the heading is found by Newton's iteration. The
/// paper's line has a = sin phi, b = -cos phi and c = -(a X + b Y), phi being the direction of
/// sight in the map and (X, Y) the landmark, moved back by the viewpoint's place on the robot.
///
/// Starts from `initial_yaw`, which must be within about 45 degrees. Nothing with fewer than three
/// sights, if they leave the pose undetermined, or if a solution has landmarks behind the robot,
/// which a line cannot distinguish from landmarks ahead.
///
/// The covariance assumes independent errors of the bearings and the landmarks, and is scaled up if
/// the sights miss their landmarks by more than these explain.
std::optional<PoseEstimate> triangulate(const std::vector<LandmarkBearing>& sights,
                                        double initial_yaw);

}  // namespace omnitag
