#include "localization/marker_pose.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "localization/planar_pose.h"
#include "marker/marker_reader.h"
#include "omnitag/common/angle.h"

namespace omnitag {
namespace {

/// A pose and how well it explains the corners: sum of their squared distances, in pixels.
struct Start {
  Pose map_from_base;
  double cost = std::numeric_limits<double>::infinity();
  /// m: horizontal distance from the camera to the marker.
  double distance = 0.0;
};

std::optional<Corners<Eigen::Vector2d>> project(const Corners<Eigen::Vector3d>& corners,
                                                const MountedCamera& camera, const Pose& pose) {
  Corners<Eigen::Vector2d> pixels;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const auto pixel = camera.pixelFromMap(pose, corners[k]);
    if (!pixel) return std::nullopt;
    pixels[k] = *pixel;
  }
  return pixels;
}

/// The pose from which a marker has the observed bearing and size, if the camera is in direction
/// `azimuth` from the marker. `guess`: m, the distance to try first.
Start startFrom(double azimuth, const Marker& marker, const MountedCamera& camera,
                const MarkerObservation& observation, double bearing, double guess) {
  constexpr int kRounds = 5;
  constexpr double kSettled = 0.01;
  const Eigen::Vector3d camera_in_base = camera.baseFromCamera().translation();
  const double yaw = normalizeAngle(azimuth + kPi - bearing);
  const Eigen::Vector2d away(std::cos(azimuth), std::sin(azimuth));
  const Eigen::Vector2d camera_offset = Eigen::Rotation2Dd(yaw) * camera_in_base.head<2>();
  const double height = marker.center().z() - camera_in_base.z();
  const Corners<Eigen::Vector3d> corners = marker.corners();

  const auto poseAt = [&](double distance) {
    const Eigen::Vector2d base = marker.center().head<2>() + distance * away - camera_offset;
    return Pose{base.x(), base.y(), yaw};
  };
  for (double distance : {guess, 3.0, 1.0, 8.0, 0.4}) {
    Start start;
    for (int round = 0; round < kRounds; ++round) {
      start.map_from_base = poseAt(distance);
      start.distance = distance;
      const auto pixels = project(corners, camera, start.map_from_base);
      if (!pixels) {
        start.cost = std::numeric_limits<double>::infinity();
        break;
      }
      start.cost = 0.0;
      for (std::size_t k = 0; k < corners.size(); ++k) {
        start.cost += ((*pixels)[k] - observation.corners[k]).squaredNorm();
      }
      constexpr double kNearest = 0.05;  // m
      const double growth = meanEdge(*pixels) / meanEdge(observation.corners);
      if (std::abs(growth - 1.0) < kSettled) break;
      const double range = std::hypot(distance, height) * growth;
      distance = std::sqrt(std::max(range * range - height * height, kNearest * kNearest));
    }
    if (std::isfinite(start.cost)) return start;
  }
  return {};
}

/// Whether a marker may face a camera that is in direction `azimuth` from it, at any distance.
bool mayFace(const Marker& marker, const MountedCamera& camera, double azimuth) {
  const Eigen::Vector3d normal = marker.normal();
  const double above = camera.baseFromCamera().translation().z() - marker.center().z();
  return normal.x() * std::cos(azimuth) + normal.y() * std::sin(azimuth) > 0.0 ||
         normal.z() * above > 0.0;
}

bool isFacing(const Marker& marker, const MountedCamera& camera, const Pose& pose) {
  const Eigen::Vector3d viewpoint = camera.mapFromCamera(pose).translation();
  return marker.normal().dot(viewpoint - marker.center()) > 0.0;
}

/// The distinct optima that several starts lead to.
class Optima {
 public:
  Optima(const MarkerMap& map, const MountedCamera& camera, const MarkerObservation& observation,
         const PosePrior& prior, const EstimatorConfig& config)
      : map_(map), camera_(camera), observation_(observation), prior_(prior), config_(config) {}

  void refineFrom(const Pose& start) {
    auto fit = refineFromAfar(map_, camera_, {observation_}, start, prior_, config_.reprojection);
    if (!fit || fit->misfits[0].deviations > config_.max_misfit) return;
    const Pose& pose = fit->map_from_base.pose;
    if (!isFacing(map_.markers[observation_.map_entry], camera_, pose)) return;
    const bool is_known =
        std::any_of(fits_.begin(), fits_.end(), [&pose](const ReprojectionFit& known) {
          constexpr double kSamePosition = 1e-3;  // m
          const PoseVector apart = difference(known.map_from_base.pose, pose);
          return translationPart(apart).norm() < kSamePosition;
        });
    if (!is_known) fits_.push_back(std::move(*fit));
  }

