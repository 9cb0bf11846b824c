#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "adjustment/calibration_model.h"
#include "adjustment/marker_projection.h"
#include "adjustment/place_constraint.h"
#include "omnitag/common/pose.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// Prior of a marker's place: the place, and the standard deviations (m and rad) of the
/// MarkerIncrement from it to the true place. 0: exact; infinity: unknown along or about that axis.
struct PlacePrior {
  Eigen::Isometry3d map_from_marker = Eigen::Isometry3d::Identity();
  MarkerIncrement deviations = MarkerIncrement::Constant(std::numeric_limits<double>::infinity());

  /// The marker's own place and deviations.
  static PlacePrior surveyed(const Marker& marker);
  static PlacePrior exact(const Marker& marker);
  /// x, y and the heading exactly known, the rest unknown: defines where the map is.
  static PlacePrior gauge(const Marker& marker);

  bool isExact() const { return deviations.isZero(0.0); }
};

/// A recording as one least-squares problem: the camera with its mounting, the robot's poses and
/// the landmarks, tied together by observations, odometry, measurements with a tape, and priors.
/// Frames and landmarks are referred to by index.
struct Bundle {
  struct Frame {
    /// The mounting from tf; the camera's parameters change it by the same amount in all frames.
    Eigen::Isometry3d base_from_camera = Eigen::Isometry3d::Identity();
    Pose map_from_base;
    bool is_held = false;
    /// s.
    double stamp = 0.0;
  };
  struct Landmark {
    Marker marker;
    std::optional<PlacePrior> prior;
    /// Whether its size is exactly known, even if sizes are estimated.
    bool knows_size = false;
  };
  struct Observation {
    std::size_t frame = 0;
    std::size_t landmark = 0;
    CornerPixels pixels;
    /// W with W^T W = covariance^-1, in units of BundleConfig::noise: makes residuals independent.
    Eigen::Matrix<double, 8, 8> whitening = Eigen::Matrix<double, 8, 8>::Identity();
  };
  /// The robot's motion by odometry, in base_link of the first frame, and the standard deviations
  /// of its x, y (m) and yaw (rad). If the robot is free, z has the deviation of x and y, and roll
  /// and pitch that of yaw.
  struct Motion {
    std::size_t from = 0;
    std::size_t to = 0;
    Pose from_from_to;
    Eigen::Vector3d deviations;
  };

  std::shared_ptr<const CalibrationModel> model;
  /// In the order of CalibrationModel::parameters().
  Eigen::VectorXd values;
  std::vector<Frame> frames;
  std::vector<Landmark> landmarks;
  std::vector<Observation> observations;
  std::vector<Motion> motions;
  /// Between landmarks, by index.
  std::vector<PlaceConstraint> constraints;
};

/// What is estimated, and how far the robot may deviate from standing on its floor.
struct BundleConfig {
  /// Indices of the camera's parameters that are estimated; the others keep their values. The prior
  /// of each is the model's guess, with a standard deviation of several scales.
  std::vector<Eigen::Index> free;
  bool adjusts_poses = true;
  bool adjusts_markers = true;
  /// Whether unknown sizes of markers are estimated, too.
  bool estimates_sizes = false;
  /// Whether the robot is free; otherwise it stands on a floor, with these standard deviations of
  /// its height (m) and of its roll and pitch (rad each).
  bool is_free = false;
  double height_deviation = 0.0;
  double lean_deviation = 0.0;
  /// Standard deviation of the whitened observations: pixels along each axis if the whitening is
  /// the identity. A marker that is off by more than chance (99 of 100) counts less and less.
  double noise = 0.1;
  int max_iterations = 100;
};

/// The pixels of each observation's corners as the bundle's state predicts them; nothing if a
/// corner is hidden.
std::vector<std::optional<CornerPixels>> predictions(const Bundle& bundle);

/// How far an observation is from its prediction.
struct ReadingResidual {
  /// Pixels, RMS over its corners; infinity if the estimate hides a corner.
  double pixels = 0.0;
  /// Distributed as chi-square with 8 degrees of freedom if the observation's noise is right.
  double square = 0.0;
};
std::vector<ReadingResidual> misfits(const Bundle& bundle, double noise);

}  // namespace omnitag
