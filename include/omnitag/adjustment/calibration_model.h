#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
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
  /// A camera that stays as it is, on whatever mounting: there are no parameters.
  explicit CalibrationModel(std::shared_ptr<const CameraModel> camera);

  const std::vector<CalibrationParameter>& parameters() const { return parameters_; }
  /// Of a parameter; nothing where there is none of this name.
  std::optional<Eigen::Index> indexOf(const std::string& name) const;
  /// The values that it was made from.
  Eigen::VectorXd guess() const;

  /// The camera, widened (see CameraTemplate), on its mounting. Throws InputError where these
  /// values make none.
  MountedCamera mounted(const Eigen::VectorXd& values) const;

  /// What mounted() mounts, and by how much it is mounted otherwise than the guess: in base_link,
  /// from the one to the other. Throws as mounted() does.
  std::shared_ptr<const CameraModel> cameraAt(const Eigen::VectorXd& values) const;
  Eigen::Isometry3d mountingChange(const Eigen::VectorXd& values) const;
  /// Whether a parameter is the mounting's.
  bool isOfMounting(Eigen::Index index) const;

  /// Not of a camera that stays as it is; neither are the two below.
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
