#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "omnitag/adjustment/marker_projection.h"
#include "omnitag/camera/mounted_camera.h"
#include "omnitag/common/pose.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// A marker as it was read in one image, and where the robot was then.
struct MarkerSighting {
  /// s.
  double stamp = 0.0;
  /// The camera's mounting, optical frame to robot.
  Eigen::Isometry3d base_from_camera = Eigen::Isometry3d::Identity();
  PoseEstimate map_from_base;
  /// Pixels of the panorama.
  Corners<Eigen::Vector2d> corners;
};

/// How a marker is estimated from its sightings.
struct MarkerEstimateConfig {
  /// Pixels of the panorama, standard deviation of a corner along each axis: decoded corners of
  /// small and blurred markers are less exact than the average.
  double corner_noise = 0.1;
  /// Whether the marker's size is estimated, too; a single place cannot tell it.
  bool estimates_size = false;
};

/// Where a marker hangs, as its sightings tell.
struct MarkerEstimate {
  Marker marker;
  /// Of a MarkerIncrement, in m^2, m rad and rad^2; of the size (m^2), 0 where it is not estimated.
  MarkerCovariance covariance = MarkerCovariance::Zero();
  double size_variance = 0.0;
  /// For each sighting, pixels: RMS over its corners; infinity where the estimate hides one.
  std::vector<double> residuals;
  /// For each sighting whether it is as near as its noise and the pose's uncertainty let expect (99
  /// of 100 are).
  std::vector<bool> agrees;
  /// Log-likelihood by which it leads the next best place: small markers look almost the same from
  /// the left and turned to the right.
  double lead = 0.0;

  /// m and rad: standard deviations in the direction in which they are largest.
  double positionDeviation() const;
  double orientationDeviation() const;
};

/// rad: the largest angle between the directions from which a marker at `center` was seen.
double parallax(const Eigen::Vector3d& center, const std::vector<MarkerSighting>& sightings);

/// The places of a marker of known size from which it images as one sighting says, judged by its
/// corners alone (Levenberg-Marquardt from starts all around): every local optimum that is at most
/// `max_residual` pixels (RMS) off, best first. Mostly two, which mirror each other. `marker` gives
/// the family, the id and the size.
std::vector<Marker> markersFromSighting(const Marker& marker,
                                        const std::shared_ptr<const CameraModel>& camera,
                                        const MarkerSighting& sighting, double max_residual);

/// Estimates a marker from sightings at known poses: least squares over all corners in the
/// panorama, in which each sighting counts by the noise of its corners and the covariance of its
/// pose together, and less where it is far off. Poses err independently of each
/// other here. `marker` gives the family, the id and the size, or a first guess of that; `start`, a
/// former estimate, is tried besides what single sightings tell. Nothing where the sightings leave
/// the place undetermined.
std::optional<MarkerEstimate> estimateMarker(const Marker& marker,
                                             const std::shared_ptr<const CameraModel>& camera,
                                             const std::vector<MarkerSighting>& sightings,
                                             const std::optional<Marker>& start,
                                             const MarkerEstimateConfig& config);

}  // namespace omnitag
