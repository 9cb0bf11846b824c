#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <optional>

#include "omnitag/camera/camera_model.h"
#include "omnitag/common/pose.h"

namespace omnitag {

/// What one image leaves open, as changes: the robot's pose (a PoseVector), and the camera's error.
constexpr int kFrameUnknowns = 12;
using FrameVector = Eigen::Matrix<double, kFrameUnknowns, 1>;
using FrameMatrix = Eigen::Matrix<double, kFrameUnknowns, kFrameUnknowns>;
using FrameJacobian = Eigen::Matrix<double, 2, kFrameUnknowns>;

/// A camera on a robot: from points of the map to pixels, as a function of the robot's pose. Any
/// mounting will do, looking up or down, turned or tilted.
class MountedCamera {
 public:
  MountedCamera(std::shared_ptr<const CameraModel> camera,
                const Eigen::Isometry3d& base_from_camera);

  /// The same camera with an error, which displaces what it sees.
  MountedCamera withError(const CameraError& error) const;

  /// The pixel of a point of the map (metres) and, on request, its derivatives by what is unknown
  /// in a frame (the pose: pixels per metre and per radian; the camera's error: pixels per standard
  /// deviation) and by the point, in pixels per metre along the map's axes. Nothing where the
  /// camera does not see it.
  std::optional<Eigen::Vector2d> pixelFromMap(
      const Eigen::Isometry3d& map_from_base, const Eigen::Vector3d& point,
      FrameJacobian* by_frame = nullptr, Eigen::Matrix<double, 2, 3>* by_point = nullptr) const;

  /// The same; whoever projects many points from one pose makes the isometry once.
  std::optional<Eigen::Vector2d> pixelFromMap(
      const Pose& map_from_base, const Eigen::Vector3d& point, FrameJacobian* by_frame = nullptr,
      Eigen::Matrix<double, 2, 3>* by_point = nullptr) const {
    return pixelFromMap(map_from_base.toIsometry(), point, by_frame, by_point);
  }

  /// The line of sight of a pixel in base_link. Nothing where the pixel shows no world.
  std::optional<Ray> rayInBase(const Eigen::Vector2d& pixel) const;

  /// The same from the model's table, faster.
  std::optional<Ray> tabulatedRayInBase(const Eigen::Vector2d& pixel) const;

  Eigen::Isometry3d mapFromCamera(const Pose& map_from_base) const;

  /// Whether the optical axis points up.
  bool axisUp() const;

  const CameraModel& model() const { return *camera_; }
  const Eigen::Isometry3d& baseFromCamera() const { return base_from_camera_; }

 private:
  /// The pixel as the model has it of one that the camera's error has displaced.
  Eigen::Vector2d withoutError(const Eigen::Vector2d& pixel) const;

  std::shared_ptr<const CameraModel> camera_;
  Eigen::Isometry3d base_from_camera_;
  Eigen::Isometry3d camera_from_base_;
  CameraError error_ = CameraError::Zero();
  bool has_error_ = false;
};

}  // namespace omnitag
