#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "camera/mounted_camera.h"
#include "localization/observation.h"
#include "marker/marker_reader.h"
#include "omnitag/common/angle.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag::test {

/// A marker on a wall, 0.8 m across; `yaw` is where it faces.
inline Marker wallMarker(int id, const Eigen::Vector3d& center, double yaw, double roll = 0.0) {
  Marker marker;
  marker.family = "tag36h11";
  marker.id = id;
  marker.size = 0.8;
  marker.map_from_marker = Eigen::Translation3d(center) * uprightOrientation(yaw, roll);
  return marker;
}

/// The same with a size (m).
inline Marker hung(int id, const Eigen::Vector3d& center, double yaw, double size) {
  Marker marker = wallMarker(id, center, yaw);
  marker.size = size;
  return marker;
}

/// Eight markers of this size around the origin, at this distance (m) and various heights, facing
/// it.
inline std::vector<Marker> markersAround(double distance, double size) {
  std::vector<Marker> markers;
  for (int i = 0; i < 8; ++i) {
    const double direction = 2.0 * kPi * i / 8 + 0.15 * (i % 3);
    markers.push_back(wallMarker(
        3 * i, {distance * std::cos(direction), distance * std::sin(direction), 0.8 + 0.12 * i},
        direction + kPi));
    markers.back().size = size;
  }
  return markers;
}

/// A marker that lies on the floor, or face down under the ceiling; `turn` is about the vertical.
inline Marker lyingMarker(int id, const Eigen::Vector3d& center, bool face_up, double turn,
                          double size) {
  Marker marker;
  marker.family = "tag36h11";
  marker.id = id;
  marker.size = size;
  marker.map_from_marker = Eigen::Translation3d(center) *
                           Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()) *
                           Eigen::AngleAxisd(face_up ? 0.0 : kPi, Eigen::Vector3d::UnitX());
  return marker;
}

/// Ten markers, with ids from 0, at various heights on the walls of a room of 8 x 8 m, whose middle
/// is the origin.
inline std::vector<Marker> roomMarkers() {
  return {wallMarker(0, {4.0, -2.3, 1.1}, kPi),      wallMarker(1, {4.0, 0.4, 1.5}, kPi),
          wallMarker(2, {4.0, 2.9, 0.9}, kPi),       wallMarker(3, {1.8, 4.0, 1.3}, -kPi / 2),
          wallMarker(4, {-2.1, 4.0, 1.6}, -kPi / 2), wallMarker(5, {-4.0, 1.7, 1.0}, 0.0),
          wallMarker(6, {-4.0, -0.9, 1.4}, 0.0),     wallMarker(7, {-3.1, -4.0, 1.2}, kPi / 2),
          wallMarker(8, {-0.2, -4.0, 0.8}, kPi / 2), wallMarker(9, {2.6, -4.0, 1.7}, kPi / 2)};
}

/// Where a marker images, exactly; nothing if the camera sees it from behind, too obliquely to be
/// read, or not entirely.
inline std::optional<MarkerReading> exactReading(const Marker& marker, const MountedCamera& camera,
                                                 const Pose& map_from_base) {
  const Eigen::Vector3d to_camera =
      camera.mapFromCamera(map_from_base).translation() - marker.center();
  if (marker.normal().dot(to_camera.normalized()) < std::cos(radians(75.0))) return std::nullopt;
  MarkerReading reading;
  reading.family = marker.family;
  reading.id = marker.id;
  const Corners<Eigen::Vector3d> corners = marker.corners();
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const auto pixel = camera.pixelFromMap(map_from_base, corners[k]);
    if (!pixel) return std::nullopt;
    reading.corners[k] = *pixel;
  }
  const auto center = camera.pixelFromMap(map_from_base, marker.center());
  if (!center) return std::nullopt;
  reading.center = *center;
  return reading;
}

/// The same with random errors of its positions, of standard deviation `noise` along each axis.
inline MarkerReading withNoise(MarkerReading reading, double noise, std::mt19937* generator) {
  std::normal_distribution<double> normal(0.0, noise);
  const auto disturb = [&](Eigen::Vector2d* position) {
    position->x() += normal(*generator);
    position->y() += normal(*generator);
  };
  for (Eigen::Vector2d& corner : reading.corners) disturb(&corner);
  disturb(&reading.center);
  return reading;
}

inline double positionError(const Pose& a, const Pose& b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

/// By how many standard deviations a position on the floor is off.
inline double deviations(const PoseEstimate& estimate, const Pose& truth) {
  const Eigen::Vector2d off = difference(estimate.pose, truth).head<2>();
  const Eigen::Matrix2d covariance = estimate.covariance.topLeftCorner<2, 2>();
  return std::sqrt(off.dot(covariance.ldlt().solve(off)));
}

}  // namespace omnitag::test
