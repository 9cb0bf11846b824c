#pragma once

#include <Eigen/Core>

namespace omnitag {

/// What a calibration leaves uncertain: smooth modes by which a whole image may be off, each with a
/// standard deviation in pixels. With n = (pixel - principal point) / (radius of the rim), the
/// modes are
///
///   principal point  (1, 0) and (0, 1)    the image is displaced
///   scale            n                    it is larger
///   tilt             n_x n and n_y n      it is seen aslant: a mirror or a sensor that leans
///   rim              |n|^2 n              it is larger toward the rim
///
/// All but the first reach their full size at the rim. All images of a camera have the same errors.
struct CameraUncertainty {
  double principal_point = 0.0;
  double scale = 0.0;
  double tilt = 0.0;
  double rim = 0.0;

  bool isNone() const {
    return principal_point == 0.0 && scale == 0.0 && tilt == 0.0 && rim == 0.0;
  }

  /// The uncertainty for images with `factor` times as many pixels along each side.
  CameraUncertainty scaled(double factor) const {
    return {factor * principal_point, factor * scale, factor * tilt, factor * rim};
  }

  /// Pixels, standard deviation of the errors that no smooth mode describes, from marker to marker
  /// and from corner to corner. Published calibrations leave 1 to 2 pixels near the rim of a
  /// fisheye of 1600 pixels, most of which is smooth.
  double local() const;
};

/// The number of modes, in the order above.
constexpr int kCameraModes = 6;

/// Displacement of the image at `n` (pixels; see above) by each mode, off by a standard deviation.
Eigen::Matrix<double, 2, kCameraModes> displacementByError(const CameraUncertainty& uncertainty,
                                                           const Eigen::Vector2d& n);

/// The number of coefficients of the shape of a marker's image.
constexpr int kShapeTerms = 10;

/// Pixels by which errors that no mode describes displace the image of a marker: in each direction
/// of the image, a polynomial of the second degree without its constant. Each column is for one
/// coefficient, off by a standard deviation. `place`: on the marker's drawing, from -1 to 1 along
/// either side.
Eigen::Matrix<double, 2, kShapeTerms> displacementByShape(const CameraUncertainty& uncertainty,
                                                          const Eigen::Vector2d& place);

}  // namespace omnitag
