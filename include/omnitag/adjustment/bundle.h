#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "omnitag/adjustment/calibration_model.h"
#include "omnitag/adjustment/marker_projection.h"
#include "omnitag/adjustment/place_constraint.h"
#include "omnitag/common/pose.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// What is known of a marker's place before any image: the place, and the standard deviations (m
/// and rad) of a MarkerIncrement from there to where it truly hangs. 0: exactly there; infinity:
/// nothing is known along or about that axis.
struct PlacePrior {
  Eigen::Isometry3d map_from_marker = Eigen::Isometry3d::Identity();
  MarkerIncrement deviations = MarkerIncrement::Constant(std::numeric_limits<double>::infinity());

  /// As the marker itself says where it hangs, and how surely.
  static PlacePrior surveyed(const Marker& marker);
  static PlacePrior exact(const Marker& marker);
  /// x, y and the heading exactly, the rest not at all: a marker that says where the map is.
  static PlacePrior gauge(const Marker& marker);

  bool isExact() const { return deviations.isZero(0.0); }
};

/// A recording as one least-squares problem: the camera with its mounting, the robot's poses and
/// the markers, tied together by what was read, by odometry, by what was measured with a tape, and
/// by what is known of each beforehand. Frames and landmarks are named by their indices.
struct Bundle {
  struct Frame {
    /// As tf has the mounting; the camera's parameters change it for all frames alike.
    Eigen::Isometry3d base_from_camera = Eigen::Isometry3d::Identity();
    Pose map_from_base;
    bool is_held = false;
    /// s.
    double stamp = 0.0;
  };
  struct Landmark {
    Marker marker;
    std::optional<PlacePrior> prior;
    /// Whether its size is exactly known, be sizes estimated or not.
    bool knows_size = false;
  };
  struct Observation {
    std::size_t frame = 0;
    std::size_t landmark = 0;
    CornerPixels pixels;
    /// W with W^T W = covariance^-1, in units of BundleConfig::noise: makes residuals independent.
    Eigen::Matrix<double, 8, 8> whitening = Eigen::Matrix<double, 8, 8>::Identity();
  };
  /// The robot's motion by odometry, in base_link of the first frame, and the standard
  /// deviations of its x, y (m) and yaw (rad). z errs as x and y do, roll and pitch as yaw does,
  /// where the robot is free.
  struct Motion {
    std::size_t from = 0;
    std::size_t to = 0;
    Pose from_from_to;
    Eigen::Vector3d deviations;
  };

  std::shared_ptr<const CalibrationModel> model;
  /// As CalibrationModel::parameters().
  Eigen::VectorXd values;
  std::vector<Frame> frames;
  std::vector<Landmark> landmarks;
  std::vector<Observation> observations;
  std::vector<Motion> motions;
  /// Of landmarks, by their indices.
  std::vector<PlaceConstraint> constraints;
};

/// What is estimated, and how far what holds a robot on its floor may be off.
struct BundleConfig {
  /// Indices of the camera's parameters that are estimated; the others keep their values. Their
  /// prior is the model's guess, off by some of the parameters' scales.
  std::vector<Eigen::Index> free;
  bool adjusts_poses = true;
  bool adjusts_markers = true;
  /// Whether the sizes of markers are estimated, too, as far as they are not known.
  bool estimates_sizes = false;
  /// Whether the robot is free; it stands on a floor otherwise, on which its height (m), roll and
  /// pitch (rad each) have these standard deviations.
  bool is_free = false;
  double height_deviation = 0.0;
  double lean_deviation = 0.0;
  /// What the whitened observations have as their standard deviation: pixels along each axis, where
  /// the whitening is the identity. A marker that is off by more than chance (99 of 100) counts
  /// less and less.
  double noise = 0.1;
  int max_iterations = 100;
};

/// Where the state of a bundle has an observation's corners; nothing where it hides one.
std::vector<std::optional<CornerPixels>> predictions(const Bundle& bundle);

/// How far an observation is off.
struct ReadingMisfit {
  /// Pixels, RMS over its corners; infinity where the estimate hides one.
  double pixels = 0.0;
  /// Chi-square with 8 degrees of freedom, if the noise is as the observation says.
  double square = 0.0;
};
std::vector<ReadingMisfit> misfits(const Bundle& bundle, double noise);

}  // namespace omnitag
