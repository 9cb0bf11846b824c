#include "omnitag/camera/image_plane.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "camera/plate_carree.h"
#include "omnitag/common/angle.h"

namespace omnitag {

ImagePlane::ImagePlane(const Eigen::Matrix2d& affine, const Eigen::Vector2d& principal_point,
                       const Distortion& distortion)
    : affine_(affine),
      inverse_affine_(affine.inverse()),
      principal_point_(principal_point),
      distortion_(distortion),
      is_distorted_(std::any_of(distortion.begin(), distortion.end(),
                                [](double coefficient) { return coefficient != 0.0; })) {}

ImagePlane ImagePlane::equirectangular(const ImageSize& size) {
  // Pixels per radian, and the middle of the image.
  ImagePlane plane(Eigen::Vector2d(0.5 * size.width / kPi, size.height / kPi).asDiagonal(),
                   {0.5 * (size.width - 1), 0.5 * (size.height - 1)});
  plane.is_distorted_ = true;
  plane.is_equirectangular_ = true;
  return plane;
}

ImagePlane ImagePlane::scaled(double factor) const {
  ImagePlane plane = *this;
  plane.affine_ *= factor;
  plane.inverse_affine_ /= factor;
  // The image begins half a pixel before the centre of its first pixel.
  const Eigen::Vector2d half(0.5, 0.5);
  plane.principal_point_ = factor * (principal_point_ + half) - half;
  return plane;
}

Eigen::Vector2d ImagePlane::pixelFromIdeal(const Eigen::Vector2d& ideal,
                                           Eigen::Matrix2d* jacobian) const {
  if (!is_distorted_) {
    if (jacobian != nullptr) *jacobian = affine_;
    return affine_ * ideal + principal_point_;
  }
  const Eigen::Vector2d distorted = distort(ideal, jacobian);
  if (jacobian != nullptr) *jacobian = affine_ * *jacobian;
  return affine_ * distorted + principal_point_;
}

std::optional<Eigen::Vector2d> ImagePlane::idealFromPixel(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d distorted = inverse_affine_ * (pixel - principal_point_);
  if (!is_distorted_) return distorted;
  if (is_equirectangular_) return azimuthalFromPlateCarree(distorted);
  // Newton from the centre, where nothing is distorted. A step that crosses the distortion's fold,
  // or brings less than half of what it promises, is halved.
  constexpr int kMaxIterations = 100;
  constexpr double kTolerance = 1e-14;
  Eigen::Vector2d ideal = Eigen::Vector2d::Zero();
  Eigen::Vector2d step = distorted;
  double share = 1.0;
  double last_error = distorted.norm();
  for (int i = 0; i < kMaxIterations; ++i) {
    const Eigen::Vector2d next = ideal + share * step;
    if (share * step.norm() <= kTolerance * (1.0 + next.norm())) return next;
    Eigen::Matrix2d jacobian;
    const Eigen::Vector2d error = distorted - distort(next, &jacobian);
    const bool follows_promise =
        error.norm() <= (1.0 - 0.5 * share) * last_error + kTolerance * distorted.norm();
    if (jacobian.determinant() > 0.0 && follows_promise) {
      ideal = next;
      step = jacobian.inverse() * error;
      share = 1.0;
      last_error = error.norm();
    } else {
      share *= 0.5;
    }
  }
  return std::nullopt;
}

bool ImagePlane::isInvertibleUpTo(double radius) const {
  if (is_equirectangular_) return radius < kPi;
  constexpr int kRadii = 64;
  constexpr int kAzimuths = 32;
  for (int i = 0; i <= kRadii && is_distorted_; ++i) {
    for (int k = 0; k < kAzimuths; ++k) {
      const double azimuth = 2.0 * kPi * k / kAzimuths;
      const Eigen::Vector2d ideal =
          radius * i / kRadii * Eigen::Vector2d(std::cos(azimuth), std::sin(azimuth));
      Eigen::Matrix2d jacobian;
      distort(ideal, &jacobian);
      if (!(jacobian.determinant() > 0.0)) return false;
    }
  }
  return true;
}

double ImagePlane::scale() const { return std::sqrt(std::abs(affine_.determinant())); }

Eigen::Vector2d ImagePlane::distort(const Eigen::Vector2d& ideal, Eigen::Matrix2d* jacobian) const {
  if (is_equirectangular_) return plateCarreeFromAzimuthal(ideal, jacobian);
  const auto& [k1, k2, p1, p2, k3] = distortion_;
  const double x = ideal.x();
  const double y = ideal.y();
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  if (jacobian != nullptr) {
    const double radial_r2 = k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3);
    const double cross = 2.0 * x * y * radial_r2 + 2.0 * (p1 * x + p2 * y);
    *jacobian << radial + 2.0 * x * x * radial_r2 + 2.0 * p1 * y + 6.0 * p2 * x, cross, cross,
        radial + 2.0 * y * y * radial_r2 + 6.0 * p1 * y + 2.0 * p2 * x;
  }
  return {x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
          y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y};
}

}  // namespace omnitag