  std::size_t count() const { return fits_.size(); }

  /// Best first.
  std::vector<ReprojectionFit> take() {
    std::sort(fits_.begin(), fits_.end(), [](const ReprojectionFit& a, const ReprojectionFit& b) {
      return a.misfits[0].deviations < b.misfits[0].deviations;
    });
    return std::move(fits_);
  }

 private:
  const MarkerMap& map_;
  const MountedCamera& camera_;
  const MarkerObservation& observation_;
  PosePrior prior_;
  const EstimatorConfig& config_;
  std::vector<ReprojectionFit> fits_;
};

/// For a robot that stands on a floor: starts from all around the marker.
void refineFromAllAround(const Marker& marker, const MountedCamera& camera,
                         const MarkerObservation& observation, Optima* optima) {
  const std::optional<Ray> ray = camera.rayInBase(observation.center);
  if (!ray) return;
  const double bearing = std::atan2(ray->direction.y(), ray->direction.x());

  constexpr std::size_t kDirections = 36;
  std::array<Start, kDirections> starts;
  double distance = 3.0;  // m
  for (std::size_t i = 0; i < kDirections; ++i) {
    const double azimuth = 2.0 * kPi * static_cast<double>(i) / kDirections;
    if (!mayFace(marker, camera, azimuth)) continue;
    const Start start = startFrom(azimuth, marker, camera, observation, bearing, distance);
    if (!std::isfinite(start.cost)) continue;
    distance = start.distance;
    if (isFacing(marker, camera, start.map_from_base)) starts[i] = start;
  }

  const auto refineFrom = [optima](const Start& start) {
    if (std::isfinite(start.cost)) optima->refineFrom(start.map_from_base);
  };
  const double normal_azimuth = std::atan2(marker.normal().y(), marker.normal().x());
  for (std::size_t i = 0; i < kDirections; ++i) {
    const double cost = starts[i].cost;
    const bool is_lowest = std::isfinite(cost) && cost <= starts[(i + 1) % kDirections].cost &&
                           cost <= starts[(i + kDirections - 1) % kDirections].cost;
    if (!is_lowest) continue;
    refineFrom(starts[i]);
    // Two optima, hardly ever more, may lie between the same two directions, or one may hide behind
    // the other. So also start from the direction mirrored at the marker's normal and, if there are
    // not two optima yet, from both neighbouring directions.
    const double mirrored = 2.0 * normal_azimuth - 2.0 * kPi * static_cast<double>(i) / kDirections;
    refineFrom(startFrom(mirrored, marker, camera, observation, bearing, starts[i].distance));
    constexpr std::size_t kMostOptima = 2;
    if (optima->count() >= kMostOptima) continue;
    refineFrom(starts[(i + 1) % kDirections]);
    refineFrom(starts[(i + kDirections - 1) % kDirections]);
  }
}

}  // namespace

std::vector<ReprojectionFit> posesFromMarker(const MarkerMap& map, const MountedCamera& camera,
                                             const MarkerObservation& observation,
                                             const PosePrior& prior,
                                             const EstimatorConfig& config) {
  const Marker& marker = map.markers[observation.map_entry];
  Optima optima(map, camera, observation, prior.withoutPlace(), config);
  if (prior.knowsStanding()) {
    refineFromAllAround(marker, camera, observation, &optima);
  } else {
    for (const Pose& start : planarPoses(marker, camera, observation)) optima.refineFrom(start);
  }
  return optima.take();
}

std::optional<Pose> mirroredPose(const Marker& marker, const MountedCamera& camera,
                                 const Pose& map_from_base) {
  constexpr double kUpright = 0.5;
  const Eigen::Vector2d normal = marker.normal().head<2>();
  if (normal.norm() < kUpright) return std::nullopt;
  const Eigen::Vector2d viewpoint = camera.mapFromCamera(map_from_base).translation().head<2>();
  const Eigen::Vector2d center = marker.center().head<2>();
  const Eigen::Vector2d along = normal.normalized();
  const Eigen::Vector2d way = viewpoint - center;
  const Eigen::Vector2d mirrored_way = 2.0 * way.dot(along) * along - way;
  const double turn = std::atan2(mirrored_way.y(), mirrored_way.x()) - std::atan2(way.y(), way.x());
  const Eigen::Vector2d base =
      center + mirrored_way +
      Eigen::Rotation2Dd(turn) * (Eigen::Vector2d(map_from_base.x, map_from_base.y) - viewpoint);
  // Turning about the vertical changes neither the height nor the lean.
  return leaningAs(map_from_base, {base.x(), base.y(), normalizeAngle(map_from_base.yaw + turn)});
}

}  // namespace omnitag
