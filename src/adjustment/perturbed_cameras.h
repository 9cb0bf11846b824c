#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <vector>

#include "omnitag/adjustment/calibration_model.h"
#include "omnitag/common/pose.h"

namespace omnitag {

/// How the pixel of a point changes: by the free parameters' offsets in scales (2 x size()), by the
/// robot's pose (a PoseVector), and by the point along the map's axes.
struct PixelDerivatives {
  Eigen::Matrix2Xd by_offsets;
  Eigen::Matrix<double, 2, 6> by_pose;
  Eigen::Matrix<double, 2, 3> by_point;
};

/// A camera and, for its derivatives, those with one parameter a little larger or smaller. All
/// corners of an iteration share them: they are remade only for new values.
class PerturbedCameras {
 public:
  /// `free`: indices of the parameters that vary; the others keep those of `start`. Keeps a
  /// reference to the model.
  PerturbedCameras(const CalibrationModel& model, Eigen::VectorXd start,
                   std::vector<Eigen::Index> free);

  Eigen::Index size() const { return static_cast<Eigen::Index>(free_.size()); }

  /// The values of all parameters where the free ones are `offsets` scales off the start.
  Eigen::VectorXd valuesAt(const Eigen::VectorXd& offsets) const;

  /// Makes what projection needs. False where these offsets make no camera.
  bool moveTo(const double* offsets, bool with_derivatives);

  /// The pixel of a point of the map, for a robot at a pose with a camera that tf has mounted so,
  /// and its derivatives where they are asked for; those by the offsets only after they have been
  /// made. Nothing where the camera does not see the point; one off the image's edge is seen.
  std::optional<Eigen::Vector2d> project(const Eigen::Isometry3d& map_from_base,
                                         const Eigen::Isometry3d& base_from_camera,
                                         const Eigen::Vector3d& point,
                                         PixelDerivatives* derivatives = nullptr) const;

 private:
  /// A camera, none where it is the one in the middle, and what it turns tf's mounting by.
  struct Variant {
    std::shared_ptr<const CameraModel> camera;
    Eigen::Isometry3d mounting_change;

    Eigen::Vector3d inCamera(const Eigen::Isometry3d& base_from_camera,
                             const Eigen::Vector3d& in_base) const;
  };
  struct Pair {
    Variant larger;
    Variant smaller;
  };

  Variant variantAt(const Eigen::VectorXd& values, Eigen::Index changed) const;
  bool makeDerivatives(const Eigen::VectorXd& values);
  Eigen::Matrix2Xd byOffsets(const Eigen::Isometry3d& base_from_camera,
                             const Eigen::Vector3d& in_base,
                             const Eigen::Matrix<double, 2, 3>& by_point_in_camera) const;

  const CalibrationModel& model_;
  Eigen::VectorXd start_;
  std::vector<Eigen::Index> free_;
  Eigen::VectorXd offsets_;
  std::optional<Variant> middle_;
  std::vector<Pair> pairs_;
};

}  // namespace omnitag
