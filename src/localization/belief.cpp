#include "localization/belief.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "localization/displacement.h"
#include "localization/frame_search.h"
#include "localization/frame_steps.h"

namespace omnitag {
namespace {

/// At most this many are kept: each costs as much as tracking does.
constexpr std::size_t kMostHypotheses = 3;

bool contains(const std::vector<std::size_t>& entries, std::size_t entry) {
  return std::find(entries.begin(), entries.end(), entry) != entries.end();
}

const MarkerDetection* detectionOf(std::size_t entry, const FrameResult& result) {
  const auto found = std::find_if(
      result.detections.begin(), result.detections.end(),
      [entry](const MarkerDetection& detection) { return detection.map_entry == entry; });
  return found == result.detections.end() ? nullptr : &*found;
}

/// Marks a marker that another branch has in its place as elsewhere for this one, unless it is in
/// its place here, too.
void addElsewhere(const MarkerDetection& seen, FrameResult* result) {
  const std::size_t entry = *seen.map_entry;
  const MarkerDetection* const here = detectionOf(entry, *result);
  if (here && here->accepted) return;
  if (!here) {
    result->detections.push_back(seen);
    result->detections.back().accepted = false;
    result->detections.back().reason = kElsewhere;
  }
  auto& missed = result->missed;
  missed.erase(std::remove(missed.begin(), missed.end(), entry), missed.end());
  if (!contains(result->elsewhere, entry)) result->elsewhere.push_back(entry);
}

void exchangeSightings(std::vector<Branch>* branches) {
  if (branches->size() < 2) return;
  std::vector<std::vector<MarkerDetection>> accepted;
  for (const Branch& branch : *branches) {
    accepted.emplace_back();
    std::copy_if(branch.result.detections.begin(), branch.result.detections.end(),
                 std::back_inserter(accepted.back()),
                 [](const MarkerDetection& detection) { return detection.accepted; });
  }
  for (std::size_t i = 0; i < branches->size(); ++i) {
    for (std::size_t j = 0; j < branches->size(); ++j) {
      if (i == j) continue;
      for (const MarkerDetection& seen : accepted[j]) addElsewhere(seen, &(*branches)[i].result);
    }
  }
}

/// Remembers which markers hang elsewhere: those that another branch has in their places form
/// one group.
void rememberElsewhere(const MountedCamera& camera, const Evidence& evidence,
                       const std::vector<Branch>& branches, Branch* branch) {
  const FrameResult& result = branch->result;
  const Pose& pose = result.map_from_base->pose;
  std::vector<RememberedSighting> rest;
  for (const MarkerDetection& detection : result.detections) {
    if (detection.accepted || !detection.map_entry) continue;
    if (!contains(result.elsewhere, *detection.map_entry)) continue;
    rest.push_back(sightingOf(detection, result, camera, pose));
  }
  for (const Branch& other : branches) {
    if (&other == branch || !other.result.map_from_base) continue;
    const auto isThere = [&other](const RememberedSighting& sighting) {
      const MarkerDetection* const seen = detectionOf(sighting.observation.map_entry, other.result);
      return seen != nullptr && seen->accepted;
    };
    const auto group = std::stable_partition(rest.begin(), rest.end(), isThere);
    if (group == rest.begin()) continue;
    branch->hypothesis.memory.addGroup(
        {rest.begin(), group},
        other.result.map_from_base->pose.toIsometry() * pose.toIsometry().inverse());
    rest.erase(rest.begin(), group);
  }
  for (const RememberedSighting& sighting : rest) {
    branch->hypothesis.memory.addElsewhere(sighting, evidence.contradiction());
  }
}

/// The same for a hypothesis without a pose: for it, markers that others have in their places were
/// moved.
void rememberOfOthers(const MountedCamera& camera, const std::vector<Branch>& branches,
                      MarkerMemory* memory) {
  for (const Branch& other : branches) {
    if (!other.result.map_from_base) continue;
    std::vector<RememberedSighting> group;
    for (const MarkerDetection& detection : other.result.detections) {
      if (!detection.accepted) continue;
      group.push_back(
          sightingOf(detection, other.result, camera, other.result.map_from_base->pose));
    }
    if (!group.empty()) memory->addGroup(group, std::nullopt);
  }
}

/// Remembers which markers the frame showed and which it did not.
void remember(const MountedCamera& camera, const Evidence& evidence,
              const std::vector<Branch>& branches, Branch* branch) {
  const FrameResult& result = branch->result;
  MarkerMemory& memory = branch->hypothesis.memory;
  if (branch->hypothesis.is_lost) return rememberOfOthers(camera, branches, &memory);
  if (!result.map_from_base) return;
  const Pose& pose = result.map_from_base->pose;
  for (const MarkerDetection& detection : result.detections) {
    if (detection.accepted) memory.addSeen(sightingOf(detection, result, camera, pose));
  }
  rememberElsewhere(camera, evidence, branches, branch);
  const bool is_told = result.acceptedMarkers() > 0;
  const Eigen::Vector3d viewpoint = camera.mapFromCamera(pose).translation();
  for (const std::size_t entry : result.missed) {
    if (is_told) {
      memory.addMissed(entry, viewpoint, result.stamp);
    } else {
      memory.addLost(entry);
    }
  }
}

bool haveSamePose(const Branch& a, const Branch& b) {
  if (!a.result.map_from_base || !b.result.map_from_base) return false;
  // m and rad: two poses this close to each other are tracked by the same markers.
  constexpr double kNear = 1e-3;
  const PoseVector apart = difference(a.result.map_from_base->pose, b.result.map_from_base->pose);
  return apart.head<3>().cwiseAbs().maxCoeff() < kNear;
}

/// Drops poses that a search found where another branch already tracks the markers: that branch
/// knows what earlier images showed from there.
void dropFoundAgain(std::vector<Branch>* branches) {
  std::vector<PoseEstimate> tracked;
  for (const Branch& branch : *branches) {
    if (branch.is_of_search || branch.result.acceptedMarkers() == 0) continue;
    if (branch.result.map_from_base) tracked.push_back(*branch.result.map_from_base);
  }
  const auto isFoundAgain = [&tracked](const Branch& branch) {
    const auto& pose = branch.result.map_from_base;
    return branch.is_of_search && pose &&
           std::any_of(tracked.begin(), tracked.end(),
                       [&pose](const PoseEstimate& there) { return agree(*pose, there); });
  };
  branches->erase(std::remove_if(branches->begin(), branches->end(), isFoundAgain),
                  branches->end());
}

/// A pose whose covariance is widened to cover another one that has this probability, and wherever
/// that one's covariance says that the robot may be.
PoseEstimate covering(const PoseEstimate& pose, const PoseEstimate& other, double probability) {
  // The markers of the other pose may be a little off, too, when two poses contend.
  constexpr double kAside = 0.15;
  const PoseVector apart = difference(other.pose, pose.pose);
  const PoseVector aside =
      kAside * poseVector(Eigen::Vector3d::Constant(translationPart(apart).norm()),
                          Eigen::Vector3d::Constant(rotationPart(apart).norm()));
  PoseEstimate wider = pose;
  wider.covariance += probability * apart * apart.transpose() + other.covariance;
  wider.covariance.diagonal() += probability * aside.cwiseAbs2();
  return wider;
}

/// The poses of the branches, with their probabilities.
std::vector<WeightedPose> weighted(const std::vector<Branch>& branches) {
  double sum = 0.0;
  std::vector<WeightedPose> poses;
  for (const Branch& branch : branches) {
    const double odds = std::exp(branch.log_probability - branches.front().log_probability);
    sum += odds;
    if (branch.result.map_from_base) poses.push_back({*branch.result.map_from_base, odds});
  }
  for (WeightedPose& pose : poses) pose.probability /= sum;
  return poses;
}

/// How many times likelier one hypothesis must be for the other to be dropped.
double oddsBetween(const Hypothesis& a, const Hypothesis& b, const EvidenceConfig& config) {
  const auto isOfStart = [](const Hypothesis& hypothesis) {
    return hypothesis.isWithinStart() && hypothesis.log_of_carried == 0.0;
  };
  return isOfStart(a) && isOfStart(b) ? std::max(config.odds, config.odds_at_start) : config.odds;
}

}  // namespace

std::vector<Branch> judged(std::vector<Branch> branches, const MountedCamera& camera,
                           const Evidence& evidence) {
  dropFoundAgain(&branches);
  exchangeSightings(&branches);
  for (Branch& branch : branches) {
    const double missed =
        branch.is_of_search ? 0.0
                            : evidence.logOfMissed(branch.result.missed, branch.hypothesis.memory);
    Hypothesis& hypothesis = branch.hypothesis;
    const double before = evidence.logOfPlaces(hypothesis.memory);
    remember(camera, evidence, branches, &branch);
    const double returned = before - evidence.logOfPlaces(hypothesis.memory);
    hypothesis.log_of_returned = std::min(hypothesis.log_of_returned, returned);
    branch.log_probability = branch.hypothesis.logProbability(evidence) + missed;
  }
  std::stable_sort(branches.begin(), branches.end(), [](const Branch& a, const Branch& b) {
    return a.log_probability > b.log_probability;
  });
  std::vector<Branch> kept;
  const double most = branches.front().log_probability;
  for (Branch& branch : branches) {
    if (kept.size() == kMostHypotheses) break;
    const Hypothesis& likeliest = kept.empty() ? branch.hypothesis : kept.front().hypothesis;
    const double odds = oddsBetween(likeliest, branch.hypothesis, evidence.config());
    if (branch.log_probability < most - std::log(odds)) continue;
    const bool is_double = std::any_of(kept.begin(), kept.end(), [&branch](const Branch& other) {
      return haveSamePose(branch, other);
    });
    if (!is_double) kept.push_back(std::move(branch));
  }
  return kept;
}

FrameResult reported(const std::vector<Branch>& branches, const MarkerMap& map,
                     const EvidenceConfig& config) {
  const Branch& best = branches.front();
  FrameResult result = best.result;
  result.hypotheses = weighted(branches);
  if (branches.size() == 1) {
    for (const DisplacedGroup& group : best.hypothesis.memory.displacedGroups()) {
      if (const auto moved = displacement(map, group)) result.displaced_groups.push_back(*moved);
    }
    return result;
  }
  result.is_open = true;
  const std::vector<std::size_t> accepted = acceptedEntries(result);
  for (auto other = branches.begin() + 1; other != branches.end(); ++other) {
    for (const std::size_t entry : acceptedEntries(other->result)) {
      const bool is_told = contains(result.elsewhere, entry) || contains(accepted, entry);
      if (!is_told) result.elsewhere.push_back(entry);
    }
  }
  if (result.elsewhere.empty()) result.elsewhere = accepted;
  result.remark = eitherOr(result.elsewhere, map);
  if (!result.map_from_base) return result;
  // No pose should be farther from the truth than this many of its deviations.
  constexpr double kDeviations = 3.0;
  for (auto other = branches.begin() + 1; other != branches.end(); ++other) {
    // What has no pose cannot be covered.
    if (!other->result.map_from_base) {
      withhold(map, &result);
      return result;
    }
    const double probability =
        1.0 / (1.0 + std::exp(best.log_probability - other->log_probability));
    result.map_from_base = covering(*result.map_from_base, *other->result.map_from_base,
                                    std::max(probability, 1.0 / (kDeviations * kDeviations)));
  }
  if (positionDeviation(*result.map_from_base) <= config.open_deviation) return result;
  withhold(map, &result);
  return result;
}

}  // namespace omnitag
