#pragma once

#include <Eigen/Core>
#include <vector>

#include "omnitag/adjustment/calibration_model.h"
#include "omnitag/common/pose.h"

namespace omnitag {

/// A camera and, for its derivatives, those with one parameter a little larger or smaller. All
/// corners of an iteration share them: they are made anew only for new values.
class PerturbedCameras {
 public:
  /// `free`: indices of the parameters that vary; the others keep those of `start`. Keeps a
  /// reference to the model.
  PerturbedCameras(const CalibrationModel& model, Eigen::VectorXd start,
                   std::vector<Eigen::Index> free);

  Eigen::Index size() const { return static_cast<Eigen::Index>(free_.size()); }

  /// The values of all parameters where the free ones are `offsets` scales off the start.
  Eigen::VectorXd valuesAt(const double* offsets) const;

  /// Makes what projection needs. False where these offsets make no camera.
  bool moveTo(const double* offsets, bool with_derivatives);

  /// The pixel of a point of the map and, where they are asked for, its derivatives by the offsets
  /// (2 x size()) and by the pose (2 x 3). Nothing where the camera does not see the point.
  std::optional<Eigen::Vector2d> project(const Pose& map_from_base, const Eigen::Vector3d& point,
                                         Eigen::Matrix2Xd* by_offsets,
                                         Eigen::Matrix<double, 2, 3>* by_pose) const;

 private:
  struct Pair {
    MountedCamera larger;
    MountedCamera smaller;
  };

  bool makeDerivatives(const Eigen::VectorXd& values);

  const CalibrationModel& model_;
  Eigen::VectorXd start_;
  std::vector<Eigen::Index> free_;
  Eigen::VectorXd offsets_;
  std::optional<MountedCamera> camera_;
  std::vector<Pair> pairs_;
};

}  // namespace omnitag
