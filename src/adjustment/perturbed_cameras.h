#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <vector>

#include "adjustment/calibration_model.h"
#include "omnitag/common/pose.h"

namespace omnitag {

/// Derivatives of a point's pixel by the free parameters' offsets in scales (2 x size()), by the
/// robot's pose (a PoseVector), and by the point along the map's axes.
struct PixelDerivatives {
  Eigen::Matrix2Xd by_offsets;
  Eigen::Matrix<double, 2, 6> by_pose;
  Eigen::Matrix<double, 2, 3> by_point;
};

/// A camera and, for numeric derivatives, copies with one parameter slightly larger or smaller. All
/// corners of an iteration share them; only new values make new ones.
class PerturbedCameras {
 public:
  /// `free`: indices of the parameters that vary; the others keep those of `start`. Keeps a
  /// reference to the model.
  PerturbedCameras(const CalibrationModel& model, Eigen::VectorXd start,
                   std::vector<Eigen::Index> free);

  Eigen::Index size() const { return static_cast<Eigen::Index>(free_.size()); }

  /// The values of all parameters, the free ones `offsets` scales away from the start.
  Eigen::VectorXd valuesAt(const Eigen::VectorXd& offsets) const;

  /// Makes what projection needs. False if these offsets are not valid for the camera.
  bool moveTo(const double* offsets, bool with_derivatives);

  /// The pixel of a point of the map, for a robot's pose and a mounting given by tf, and, if
  /// requested, its derivatives; those by the offsets only if moveTo() has made them. Nothing if
  /// the camera does not see the point; points off the image's edge count as seen.
  std::optional<Eigen::Vector2d> project(const Eigen::Isometry3d& map_from_base,
                                         const Eigen::Isometry3d& base_from_camera,
                                         const Eigen::Vector3d& point,
                                         PixelDerivatives* derivatives = nullptr) const;

 private:
  /// A camera, null if it is the unperturbed one, and how it changes tf's mounting.
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
