#include "adjustment/calibration_model.h"

#include <algorithm>
#include <utility>

#include "omnitag/common/angle.h"

namespace omnitag {
namespace {

constexpr Eigen::Index kMountingSize = 3;

}  // namespace

CalibrationModel::CalibrationModel(CameraTemplate camera, const LeaningMounting& mounting)
    : camera_(std::move(camera)), mounting_(mounting), parameters_(camera_->parameters()) {
  const LeaningMounting::Values& values = mounting_->values();
  parameters_.push_back({"z", "m", values.x(), 0.05, 0.05});
  parameters_.push_back({"roll", "rad", values.y(), 0.1, radians(1.0)});
  parameters_.push_back({"pitch", "rad", values.z(), 0.1, radians(1.0)});
}

CalibrationModel::CalibrationModel(std::shared_ptr<const CameraModel> camera)
    : fixed_(std::move(camera)) {}

std::optional<Eigen::Index> CalibrationModel::indexOf(const std::string& name) const {
  const auto found =
      std::find_if(parameters_.begin(), parameters_.end(),
                   [&name](const auto& parameter) { return parameter.name == name; });
  if (found == parameters_.end()) return std::nullopt;
  return found - parameters_.begin();
}

Eigen::VectorXd CalibrationModel::guess() const { return valuesOf(parameters_); }

std::shared_ptr<const CameraModel> CalibrationModel::cameraAt(const Eigen::VectorXd& values) const {
  return fixed_ ? fixed_ : camera_->widened(cameraValues(values));
}

Eigen::Isometry3d CalibrationModel::mountingChange(const Eigen::VectorXd& values) const {
  if (!mounting_) return Eigen::Isometry3d::Identity();
  return baseFromCamera(values) * mounting_->at(mounting_->values()).inverse();
}

bool CalibrationModel::isOfMounting(Eigen::Index index) const {
  return index >= static_cast<Eigen::Index>(camera_->parameters().size());
}

MountedCamera CalibrationModel::mounted(const Eigen::VectorXd& values) const {
  return {cameraAt(values), baseFromCamera(values)};
}

Eigen::VectorXd CalibrationModel::cameraValues(const Eigen::VectorXd& values) const {
  return values.head(static_cast<Eigen::Index>(camera_->parameters().size()));
}

Eigen::Isometry3d CalibrationModel::baseFromCamera(const Eigen::VectorXd& values) const {
  return mounting_->at(values.tail<kMountingSize>());
}

}  // namespace omnitag
