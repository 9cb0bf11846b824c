#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "omnitag/adjustment/camera_template.h"
#include "omnitag/adjustment/leaning_mounting.h"
#include "omnitag/camera/mounted_camera.h"

namespace omnitag {

/// All that the images of a recording have in common: the camera's numbers and then, of its
/// mounting, z (m), roll and pitch (rad).
class CalibrationModel {
 public:
  CalibrationModel(CameraTemplate camera, const LeaningMounting& mounting);

  const std::vector<CalibrationParameter>& parameters() const { return parameters_; }
  /// Of a parameter; nothing where there is none of this name.
  std::optional<Eigen::Index> indexOf(const std::string& name) const;
  /// The values that it was made from.
  Eigen::VectorXd guess() const;

  /// The camera, widened (see CameraTemplate), on its mounting. Throws InputError where these
  /// values make none.
  MountedCamera mounted(const Eigen::VectorXd& values) const;

  const CameraTemplate& camera() const { return camera_; }
  Eigen::VectorXd cameraValues(const Eigen::VectorXd& values) const;
  Eigen::Isometry3d baseFromCamera(const Eigen::VectorXd& values) const;

 private:
  CameraTemplate camera_;
  LeaningMounting mounting_;
  std::vector<CalibrationParameter> parameters_;
};

}  // namespace omnitag
