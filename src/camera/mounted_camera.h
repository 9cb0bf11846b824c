#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <optional>

#include "camera/shutter.h"
#include "omnitag/camera/camera_model.h"
#include "omnitag/camera/image_blur.h"
#include "omnitag/camera/imaging_error.h"
#include "omnitag/common/pose.h"

namespace omnitag {

/// The unknowns of one image, as changes: the robot's pose (a PoseVector) and the imaging error.
constexpr int kFrameUnknowns = 6 + kImagingUnknowns;
using FrameVector = Eigen::Matrix<double, kFrameUnknowns, 1>;
using FrameMatrix = Eigen::Matrix<double, kFrameUnknowns, kFrameUnknowns>;
using FrameJacobian = Eigen::Matrix<double, 2, kFrameUnknowns>;

/// A camera on a robot while it takes an image: maps points of the map to pixels, as a function
/// of the robot's pose at the image's stamp. Works with any mounting, looking up or down, turned
/// or tilted.
class MountedCamera {
 public:
  MountedCamera(std::shared_ptr<const CameraModel> camera,
                const Eigen::Isometry3d& base_from_camera);

  /// The same camera with an imaging error, which displaces the image.
  MountedCamera withError(const ImagingError& error) const;

  /// The same camera on a base that moves, so that the shutter exposes each row from a
  /// different place.
  MountedCamera withMotion(const ShutterConfig& shutter, const BaseMotion& motion) const;

  /// The same camera with a blur.
  MountedCamera withBlur(const ImageBlur& blur) const;

  /// The pixel of a point of the map (metres) and, on request, its derivatives with respect to a
  /// frame's unknowns (pose: pixels per metre and per radian; imaging error: pixels per standard
  /// deviation) and to the point (pixels per metre along the map's axes). Nothing if the camera
  /// does not see the point.
  std::optional<Eigen::Vector2d> pixelFromMap(
      const Eigen::Isometry3d& map_from_base, const Eigen::Vector3d& point,
      FrameJacobian* by_frame = nullptr, Eigen::Matrix<double, 2, 3>* by_point = nullptr) const;

  /// The same. For many points from one pose, make the isometry once instead.
  std::optional<Eigen::Vector2d> pixelFromMap(
      const Pose& map_from_base, const Eigen::Vector3d& point, FrameJacobian* by_frame = nullptr,
      Eigen::Matrix<double, 2, 3>* by_point = nullptr) const {
    return pixelFromMap(map_from_base.toIsometry(), point, by_frame, by_point);
  }

  /// The line of sight of a pixel, in base_link at the image's stamp. Nothing if the pixel does not
  /// show the world.
  std::optional<Ray> rayInBase(const Eigen::Vector2d& pixel) const;

  /// The same from the model's table, faster.
  std::optional<Ray> tabulatedRayInBase(const Eigen::Vector2d& pixel) const;

  /// Derivative of any quantity that a pixel sees by the imaging error's velocities. `by_base`: its
  /// derivative by a change of the base's pose (a PoseVector along its own axes).
  Eigen::Matrix<double, 2, 3> byVelocities(const Eigen::Vector2d& pixel,
                                           const Eigen::Matrix<double, 2, 6>& by_base) const;

  /// Whether the exposure time is known; the blur's turn is then ignored.
  bool knowsExposure() const { return shutter_.exposure_time > 0.0; }

  /// The motion of the base during an exposure: a PoseVector along its own axes. Its sign has no
  /// meaning.
  PoseVector exposedMotion() const;

  /// Pixels squared, the lens's blur at a pixel.
  double lensVariance(const Eigen::Vector2d& pixel) const;

  Eigen::Isometry3d mapFromCamera(const Pose& map_from_base) const;

  /// Whether the optical axis points up.
  bool axisUp() const;

  const CameraModel& model() const { return *camera_; }
  const Eigen::Isometry3d& baseFromCamera() const { return base_from_camera_; }
  const ImageBlur& blur() const { return blur_; }

 private:
  /// The image of a point given in base_link at the image's stamp, and its derivatives with respect
  /// to the point and to the imaging error's velocities.
  struct Image {
    Eigen::Vector2d pixel;
    Eigen::Matrix<double, 2, 3> by_point = Eigen::Matrix<double, 2, 3>::Zero();
    Eigen::Matrix<double, 2, 3> by_velocities = Eigen::Matrix<double, 2, 3>::Zero();
  };
  std::optional<Image> imageOf(const Eigen::Vector3d& at_stamp, bool wants_derivatives) const;
  /// The pixel of a point given in base_link at the moment when it is seen.
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& in_base,
                                         Eigen::Matrix<double, 2, 3>* by_point) const;
  Ray inBase(const Ray& in_camera, const Eigen::Vector2d& pixel) const;
  /// The pixel without the displacement by the camera's error.
  Eigen::Vector2d withoutError(const Eigen::Vector2d& pixel) const;

  std::shared_ptr<const CameraModel> camera_;
  Eigen::Isometry3d base_from_camera_;
  Eigen::Isometry3d camera_from_base_;
  ImagingError error_ = ImagingError::Zero();
  bool has_camera_error_ = false;
  ShutterConfig shutter_;
  /// With the imaging error's velocities included.
  BaseMotion motion_;
  bool moves_ = false;
  ImageBlur blur_;
};

}  // namespace omnitag
