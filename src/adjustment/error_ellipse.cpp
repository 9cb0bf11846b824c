#include "adjustment/error_ellipse.h"

#include <algorithm>
#include <cmath>

#include "common/symmetric_matrix.h"

namespace omnitag {

Eigen::Vector2d ErrorEllipse::point(const Eigen::Vector2d& centre, double turn) const {
  const Eigen::Vector2d along(std::cos(direction), std::sin(direction));
  const Eigen::Vector2d across(-along.y(), along.x());
  return centre + major * std::cos(turn) * along + minor * std::sin(turn) * across;
}

ErrorEllipse errorEllipse(const Eigen::Matrix2d& covariance) {
  const EigenPairs eigen = eigenPairs(covariance);
  const Eigen::Vector2d radii = eigen.values.cwiseMax(0.0).cwiseSqrt();
  Eigen::Vector2d axis = eigen.vectors.col(1);
  if (axis.x() < 0.0) axis = -axis;
  return {radii(1), radii(0), std::atan2(axis.y(), axis.x())};
}

int magnificationFor(double largest, double room) {
  int magnification = 1;
  for (const int step : {2, 5, 10, 20, 50, 100, 200, 500, 1000}) {
    if (step * largest <= room) magnification = step;
  }
  return magnification;
}

}  // namespace omnitag
