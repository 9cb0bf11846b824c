#pragma once

#include "camera/mounted_camera.h"
#include "measurement/pose_prior.h"
#include "omnitag/common/pose.h"
#include "omnitag/localization/localizer_config.h"
#include "planning/occupancy_grid.h"

namespace omnitag {

/// What a prediction assumes.
struct PlanningConfig {
  /// The localizer's settings: which markers are worth looking for, how the robot stands.
  LocalizerConfig localizer;
  /// m, depth before a marker's plane in which the grid does not hide it: a marker hangs on a wall,
  /// whose cells are thicker and less exact than the wall. At least two cells.
  double wall_depth = 0.10;
  /// Pixels: standard deviation by which an edge of a pattern is displaced at random from pixel to
  /// pixel along it, by the image's noise and the sensor. Set by planning_study: what the
  /// photometric estimator states in rendered worlds.
  double edge_noise = 0.045;
  /// m and rad: what is known of the pose without markers, so that the information is finite.
  double place_deviation = 10.0;
  double heading_deviation = 3.0;
};

/// A camera on a robot in a building. Refers to the grid and the camera, which must outlive it.
struct PlanningScene {
  const OccupancyGrid& grid;
  const MountedCamera& camera;
  PlanningConfig config;

  /// How the robot stands, and that it is somewhere near a pose.
  PosePrior priorAt(const Pose& map_from_base) const;
};

}  // namespace omnitag
