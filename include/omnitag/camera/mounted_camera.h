#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <optional>

#include "omnitag/camera/camera_model.h"
#include "omnitag/common/pose2.h"

namespace omnitag {

/// A camera on a robot that moves on the floor: from points of the map to pixels, as a function of
/// the robot's pose. Any mounting will do, looking up or down, turned or tilted.
class MountedCamera {
 public:
  MountedCamera(std::shared_ptr<const CameraModel> camera,
                const Eigen::Isometry3d& base_from_camera);

  /// The pixel of a point of the map (metres) and, on request, its derivatives with respect to the
  /// pose (x, y, yaw), in pixels per metre and per radian, and to the point, in pixels per metre
  /// along the map's axes. Nothing where the camera does not see it.
  std::optional<Eigen::Vector2d> pixelFromMap(
      const Pose2& map_from_base, const Eigen::Vector3d& point,
      Eigen::Matrix<double, 2, 3>* by_pose = nullptr,
      Eigen::Matrix<double, 2, 3>* by_point = nullptr) const;

  /// The line of sight of a pixel in base_link. Nothing where the pixel shows no world.
  std::optional<Ray> rayInBase(const Eigen::Vector2d& pixel) const;

  /// The same from the model's table, faster.
  std::optional<Ray> tabulatedRayInBase(const Eigen::Vector2d& pixel) const;

  Eigen::Isometry3d mapFromCamera(const Pose2& map_from_base) const;

  /// Whether the optical axis points up.
  bool axisUp() const;

  const CameraModel& model() const { return *camera_; }
  const Eigen::Isometry3d& baseFromCamera() const { return base_from_camera_; }

 private:
  std::shared_ptr<const CameraModel> camera_;
  Eigen::Isometry3d base_from_camera_;
  Eigen::Isometry3d camera_from_base_;
};

}  // namespace omnitag
