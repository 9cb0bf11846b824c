#include "camera/ocam_camera.h"

#include <Eigen/LU>
#include <cmath>
#include <sstream>

#include "omnitag/common/error.h"

namespace omnitag {

OcamCamera::OcamCamera(const OcamCalibration& calibration, const FieldLimits& limits)
    : CentralCamera(
          calibration.image_size, imagePlaneOf(calibration),
          fieldOf({calibration.polynomial},
                  radiusOfImage(calibration.image_size, imagePlaneOf(calibration)), limits)),
      inverse_({calibration.polynomial}, maxRadius()) {
  tabulateRays();
}

ValueAndSlope OcamCamera::Angle::operator()(double radius) const {
  double depth = 0.0;
  double depth_by_radius = 0.0;
  for (auto coefficient = polynomial.rbegin(); coefficient != polynomial.rend(); ++coefficient) {
    depth_by_radius = depth_by_radius * radius + depth;
    depth = depth * radius - *coefficient;
  }
  return {std::atan2(radius, depth),
          (depth - radius * depth_by_radius) / (radius * radius + depth * depth)};
}

ImagePlane OcamCamera::imagePlaneOf(const OcamCalibration& calibration) {
  // (row, column) = [c d; e 1] (x, y) + centre in the toolbox's axes.
  Eigen::Matrix2d affine;
  affine << 1.0, calibration.e, calibration.d, calibration.c;
  if (!(affine.determinant() > 0.0)) {
    throw InputError(
        "affine parameters: expected c - d e > 0, found a matrix that is singular or "
        "mirrors");
  }
  return {affine, {calibration.center_column, calibration.center_row}};
}

CentralField OcamCamera::fieldOf(const Angle& angle, double image_radius,
                                 const FieldLimits& limits) {
  const double wanted = limits.max_angle.value_or(kLargestAngle);
  const double end = increasingUpTo(angle, image_radius);
  const double end_angle = angle(end).value;
  if (!(end > 0.0) || (limits.max_angle && end < image_radius && end_angle < wanted)) {
    std::ostringstream message;
    message << "polynomial: expected one whose angle off the axis grows with the radius";
    if (limits.max_angle) message << " up to max_angle, " << wanted << " rad";
    message << ", found one that folds the image at a radius of " << end << " pixels";
    throw InputError(message.str());
  }
  if (end_angle <= wanted) return {end_angle, end, limits.through_mirror};
  return {wanted, InverseFunction<Angle>(angle, end)(wanted), limits.through_mirror};
}

ValueAndSlope OcamCamera::radiusAt(double angle) const {
  const double radius = inverse_(angle);
  return {radius, 1.0 / inverse_.function()(radius).slope};
}

}  // namespace omnitag
