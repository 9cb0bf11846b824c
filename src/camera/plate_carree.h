#pragma once

#include <Eigen/Core>

/// Between two planes that both show the whole sphere of directions: the azimuthal equidistant one
/// about the optical axis z, whose points lie as far from its origin as directions lie off the axis
/// (rad), and the plate carree, whose coordinates are the longitude about y from z toward x, and
/// the latitude toward y (rad). Both begin at the axis and agree there to first order.
namespace omnitag {

/// Longitude and latitude, from -pi to pi and from -pi / 2 to pi / 2, of a point of the azimuthal
/// plane, and on request their derivative by it, which is infinite at the poles +-y.
Eigen::Vector2d plateCarreeFromAzimuthal(const Eigen::Vector2d& azimuthal,
                                         Eigen::Matrix2d* jacobian = nullptr);

/// The inverse. Longitudes and latitudes beyond these go on around the sphere.
Eigen::Vector2d azimuthalFromPlateCarree(const Eigen::Vector2d& plate_carree);

}  // namespace omnitag
