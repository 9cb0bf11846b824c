#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "adjustment/marker_projection.h"
#include "camera/mounted_camera.h"
#include "omnitag/common/pose.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// A marker as it was read in one image, and the robot's pose then.
struct MarkerSighting {
  /// s.
  double stamp = 0.0;
  /// The camera's mounting, optical frame to robot.
  Eigen::Isometry3d base_from_camera = Eigen::Isometry3d::Identity();
  PoseEstimate map_from_base;
  /// Pixels of the panorama.
  Corners<Eigen::Vector2d> corners;
  /// Index of the camera that saw it.
  std::size_t camera = 0;
};

/// How a marker's place is estimated from its sightings.
struct MarkerEstimateConfig {
  /// Pixels of the panorama, standard deviation of a corner along each axis. Decoded corners of
  /// small and blurred markers are less exact than average.
  double corner_noise = 0.1;
  /// Whether the marker's size is estimated, too; sightings from a single place do not
  /// determine it.
  bool estimates_size = false;
};

/// The estimated place of a marker.
struct MarkerEstimate {
  Marker marker;
  /// Of a MarkerIncrement, in m^2, m rad and rad^2; of the size, in m^2, 0 if it is not estimated.
  MarkerCovariance covariance = MarkerCovariance::Zero();
  double size_variance = 0.0;
  /// For each sighting: RMS over its corners in pixels; infinity if the estimate hides a corner.
  std::vector<double> residuals;
  /// For each sighting: whether it is within its noise and the pose's uncertainty (99 of 100 are).
  std::vector<bool> agrees;
  /// Lead in log-likelihood over the next best place: small markers look almost the same turned to
  /// the left and to the right.
  double lead = 0.0;

  /// Whether the lead is large enough for the place to be accepted.
  bool isUnambiguous() const;
  /// The share of the sightings that agree.
  double agreement() const;
  /// Standard deviations in the worst direction, in m and rad.
  double positionDeviation() const;
  double orientationDeviation() const;
};

/// The largest angle between the directions from which a marker at `center` was seen, in rad.
double parallax(const Eigen::Vector3d& center, const std::vector<MarkerSighting>& sightings);

/// The places where a marker of known size would image as in one sighting, judged by its corners
/// alone (Levenberg-Marquardt from starts all around): every local optimum with a residual of at
/// most `max_residual` pixels (RMS), best first. There are mostly two, mirror images of each other.
/// `marker` gives the family, the id and the size.
std::vector<Marker> markersFromSighting(const Marker& marker, const CameraModels& cameras,
                                        const MarkerSighting& sighting, double max_residual);

/// Estimates a marker's place from sightings at known poses: least squares over all corners in the
/// panorama. Each sighting is weighted by the noise of its corners and the covariance of its pose
/// together, and less if it is far off. Errors of poses are assumed independent. `marker` gives the
/// family, the id and the size or a first guess of it; `start`, an earlier estimate, is tried
/// besides starts from single sightings. Nothing if the sightings leave the place undetermined.
std::optional<MarkerEstimate> estimateMarker(const Marker& marker, const CameraModels& cameras,
                                             const std::vector<MarkerSighting>& sightings,
                                             const std::optional<Marker>& start,
                                             const MarkerEstimateConfig& config);

}  // namespace omnitag
