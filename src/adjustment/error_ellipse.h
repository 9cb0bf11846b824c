#pragma once

#include <Eigen/Core>

namespace omnitag {

/// One standard deviation in every direction of a plane.
struct ErrorEllipse {
  /// Half axes, in the unit of the error.
  double major = 0.0;
  double minor = 0.0;
  /// rad, direction of the longer axis, from -pi/2 to pi/2.
  double direction = 0.0;

  /// A point of the ellipse around `centre`; one turn is 2 pi.
  Eigen::Vector2d point(const Eigen::Vector2d& centre, double turn) const;
};

ErrorEllipse errorEllipse(const Eigen::Matrix2d& covariance);

/// How many times larger than true errors may be drawn: the largest of 1, 2, 5, ..., 1000 with
/// which an error of `largest` becomes at most `room` (in the same unit).
int magnificationFor(double largest, double room);

}  // namespace omnitag
