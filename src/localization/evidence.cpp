#include "omnitag/localization/evidence.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace omnitag {
namespace {

/// Length of the shortest tree that joins points, in which a step counts at least `shortest`
/// (Prim).
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

EvidenceConfig readEvidenceConfig(const YamlReader& reader) {
  reader.allowOnly({"carried", "carried_without_odometry", "misread", "moved", "moved_per_second",
                    "together", "missed", "mistaken_start", "mistaken", "odds"});
  constexpr Interval kProbability{1e-30, 1.0};
  EvidenceConfig config;
  reader.read("carried", &config.carried, kProbability);
  reader.read("carried_without_odometry", &config.carried_without_odometry, kProbability);
  reader.read("misread", &config.misread, kProbability);
  reader.read("moved", &config.moved, kProbability);
  reader.read("moved_per_second", &config.moved_per_second, kProbability);
  reader.read("together", &config.together, kPositive);
  reader.read("mistaken_start", &config.mistaken_start, kProbability);
  reader.read("mistaken", &config.mistaken, kProbability);
  reader.read("missed", &config.missed, kProbability);
  reader.read("odds", &config.odds, {1.0, 1e30});
  return config;
}

Verdict Evidence::weigh(const Contradiction& contradiction,
                        const std::optional<PosePrior>& start) const {
  const Eigen::Isometry3d motion =
      contradiction.found.toIsometry() * contradiction.expected.toIsometry().inverse();
  const double since_then = leadSinceThen(contradiction, motion);
  const double all_along = leadAllAlong(contradiction, motion, start);
  const double decisive = std::log(config_.odds);
  if (std::min(since_then, all_along) < -decisive) return Verdict::kFound;
  if (std::min(since_then, all_along) > decisive) return Verdict::kExpected;
  return Verdict::kOpen;
}

double Evidence::leadSinceThen(const Contradiction& contradiction,
                               const Eigen::Isometry3d& motion) const {
  // What was known to hang elsewhere before says nothing new of the robot's last way.
  std::vector<std::size_t> news;
  for (const std::size_t entry : contradiction.for_found) {
    if (!memory_.isElsewhere(entry)) news.push_back(entry);
  }
  const double carried =
      contradiction.has_odometry ? config_.carried : config_.carried_without_odometry;
  return logOfMoved(news, motion) + logOfMissed(contradiction.missed, true) +
         logOfMissed(contradiction.missed, false) - std::log(carried) -
         logOfMoved(contradiction.for_expected, motion);
}

double Evidence::leadAllAlong(const Contradiction& contradiction, const Eigen::Isometry3d& motion,
                              const std::optional<PosePrior>& start) const {
  std::vector<std::size_t> for_found = contradiction.for_found;
  std::vector<std::size_t> for_expected = contradiction.for_expected;
  for (std::size_t entry = 0; entry < memory_.size(); ++entry) {
    const auto isIn = [entry](const std::vector<std::size_t>& entries) {
      return std::find(entries.begin(), entries.end(), entry) != entries.end();
    };
    if (isIn(contradiction.for_found) || isIn(contradiction.for_expected)) continue;
    const RememberedSighting* const elsewhere = memory_.elsewhere(entry);
    const RememberedSighting* const in_place = memory_.inPlace(entry);
    if (elsewhere && !contradicts(*elsewhere, motion)) for_found.push_back(entry);
    if (in_place && contradicts(*in_place, motion)) for_expected.push_back(entry);
  }
  double lead = logOfMoved(for_found, motion) + logOfMissed(contradiction.missed, false) -
                logOfMoved(for_expected, motion);
  constexpr std::size_t kSeveral = 3;
  const std::size_t in_place = memory_.countInPlace();
  if (in_place >= kSeveral) lead -= std::log(config_.mistaken);
  if (start && in_place > 0) {
    lead -= logOfStart(*start, motion, true);
  } else if (start) {
    const Eigen::Isometry3d given = contradiction.predicted.toIsometry().inverse();
    const bool is_met = !contradiction.for_expected.empty();
    lead += logOfStart(*start, contradiction.expected.toIsometry() * given, true) -
            logOfStart(*start, contradiction.found.toIsometry() * given, is_met);
  }
  return lead;
}

double Evidence::logOfMoved(const std::vector<std::size_t>& entries,
                            const Eigen::Isometry3d& motion) const {
  if (entries.empty()) return 0.0;
  std::vector<Eigen::Vector3d> places;
  double probability = entries.size() == 1 ? config_.misread : config_.moved;
  for (const std::size_t entry : entries) {
    places.push_back(map_.markers[entry].center());
    const RememberedSighting* const sighting = memory_.inPlace(entry);
    if (!sighting || !contradicts(*sighting, motion)) continue;
    const double age = memory_.stamp() - sighting->stamp;
    probability = std::min(probability, config_.moved_per_second * std::max(age, 0.1));
  }
  constexpr double kNearest = 0.7;  // m: of two on one board, one may hang there alone
  return std::log(probability) - lengthOfTree(std::move(places), kNearest) / config_.together;
}

double Evidence::logOfStart(const PosePrior& start, const Eigen::Isometry3d& motion,
                            bool is_met) const {
  // How the robot leans is told anew by each image.
  const PoseVector any_lean =
      poseVector(Eigen::Vector3d(0.0, 0.0, 1.0), Eigen::Vector3d(1.0, 1.0, 0.0));
  const PosePrior loose = start.pushed(any_lean);
  const PoseVector off = loose.errorOf(Pose::fromIsometry(motion * start.pose.toIsometry()));
  // Markers that were moved lead to a pose that was given by mistake only by chance.
  const double mistaken = config_.mistaken_start * (is_met ? config_.mistaken : 1.0);
  return std::max(-0.5 * off.dot(loose.information * off), std::log(mistaken));
}

double Evidence::logOfMissed(const std::vector<std::size_t>& entries, bool were_seen) const {
  double sum = 0.0;
  for (const std::size_t entry : entries) {
    if (were_seen && memory_.wasSeen(entry)) sum += std::log(config_.missed);
    const bool is_new = !memory_.wasSeen(entry) && !memory_.wasMissed(entry);
    if (!were_seen && is_new) sum += std::log(1.0 - memory_.seenAtFirst());
  }
  // Somebody may stand before several.
  constexpr double kMostMissed = 6.0;
  return std::max(sum, kMostMissed * std::log(config_.missed));
}

bool Evidence::contradicts(const RememberedSighting& sighting,
                           const Eigen::Isometry3d& motion) const {
  const Pose moved = Pose::fromIsometry(motion * sighting.map_from_base.toIsometry());
  const Misfit misfit = misfitsAt(map_, sighting.camera, {sighting.observation}, moved,
                                  ImagingError::Zero(), reprojection_)
                            .front();
  return misfit.deviations > max_misfit_;
}

}  // namespace omnitag
