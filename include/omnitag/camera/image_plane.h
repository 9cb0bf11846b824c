#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "omnitag/camera/image_size.h"

namespace omnitag {

/// From the ideal image plane of a radially symmetric camera to the pixels of its sensor:
/// `pixel = affine * distort(ideal) + principal_point`. The ideal plane has its origin on the
/// optical axis, x toward increasing u, y toward increasing v, and no unit; for a pinhole lens it
/// is the plane at distance 1.
///
/// Pixel coordinates are OpenCV's: the centre of the top-left pixel is (0, 0). The distortion is
/// OpenCV's five-parameter model (Brown-Conrady), coefficients (k1, k2, p1, p2, k3).
class ImagePlane {
 public:
  using Distortion = std::array<double, 5>;

  /// `affine`: pixels per unit of the ideal plane, not singular; without skew diag(fx, fy).
  ImagePlane(const Eigen::Matrix2d& affine, const Eigen::Vector2d& principal_point,
             const Distortion& distortion = {});

  /// The plane of a panorama of the whole sphere, whose ideal plane is the azimuthal equidistant
  /// one about the optical axis: points lie as far from its origin as directions lie off the axis
  /// (rad). See EquirectangularCamera.
  static ImagePlane equirectangular(const ImageSize& size);

  /// The plane of images with `factor` times as many pixels along each side.
  ImagePlane scaled(double factor) const;

  /// The pixel of a point of the ideal plane and, on request, its derivative with respect to it.
  Eigen::Vector2d pixelFromIdeal(const Eigen::Vector2d& ideal,
                                 Eigen::Matrix2d* jacobian = nullptr) const;

  /// Inverse of `pixelFromIdeal`; nothing if no point of the ideal plane has this pixel. Where the
  /// distortion folds, several points may have it: see `isInvertibleUpTo`.
  std::optional<Eigen::Vector2d> idealFromPixel(const Eigen::Vector2d& pixel) const;

  /// Whether the distortion keeps its orientation, i.e. can be inverted, up to this radius of the
  /// ideal plane.
  bool isInvertibleUpTo(double radius) const;

  /// Pixels per unit of the ideal plane at its centre, the geometric mean of both axes.
  double scale() const;

  const Eigen::Matrix2d& affine() const { return affine_; }
  const Eigen::Vector2d& principalPoint() const { return principal_point_; }
  const Distortion& distortion() const { return distortion_; }
  bool isDistorted() const { return is_distorted_; }
  bool isEquirectangular() const { return is_equirectangular_; }

 private:
  Eigen::Vector2d distort(const Eigen::Vector2d& ideal, Eigen::Matrix2d* jacobian) const;

  Eigen::Matrix2d affine_;
  Eigen::Matrix2d inverse_affine_;
  Eigen::Vector2d principal_point_;
  Distortion distortion_;
  bool is_distorted_;
  bool is_equirectangular_ = false;
};

}  // namespace omnitag
