#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "adjustment/camera_template.h"
#include "adjustment/leaning_mounting.h"
#include "camera/mounted_camera.h"

namespace omnitag {

/// What all images of a recording have in common: the camera's parameters, followed by z (m), roll
/// and pitch (rad) of its mounting.
class CalibrationModel {
 public:
  CalibrationModel(CameraTemplate camera, const LeaningMounting& mounting);
  /// A fixed camera on any mounting: there are no parameters.
  explicit CalibrationModel(std::shared_ptr<const CameraModel> camera);

  const std::vector<CalibrationParameter>& parameters() const { return parameters_; }
  /// The index of a parameter; nothing if none has this name.
  std::optional<Eigen::Index> indexOf(const std::string& name) const;
  /// The initial values.
  Eigen::VectorXd guess() const;

  /// The camera, widened (see CameraTemplate), on its mounting. Throws InputError if these values
  /// are not valid.
  MountedCamera mounted(const Eigen::VectorXd& values) const;

  /// The camera of mounted(), and the change of its mounting: the motion in base_link from the
  /// guessed mounting to it. Throws as mounted() does.
  std::shared_ptr<const CameraModel> cameraAt(const Eigen::VectorXd& values) const;
  Eigen::Isometry3d mountingChange(const Eigen::VectorXd& values) const;
  /// Whether a parameter belongs to the mounting.
  bool isOfMounting(Eigen::Index index) const;

  /// Invalid for a fixed camera, as are the two below.
  const CameraTemplate& camera() const { return *camera_; }
  Eigen::VectorXd cameraValues(const Eigen::VectorXd& values) const;
  Eigen::Isometry3d baseFromCamera(const Eigen::VectorXd& values) const;

 private:
  std::optional<CameraTemplate> camera_;
  std::optional<LeaningMounting> mounting_;
  std::shared_ptr<const CameraModel> fixed_;
  std::vector<CalibrationParameter> parameters_;
};

}  // namespace omnitag
