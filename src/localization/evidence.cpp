#include "localization/evidence.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/yaml_reader.h"

namespace omnitag {
namespace {

/// Length of the shortest tree that joins points, each step counting at least `shortest` (Prim).
double lengthOfTree(std::vector<Eigen::Vector3d> points, double shortest) {
  double length = 0.0;
  if (points.empty()) return length;
  std::vector<double> distances(points.size(), std::numeric_limits<double>::infinity());
  Eigen::Vector3d last = points.back();
  points.pop_back();
  while (!points.empty()) {
    std::size_t nearest = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      distances[i] = std::min(distances[i], (points[i] - last).norm());
      if (distances[i] < distances[nearest]) nearest = i;
    }
    length += std::max(distances[nearest], shortest);
    last = points[nearest];
    std::swap(points[nearest], points.back());
    std::swap(distances[nearest], distances[points.size() - 1]);
    points.pop_back();
  }
  return length;
}

}  // namespace

double Evidence::logOfPlaces(const MarkerMemory& memory) const {
  double sum = 0.0;
  for (const DisplacedGroup& group : memory.displacedGroups()) sum += logOfMoved(group, memory);
  return sum;
}

double Evidence::logOfMoved(const DisplacedGroup& group, const MarkerMemory& memory) const {
  std::vector<Eigen::Vector3d> places;
  places.reserve(group.entries.size());
  double probability = group.entries.size() == 1 ? config_.misread : config_.moved;
  for (const std::size_t entry : group.entries) {
    places.push_back(map_.markers[entry].center());
    // A misread marker may have been in its place a moment ago, and still be there.
    const RememberedSighting* const in_place = memory.inPlace(entry);
    // A marker seen once or twice may have seemed to be in its place by chance.
    constexpr int kSurely = 3;
    if (!in_place || memory.timesInPlace(entry) < kSurely) continue;
    if (!group.motion || group.entries.size() == 1) continue;
    if (!contradicts(*in_place, *group.motion)) continue;
    constexpr double kShortest = 0.1;  // s
    const double time = std::max(memory.elsewhereSince(entry) - in_place->stamp, kShortest);
    probability = std::min(probability, config_.moved_per_second * time);
  }
  constexpr double kNearest = 0.7;  // m: one of two on a board may be moved alone
  return std::log(probability) - lengthOfTree(std::move(places), kNearest) / config_.together;
}

double Evidence::logOfMissed(const std::vector<std::size_t>& entries,
                             const MarkerMemory& memory) const {
  double sum = 0.0;
  for (const std::size_t entry : entries) {
    if (memory.wasSeen(entry)) {
      sum += std::log(config_.missed);
    } else if (!memory.wasMissed(entry)) {
      sum += std::log(1.0 - memory.seenAtFirst());
    }
  }
  // A person may hide several at once.
  constexpr double kMostMissed = 6.0;
  return std::max(sum, kMostMissed * std::log(config_.missed));
}

double deviationsOfStart(const PosePrior& start, const Eigen::Isometry3d& motion) {
  // The robot's lean is estimated from each image independently.
  const PoseVector any_lean =
      poseVector(Eigen::Vector3d(0.0, 0.0, 1.0), Eigen::Vector3d(1.0, 1.0, 0.0));
  const PosePrior loose = start.pushed(any_lean);
  const PoseVector off = loose.errorOf(Pose::fromIsometry(motion * start.pose.toIsometry()));
  return std::sqrt(off.dot(loose.information * off));
}

double Evidence::logOfStart(const PosePrior& start, const Eigen::Isometry3d& motion,
                            bool is_met) const {
  const double deviations = deviationsOfStart(start, motion);
  const double mistaken = config_.mistaken_start * (is_met ? config_.mistaken : 1.0);
  return std::max(-0.5 * deviations * deviations, std::log(mistaken));
}

double Evidence::logOfCarried(bool has_odometry) const {
  return std::log(has_odometry ? config_.carried : config_.carried_without_odometry);
}

MarkerMemory::Contradicts Evidence::contradiction() const {
  return [this](const RememberedSighting& sighting, const Eigen::Isometry3d& motion) {
    return contradicts(sighting, motion);
  };
}

bool Evidence::contradicts(const RememberedSighting& sighting,
                           const Eigen::Isometry3d& motion) const {
  const Pose moved = Pose::fromIsometry(motion * sighting.map_from_base.toIsometry());
  const Misfit misfit = misfitsAt(map_, sighting.camera, {sighting.observation}, moved,
                                  ImagingError::Zero(), reprojection_)
                            .front();
  return misfit.deviations > config_.in_place;
}

}  // namespace omnitag
