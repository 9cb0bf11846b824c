#pragma once

#include <initializer_list>
#include <string>
#include <vector>

#include "adjustment/bundle_adjustment.h"
#include "adjustment/camera_calibration.h"
#include "adjustment/observability.h"

namespace omnitag {

/// What is adjusted in a step of a calibration.
enum class Moving {
  kCamera,          ///< the camera's parameters alone
  kCameraAndPoses,  ///< the poses on an even floor, too
  kAll,             ///< everything not exactly known: also the robot's lean, and the markers
};

/// A recording as a bundle whose camera is estimated step by step.
class CameraFit {
 public:
  using Indices = std::vector<Eigen::Index>;

  /// Takes initial poses from bearings, for a free camera from corners. Keeps references to
  /// `config` and `progress`. Throws InputError as calibrateCamera() does.
  CameraFit(const CameraTemplate& guess, const MarkerMap& map,
            const std::vector<FrameReadings>& frames, const CalibrationConfig& config,
            const CalibrationProgress& progress);

  const CalibrationModel& model() const { return *bundle.model; }
  Eigen::VectorXd guess() const { return model().guess(); }
  const std::string& nameOf(Eigen::Index index) const;
  /// Whether a parameter is not to be estimated.
  bool isFixed(const std::string& name) const;
  /// The parameters with those names that exist and may change.
  Indices indicesOf(std::initializer_list<const char*> names) const;

  /// Minimizes with a robust width that narrows as the residuals do.
  void adjust(const std::string& step, const Indices& free, Moving moving);
  /// Adjusts once more, at the noise that the residuals show.
  void settle(const Indices& free);

  double medianResidual() const;
  double rms() const;
  /// The information of the images about these parameters.
  CameraInformation cameraInformation(const Indices& free) const;
  /// The information about everything, at the noise that the residuals show. Throws InputError if
  /// something is not determined at all.
  BundleInformation information(const Indices& free) const;

  /// Removes outliers. Throws InputError if too little is left.
  void leaveOutOutliers();

  Bundle bundle;
  std::vector<std::string> remarks;
  std::size_t frameCount() const { return bundle.frames.size(); }

 private:
  BundleConfig configOf(const Indices& free, Moving moving) const;
  double leastNoise() const;

  const CalibrationConfig& config_;
  const CalibrationProgress& progress_;
  /// Pixels along each axis, from the residuals; 0 while it is unknown.
  double noise_ = 0.0;
};

}  // namespace omnitag
