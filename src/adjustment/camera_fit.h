#pragma once

#include <initializer_list>
#include <string>
#include <vector>

#include "omnitag/adjustment/bundle_adjustment.h"
#include "omnitag/adjustment/camera_calibration.h"
#include "omnitag/adjustment/observability.h"

namespace omnitag {

/// What moves in a step of a calibration.
enum class Moving {
  kCamera,          ///< the camera's parameters alone
  kCameraAndPoses,  ///< the poses on an even floor, too
  kAll,             ///< all that is not exactly known: also how the robot leans, and the markers
};

/// A recording as a bundle whose camera is looked for, step by step.
class CameraFit {
 public:
  using Indices = std::vector<Eigen::Index>;

  /// The poses as bearings tell them. Keeps references to `config` and `progress`. Throws
  /// InputError as calibrateCamera() does.
  CameraFit(const CameraTemplate& guess, const MarkerMap& map,
            const std::vector<FrameReadings>& frames, const CalibrationConfig& config,
            const CalibrationProgress& progress);

  const CalibrationModel& model() const { return *bundle.model; }
  Eigen::VectorXd guess() const { return model().guess(); }
  const std::string& nameOf(Eigen::Index index) const;
  bool isFixed(const std::string& name) const { return config_.fixed.count(name) > 0; }
  /// Of those names, the parameters that there are and that may change.
  Indices indicesOf(std::initializer_list<const char*> names) const;

  /// Minimizes with a robust width that narrows as the residuals do.
  void adjust(const std::string& step, const Indices& free, Moving moving);
  /// Once more, with the noise that the residuals show.
  void settle(const Indices& free);

  double medianResidual() const;
  double rms() const;
  /// What the images tell of these parameters.
  CameraInformation cameraInformation(const Indices& free) const;
  /// Of everything, at the noise that the residuals show. Throws InputError where something is not
  /// told at all.
  BundleInformation information(const Indices& free) const;

  /// Takes out what says nothing about the camera. Throws InputError where too little is left.
  void leaveOutOutliers();

  Bundle bundle;
  std::vector<std::string> remarks;
  /// Of the bundle's frames, s.
  std::size_t frameCount() const { return bundle.frames.size(); }

 private:
  BundleConfig configOf(const Indices& free, Moving moving) const;
  double leastNoise() const;

  const CalibrationConfig& config_;
  const CalibrationProgress& progress_;
  /// Pixels along each axis, as the residuals show it; 0 as long as that is not known.
  double noise_ = 0.0;
};

}  // namespace omnitag
