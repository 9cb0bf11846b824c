#include "adjustment/pose_from_bearings.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "adjustment/leaning_mounting.h"
#include "localization/triangulation.h"
#include "omnitag/common/angle.h"

namespace omnitag {
namespace {

/// Headings to start from: triangulation converges from about 45 degrees.
constexpr int kStarts = 8;

/// A sight that misses its landmark by more is of another marker, or the pose is wrong.
constexpr double kLargeError = radians(20.0);

/// The direction in which a pixel looks. For an upright camera, only the azimuth about its axis
/// counts, which does not depend on how the optics image elevation; one whose axis is horizontal
/// images both.
std::optional<Eigen::Vector3d> directionInBase(const MountedCamera& camera,
                                               const Eigen::Vector2d& pixel) {
  if (!isUpright(camera.baseFromCamera())) {
    const std::optional<Ray> ray = camera.rayInBase(pixel);
    return ray ? std::optional(ray->direction) : std::nullopt;
  }
  const auto ideal = camera.model().imagePlane().idealFromPixel(pixel);
  if (!ideal) return std::nullopt;
  return camera.baseFromCamera().linear() * Eigen::Vector3d(ideal->x(), ideal->y(), 0.0);
}

std::vector<LandmarkBearing> sightsOf(const MarkerMap& map, const MountedCamera& camera,
                                      const CalibrationFrame& frame) {
  constexpr double kDeviation = radians(2.0);
  std::vector<LandmarkBearing> sights;
  for (const MarkerObservation& observation : frame.observations) {
    const auto seen_in = directionInBase(camera, observation.center);
    if (!seen_in) continue;
    const Eigen::Vector3d& direction = *seen_in;
    LandmarkBearing sight;
    sight.landmark = map.markers[observation.map_entry].center().head<2>();
    sight.viewpoint = camera.baseFromCamera().translation().head<2>();
    sight.bearing = std::atan2(direction.y(), direction.x());
    sight.bearing_deviation = kDeviation;
    sights.push_back(sight);
  }
  return sights;
}

double errorOf(const LandmarkBearing& sight, const Pose& pose) {
  const Eigen::Vector2d viewpoint =
      Eigen::Vector2d(pose.x, pose.y) + Eigen::Rotation2Dd(pose.yaw) * sight.viewpoint;
  const Eigen::Vector2d way = sight.landmark - viewpoint;
  return std::abs(normalizeAngle(std::atan2(way.y(), way.x()) - pose.yaw - sight.bearing));
}

/// A pose and how well all sights agree with it.
struct Candidate {
  Pose pose;
  std::size_t agreeing = 0;
  double squares = 0.0;

  bool isBetterThan(const Candidate& other) const {
    return agreeing != other.agreeing ? agreeing > other.agreeing : squares < other.squares;
  }
};

Candidate judge(const std::vector<LandmarkBearing>& sights, const Pose& pose) {
  Candidate candidate{pose};
  for (const LandmarkBearing& sight : sights) {
    const double error = errorOf(sight, pose);
    if (error >= kLargeError) continue;
    ++candidate.agreeing;
    candidate.squares += error * error;
  }
  return candidate;
}

/// Improves the best candidate by triangulation from `some` of all sights.
void improve(const std::vector<LandmarkBearing>& some, const std::vector<LandmarkBearing>& all,
             std::optional<Candidate>* best) {
  for (int i = 0; i < kStarts; ++i) {
    const auto estimate = triangulate(some, normalizeAngle(2.0 * kPi * i / kStarts));
    if (!estimate) continue;
    const Candidate candidate = judge(all, estimate->pose);
    if (!*best || candidate.isBetterThan(**best)) *best = candidate;
  }
}

}  // namespace

std::optional<Pose> poseFromBearings(const MarkerMap& map, const MountedCamera& camera,
                                     const CalibrationFrame& frame) {
  constexpr std::size_t kMinAgreeing = 3;
  const std::vector<LandmarkBearing> sights = sightsOf(map, camera, frame);
  std::optional<Candidate> best;
  improve(sights, sights, &best);
  const bool is_clear = best && best->agreeing == sights.size();
  // A marker that hangs elsewhere than mapped, or was misread, spoils the pose: try without it.
  for (std::size_t left_out = 0; !is_clear && left_out < sights.size(); ++left_out) {
    std::vector<LandmarkBearing> others = sights;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(left_out));
    improve(others, sights, &best);
  }
  return best && best->agreeing >= kMinAgreeing ? std::optional(best->pose) : std::nullopt;
}

}  // namespace omnitag
