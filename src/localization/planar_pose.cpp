#include "localization/planar_pose.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "common/symmetric_matrix.h"

namespace omnitag {
namespace {

/// The corners' lines of sight, in base_link.
std::optional<Corners<Ray>> raysOf(const MarkerObservation& observation,
                                   const MountedCamera& camera) {
  Corners<Ray> rays;
  for (std::size_t k = 0; k < rays.size(); ++k) {
    const auto ray = camera.rayInBase(observation.corners[k]);
    if (!ray) return std::nullopt;
    rays[k] = *ray;
  }
  return rays;
}

/// The homography from places on a marker's plane, (x, y, 1) in its frame, to the directions in
/// which its corners are seen: the matrix, up to scale, that minimises their cross products (direct
/// linear transform). Its sign puts the marker's middle ahead.
Eigen::Matrix3d homography(double size, const Corners<Eigen::Vector3d>& directions) {
  constexpr std::array<double, 4> kX = {-0.5, 0.5, 0.5, -0.5};
  constexpr std::array<double, 4> kY = {-0.5, -0.5, 0.5, 0.5};
  Eigen::Matrix<double, 12, 9> equations;
  Eigen::Vector3d ahead = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < directions.size(); ++k) {
    const Eigen::Vector3d& d = directions[k];
    Eigen::Matrix3d cross;
    cross << 0.0, -d.z(), d.y(), d.z(), 0.0, -d.x(), -d.y(), d.x(), 0.0;
    const Eigen::Index row = 3 * static_cast<Eigen::Index>(k);
    equations.block<3, 3>(row, 0) = size * kX[k] * cross;
    equations.block<3, 3>(row, 3) = size * kY[k] * cross;
    equations.block<3, 3>(row, 6) = cross;
    ahead += d;
  }
  const EigenPairs squares = eigenPairs(equations.transpose() * equations);
  const Eigen::Matrix3d least = Eigen::Map<const Eigen::Matrix3d>(squares.vectors.data());
  return least.col(2).dot(ahead) < 0.0 ? -least : least;
}

/// The one or two orientations, each with the place, of a marker that is seen in these directions.
std::vector<Eigen::Isometry3d> orientationsSeen(double size,
                                                const Corners<Eigen::Vector3d>& directions) {
  const Eigen::Matrix3d plane = homography(size, directions);
  const Eigen::Vector3d sight = plane.col(2).normalized();
  const Eigen::Matrix3d along_sight =
      Eigen::Quaterniond::FromTwoVectors(sight, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Eigen::Matrix2d affine = (along_sight * plane).topLeftCorner<2, 2>() / plane.col(2).norm();
  const Eigen::JacobiSVD<Eigen::Matrix2d> svd(affine, Eigen::ComputeFullV);
  const double scale = svd.singularValues()(0);
  if (!(scale > 0.0) || !std::isfinite(scale)) return {};

  const Eigen::Matrix2d seen = affine / scale;
  // The missing components of the two columns lie along the line of sight and make them
  // perpendicular unit vectors.
  const double foreshortening = svd.singularValues()(1) / scale;
  const double lacking = std::sqrt(std::max(0.0, 1.0 - foreshortening * foreshortening));
  std::vector<Eigen::Isometry3d> poses;
  for (const double side : {1.0, -1.0}) {
    const Eigen::Vector2d depth = side * lacking * svd.matrixV().col(1);
    Eigen::Matrix3d rotation;
    rotation.col(0) << seen.col(0), depth(0);
    rotation.col(1) << seen.col(1), depth(1);
    rotation.col(2) = rotation.col(0).cross(rotation.col(1));
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = along_sight.transpose() * rotation;
    pose.translation() = sight / scale;
    poses.push_back(pose);
    if (lacking == 0.0) break;
  }
  return poses;
}

}  // namespace

std::vector<Pose> planarPoses(const Marker& marker, const MountedCamera& camera,
                              const MarkerObservation& observation) {
  const std::optional<Corners<Ray>> rays = raysOf(observation, camera);
  if (!rays) return {};
  Eigen::Vector3d viewpoint = Eigen::Vector3d::Zero();
  Corners<Eigen::Vector3d> directions;
  for (std::size_t k = 0; k < rays->size(); ++k) {
    viewpoint += 0.25 * (*rays)[k].origin;
    directions[k] = (*rays)[k].direction;
  }
  // Once the distance is roughly known, the lines of sight can be taken from one point.
  constexpr int kRounds = 3;
  std::vector<Eigen::Isometry3d> seen;
  for (int round = 0; round < kRounds; ++round) {
    seen = orientationsSeen(marker.size, directions);
    if (seen.empty()) return {};
    const double distance = seen.front().translation().norm();
    for (std::size_t k = 0; k < rays->size(); ++k) {
      const Ray& ray = (*rays)[k];
      directions[k] = (ray.origin + distance * ray.direction - viewpoint).normalized();
    }
  }
  std::vector<Pose> poses;
  for (Eigen::Isometry3d& base_from_marker : seen) {
    base_from_marker.pretranslate(viewpoint);
    poses.push_back(Pose::fromIsometry(marker.map_from_marker * base_from_marker.inverse()));
  }
  return poses;
}

Pose flippedPose(const Marker& marker, const MountedCamera& camera, const Pose& map_from_base) {
  const Eigen::Isometry3d marker_from_base =
      marker.map_from_marker.inverse() * map_from_base.toIsometry();
  Eigen::Isometry3d base_from_marker = marker_from_base.inverse();
  const Eigen::Vector3d viewpoint = camera.baseFromCamera().translation();
  const Eigen::Vector3d sight = (base_from_marker.translation() - viewpoint).normalized();
  const Eigen::Matrix3d rotation = base_from_marker.linear();
  // Reverse the components of the marker's edges along the line of sight.
  base_from_marker.linear() = (rotation - 2.0 * sight * (sight.transpose() * rotation)) *
                              Eigen::Vector3d(1.0, 1.0, -1.0).asDiagonal();
  return Pose::fromIsometry(marker.map_from_marker * base_from_marker.inverse());
}

}  // namespace omnitag
