#pragma once

#include <Eigen/Core>

/// Conversion between two planes that both show the whole sphere of directions. Points of the
/// azimuthal equidistant plane about the optical axis z lie as far from its origin as directions
/// lie off the axis (rad). The coordinates of the plate carree are the longitude about y from z
/// toward x, and the latitude toward y (rad). Both have their origin on the axis and agree there to
/// first order.
namespace omnitag {

/// Longitude and latitude, in [-pi, pi] and [-pi / 2, pi / 2], of a point of the azimuthal plane
/// and, on request, their derivative with respect to it, which is infinite at the poles +-y.
Eigen::Vector2d plateCarreeFromAzimuthal(const Eigen::Vector2d& azimuthal,
                                         Eigen::Matrix2d* jacobian = nullptr);

/// The inverse. Longitudes and latitudes outside these ranges continue around the sphere.
Eigen::Vector2d azimuthalFromPlateCarree(const Eigen::Vector2d& plate_carree);

}  // namespace omnitag
