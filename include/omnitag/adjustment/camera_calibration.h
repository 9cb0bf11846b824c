#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "omnitag/adjustment/bundle.h"
#include "omnitag/adjustment/camera_template.h"
#include "omnitag/adjustment/corner_residual.h"
#include "omnitag/localization/frame_readings.h"
#include "omnitag/localization/motion_model.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

struct CalibrationConfig {
  /// Names of parameters to keep at the guess.
  std::set<std::string> fixed;
  /// Pixels: a corner that is farther off than this counts less and less.
  double robust_width = 0.25;
  /// Whether the markers were read with a camera that may be wrong: then small ones count, too, and
  /// they need not be all around.
  bool is_rough = false;
  /// Pixels: a calibration whose corners are farther off (RMS) is refused.
  double max_residual = 1.0;
  /// How the robot may lean, and how high it may stand.
  FloorConfig floor;
  /// What is known of where each of the map's markers hangs; none: as they say themselves.
  std::vector<std::optional<PlacePrior>> priors;
  /// What was measured between markers, by their indices in the map.
  std::vector<PlaceConstraint> constraints;
};

/// A number of the camera or its mounting, before and after.
struct CalibratedParameter {
  CalibrationParameter guess;
  double value = 0.0;
  /// Standard deviation in the parameter's unit; 0 where it was held.
  double deviation = 0.0;
  /// Why it was held at the guess; empty where it was estimated.
  std::string held;
};

struct CalibrationResult {
  std::vector<CalibratedParameter> parameters;
  /// Of the camera file, in the order of CameraTemplate::parameters(), and its mirror's rim (m).
  Eigen::VectorXd camera_values;
  std::optional<double> rim_radius;
  Eigen::Isometry3d base_from_camera = Eigen::Isometry3d::Identity();

  /// With the guess (the poses being as good as it allows), and with what was estimated.
  ResidualSummary before;
  ResidualSummary after;
  std::vector<CornerResidual> residuals;
  /// Where the markers hang, in the order of the map; those that are exactly known stay. With the
  /// covariances of their MarkerIncrements within the map, and of the map as a whole: see
  /// BundleInformation.
  std::vector<Marker> markers_found;
  std::vector<MarkerCovariance> marker_covariances;
  Eigen::Matrix<double, 6, 6> placement = Eigen::Matrix<double, 6, 6>::Zero();
  /// The robot, in those images that count, and their stamps (s).
  std::vector<Pose> trajectory;
  std::vector<double> stamps;
  /// What is left of the camera's and the mounting's errors, for the camera file.
  CameraUncertainty uncertainty;
  /// Pixels, along each axis: the noise of a corner.
  double noise = 0.0;
  std::size_t frames = 0;
  std::size_t markers = 0;
  /// What a user should know: what was left out, what trades off against what.
  std::vector<std::string> remarks;
};

/// Called with the name of a step and how often it has been iterated.
using CalibrationProgress = std::function<void(const std::string& step, int iteration)>;

/// Estimates a camera and its mounting (height, roll and pitch) from markers of known place that
/// were read along a drive.
///
/// Bearings, which survive whatever the optics do to elevation, give the poses to start from. Then
/// more and more is set free: the radial scale, the centre and the lean, the mirror's shape;
/// corners that are far off count less and less. In the end, what the images do not tell is held at
/// the guess.
///
/// Throws InputError, with what to do, where the recording cannot calibrate the camera: see
/// selectObservations(); too little motion, markers on one side only, a mounting that moves, a
/// model that does not explain the corners.
CalibrationResult calibrateCamera(const CameraTemplate& guess, const MarkerMap& map,
                                  const std::vector<FrameReadings>& frames,
                                  const CalibrationConfig& config,
                                  const CalibrationProgress& progress = {});

}  // namespace omnitag
