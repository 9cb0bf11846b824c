#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "adjustment/bundle.h"
#include "adjustment/camera_template.h"
#include "adjustment/corner_residual.h"
#include "localization/frame_readings.h"
#include "localization/motion_model.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

struct CalibrationConfig {
  /// Names of parameters to keep at the guess.
  std::set<std::string> fixed;
  /// Pixels: corners that are farther off count less and less.
  double robust_width = 0.25;
  /// Whether the markers were read with a camera that may be wrong: then small markers count, too,
  /// and they need not be all around.
  bool is_rough = false;
  /// Pixels: a calibration is refused if its corners are farther off (RMS).
  double max_residual = 1.0;
  /// Whether the camera moves freely, as before a board: then nothing of its mounting is estimated.
  bool is_free = false;
  /// Otherwise, how far the robot may lean and its height may vary.
  FloorConfig floor;
  /// Priors of the places of the map's markers; if empty, the markers' own.
  std::vector<std::optional<PlacePrior>> priors;
  /// Measurements between markers, by their indices in the map.
  std::vector<PlaceConstraint> constraints;
};

/// A parameter of the camera or its mounting, before and after.
struct CalibratedParameter {
  CalibrationParameter guess;
  double value = 0.0;
  /// Standard deviation in the parameter's unit; 0 if it was held.
  double deviation = 0.0;
  /// Why it was held at the guess; empty if it was estimated.
  std::string held;
};

struct CalibrationResult {
  std::vector<CalibratedParameter> parameters;
  /// Values of the camera file, in the order of CameraTemplate::parameters(), and the rim of its
  /// mirror (m).
  Eigen::VectorXd camera_values;
  std::optional<double> rim_radius;
  Eigen::Isometry3d base_from_camera = Eigen::Isometry3d::Identity();

  /// Residuals with the guess (at the best poses that it allows), and with the result.
  ResidualSummary before;
  ResidualSummary after;
  std::vector<CornerResidual> residuals;
  /// The markers in the order of the map, at their estimated places; exactly known ones stay.
  /// With the covariances of their MarkerIncrements within the map, and of the map as a whole:
  /// see BundleInformation.
  std::vector<Marker> markers_found;
  std::vector<MarkerCovariance> marker_covariances;
  Eigen::Matrix<double, 6, 6> placement = Eigen::Matrix<double, 6, 6>::Zero();
  /// The robot's poses in the images that are used, and the images' stamps (s).
  std::vector<Pose> trajectory;
  std::vector<double> stamps;
  /// The remaining uncertainty of the camera and the mounting, for the camera file.
  CameraUncertainty uncertainty;
  /// Pixels, along each axis: the noise of a corner.
  double noise = 0.0;
  std::size_t frames = 0;
  std::size_t markers = 0;
  /// For the user: what was left out, and which parameters trade off against each other.
  std::vector<std::string> remarks;
};

/// Called with the name of a step and how often it has been iterated.
using CalibrationProgress = std::function<void(const std::string& step, int iteration)>;

/// Estimates a camera and its mounting (height, roll and pitch) from markers at known places that
/// were read along a drive.
///
/// On a floor, the initial poses come from bearings, which do not depend on how the optics image
/// elevation; for a free camera, from corners, which takes a guess that is right to a few percent.
/// Then parameters are released in steps: the radial scale; the centre and the lean; the mirror's
/// shape. Corners that are far off count less and less. Finally, parameters that the images do not
/// determine are held at the guess.
///
/// Throws InputError, with what to do, if the recording cannot calibrate the camera: see
/// selectObservations(); too little motion, markers on one side only, a mounting that moves, a
/// model that does not explain the corners.
CalibrationResult calibrateCamera(const CameraTemplate& guess, const MarkerMap& map,
                                  const std::vector<FrameReadings>& frames,
                                  const CalibrationConfig& config,
                                  const CalibrationProgress& progress = {});

}  // namespace omnitag
