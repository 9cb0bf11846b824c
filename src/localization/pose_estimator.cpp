#include "localization/pose_estimator.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <utility>

#include "common/yaml_reader.h"
#include "localization/triangulation.h"

namespace omnitag {
namespace {

/// Standard deviations (Misfit): a marker in its place is hardly ever off by more.
constexpr double kSharp = 1.2;

std::vector<MarkerObservation> chosen(const std::vector<MarkerObservation>& observations,
                                      const std::vector<bool>& used) {
  std::vector<MarkerObservation> subset;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (used[i]) subset.push_back(observations[i]);
  }
  return subset;
}

/// The line of sight of an observation's centre, seen from above, for a robot that leans as the
/// prior says.
std::optional<LandmarkBearing> sightOf(const MarkerObservation& observation, const MarkerMap& map,
                                       const MountedCamera& camera, const PosePrior& prior,
                                       double corner_noise) {
  const std::optional<Ray> leaning = camera.rayInBase(observation.center);
  if (!leaning) return std::nullopt;
  const Eigen::Matrix3d level_from_base = leaningAs(prior.pose, {}).toIsometry().linear();
  const Eigen::Vector3d origin = level_from_base * leaning->origin;
  const Eigen::Vector3d direction = level_from_base * leaning->direction;
  if (direction.head<2>().norm() < 1e-6) return std::nullopt;
  LandmarkBearing sight;
  const Marker& marker = map.markers[observation.map_entry];
  sight.landmark = marker.center().head<2>();
  sight.landmark_deviation = marker.deviation;
  sight.viewpoint = origin.head<2>();
  sight.bearing = std::atan2(direction.y(), direction.x());
  // The bearing's noise is the corner noise as seen at this radius. The centre is where the
  // diagonals meet, and each of them errs as much as its corners.
  const ImagePlane& plane = camera.model().imagePlane();
  const double radius = (observation.center - plane.principalPoint()).norm();
  sight.bearing_deviation = corner_noise / std::max(radius, 1.0);
  // The lean moves markers above or below the camera sideways.
  const double lean_information = prior.information(4, 4);
  const double slope = direction.z() / direction.head<2>().norm();
  if (lean_information > 0.0) {
    sight.bearing_deviation =
        std::hypot(sight.bearing_deviation, slope / std::sqrt(lean_information));
  }
  return sight;
}

/// A pose on the floor with the height and the lean of the prior.
PoseEstimate withLean(const PoseEstimate& on_floor, const PosePrior& prior) {
  PoseEstimate estimate = on_floor;
  estimate.pose = leaningAs(prior.pose, on_floor.pose);
  for (int i = 3; i < 6; ++i) {
    if (prior.information(i, i) > 0.0) estimate.covariance(i, i) = 1.0 / prior.information(i, i);
  }
  return estimate;
}

/// Triangulates first with equal confidence, then with less weight for sights whose corners are
/// off. While one is beyond the limit and more than three are left, leaves out the worst.
std::optional<PoseSolution> triangulateRobustly(const MarkerMap& map, const MountedCamera& camera,
                                                const std::vector<MarkerObservation>& observations,
                                                const PosePrior& prior,
                                                const EstimatorConfig& config) {
  constexpr int kRounds = 3;
  const double initial_yaw = prior.pose.yaw;
  std::vector<LandmarkBearing> sights;
  for (const MarkerObservation& observation : observations) {
    const auto sight = sightOf(observation, map, camera, prior, config.reprojection.corner_noise);
    if (!sight) return std::nullopt;
    sights.push_back(*sight);
  }
  PoseSolution solution;
  solution.used.assign(observations.size(), true);
  while (true) {
    std::vector<std::size_t> used;
    for (std::size_t i = 0; i < observations.size(); ++i) {
      if (solution.used[i]) used.push_back(i);
    }
    std::vector<LandmarkBearing> used_sights;
    used_sights.reserve(used.size());
    for (const std::size_t i : used) used_sights.push_back(sights[i]);
    double yaw = initial_yaw;
    for (int round = 0; round < kRounds; ++round) {
      const std::optional<PoseEstimate> estimate = triangulate(used_sights, yaw);
      if (!estimate) return std::nullopt;
      solution.map_from_base = withLean(*estimate, prior);
      const Pose& pose = solution.map_from_base.pose;
      solution.misfits =
          misfitsAt(map, camera, observations, pose, ImagingError::Zero(), config.reprojection);
      yaw = pose.yaw;
      for (std::size_t k = 0; k < used.size(); ++k) {
        const double ratio = solution.misfits[used[k]].deviations / kSharp;
        used_sights[k].weight = 1.0 / (1.0 + ratio * ratio);
      }
    }
    const std::size_t worst =
        *std::max_element(used.begin(), used.end(), [&solution](std::size_t a, std::size_t b) {
          return solution.misfits[a].deviations < solution.misfits[b].deviations;
        });
    if (solution.misfits[worst].deviations <= config.max_misfit) return solution;
    if (used.size() <= 3) return std::nullopt;
    solution.used[worst] = false;
  }
}

/// How badly observations fit a pose. One that agrees well counts much more than one that hardly
/// does: otherwise a pose between two good ones would win with the markers of both.
double misfitOf(const std::vector<Misfit>& misfits) {
  constexpr double kHalf = 0.5;  // standard deviations
  double sum = 0.0;
  for (const Misfit& misfit : misfits) {
    const double ratio = kHalf / misfit.deviations;
    sum += 1.0 / (1.0 + ratio * ratio);
  }
  return sum;
}

/// Which observations agree with a pose, at least a little.
std::vector<bool> agreeing(const std::vector<Misfit>& misfits, const EstimatorConfig& config) {
  std::vector<bool> agree;
  agree.reserve(misfits.size());
  for (const Misfit& misfit : misfits) agree.push_back(misfit.deviations <= config.max_misfit);
  return agree;
}

/// Pairs out of this many observations: all, or an even selection if there are too many.
std::vector<std::array<std::size_t, 2>> pairsOf(std::size_t count) {
  constexpr std::size_t kMost = 30;
  const std::size_t all = count * (count - 1) / 2;
  const std::size_t step = (all + kMost - 1) / kMost;
  std::vector<std::array<std::size_t, 2>> pairs;
  std::size_t number = 0;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = i + 1; j < count; ++j) {
      if (number++ % step == 0) pairs.push_back({i, j});
    }
  }
  return pairs;
}

/// The pose from the pair of observations that the others agree with best, and from those others. A
/// pose between markers in their places and moved ones may fit all of them a little, but two in
/// their places give the right pose. The residuals are those of all observations.
std::optional<ReprojectionFit> refineFromPairs(const MarkerMap& map, const MountedCamera& camera,
                                               const std::vector<MarkerObservation>& observations,
                                               const PosePrior& prior,
                                               const EstimatorConfig& config) {
  // Standard deviations: the pose must fit both of a pair, however far off they are.
  constexpr double kAny = 250.0;
  ReprojectionConfig trusting = config.reprojection;
  trusting.robust_misfit = std::max(kAny, trusting.robust_misfit);
  Pose best;
  std::vector<bool> agree;
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [i, j] : pairsOf(observations.size())) {
    const auto pair = refineByReprojection(map, camera, {observations[i], observations[j]},
                                           prior.pose, prior.withoutPlace(), trusting);
    if (!pair) continue;
    const std::vector<Misfit> misfits =
        misfitsAt(map, camera, observations, pair->map_from_base.pose, pair->imaging_error,
                  config.reprojection);
    const double sum = misfitOf(misfits);
    if (!(sum < least)) continue;
    least = sum;
    best = pair->map_from_base.pose;
    agree = agreeing(misfits, config);
  }
  if (std::count(agree.begin(), agree.end(), true) < 2) return std::nullopt;
  auto fit = refineByReprojection(map, camera, chosen(observations, agree), best, prior,
                                  config.reprojection);
  if (!fit) return std::nullopt;
  fit->misfits = misfitsAt(map, camera, observations, fit->map_from_base.pose, fit->imaging_error,
                           config.reprojection);
  const std::vector<bool> then = agreeing(fit->misfits, config);
  if (std::find(then.begin(), then.end(), false) != then.end()) return fit;
  return refineByReprojection(map, camera, observations, fit->map_from_base.pose, prior,
                              config.reprojection);
}

std::optional<PoseSolution> reproject(const MarkerMap& map, const MountedCamera& camera,
                                      const std::vector<MarkerObservation>& observations,
                                      const PosePrior& prior, const EstimatorConfig& config) {
  std::optional<ReprojectionFit> best;
  const auto keepBetter = [&](std::optional<ReprojectionFit> fit) {
    if (fit && (!best || misfitOf(fit->misfits) < misfitOf(best->misfits))) {
      best = std::move(fit);
    }
  };
  const auto areAllGood = [&] {
    constexpr double kGood = kSharp;
    return best && std::all_of(best->misfits.begin(), best->misfits.end(),
                               [](const Misfit& misfit) { return misfit.deviations <= kGood; });
  };
  if (prior.knows_place) {
    keepBetter(refineFromAfar(map, camera, observations, prior.pose, prior, config.reprojection));
  }
  if (!areAllGood()) {
    const auto triangulated = triangulateRobustly(map, camera, observations, prior, config);
    if (triangulated) {
      keepBetter(refineFromAfar(map, camera, observations, triangulated->map_from_base.pose, prior,
                                config.reprojection));
    }
  }
  if (prior.knows_place && !areAllGood()) {
    // Each marker alone determines where the others should be.
    for (const MarkerObservation& observation : observations) {
      const auto alone =
          refineByReprojection(map, camera, {observation}, prior.pose, prior, config.reprojection);
      if (!alone) continue;
      keepBetter(refineByReprojection(map, camera, observations, alone->map_from_base.pose, prior,
                                      config.reprojection));
    }
  }
  // A pose between markers that were moved as one and the others fits all of them a little, but
  // none to within the corners' noise.
  constexpr double kConflicting = 4.0;  // times the squared residuals of corners
  const bool is_sure =
      best && best->excess < kConflicting &&
      (areAllGood() || isLargeMajority(sharplyAgreeing(best->misfits), observations.size()));
  if (prior.knows_place && observations.size() > 2 && !is_sure) {
    keepBetter(refineFromPairs(map, camera, observations, prior, config));
  }
  if (!best) return std::nullopt;

  const auto standingOn = [&](const std::vector<bool>& used,
                              const Pose& start) -> std::optional<PoseSolution> {
    const auto fit = refineByReprojection(map, camera, chosen(observations, used), start, prior,
                                          config.reprojection);
    if (!fit) return std::nullopt;
    return PoseSolution{fit->map_from_base, fit->imaging_error,
                        misfitsAt(map, camera, observations, fit->map_from_base.pose,
                                  fit->imaging_error, config.reprojection),
                        used, fit->excess};
  };
  const std::vector<bool> used = agreeing(best->misfits, config);
  if (std::count(used.begin(), used.end(), true) == 0) return std::nullopt;
  if (std::count(used.begin(), used.end(), false) == 0) {
    return PoseSolution{best->map_from_base, best->imaging_error, best->misfits, used,
                        best->excess};
  }
  // Outliers are left out altogether, which may bring others back into agreement.
  auto solution = standingOn(used, best->map_from_base.pose);
  if (!solution) return std::nullopt;
  std::vector<bool> more = agreeing(solution->misfits, config);
  std::transform(used.begin(), used.end(), more.begin(), more.begin(), std::logical_or<>());
  if (more == used) return solution;
  auto fuller = standingOn(more, solution->map_from_base.pose);
  // One that pulls the pose off the others does not agree.
  const bool is_better = fuller && misfitOf(fuller->misfits) <= misfitOf(solution->misfits);
  return is_better ? fuller : solution;
}

}  // namespace

bool agreesSharply(const Misfit& misfit) { return misfit.deviations <= kSharp; }

std::size_t sharplyAgreeing(const std::vector<Misfit>& misfits) {
  return static_cast<std::size_t>(std::count_if(misfits.begin(), misfits.end(), agreesSharply));
}

bool isLargeMajority(std::size_t agreeing, std::size_t expected) {
  return 3 * agreeing >= 2 * expected;
}

std::optional<PoseSolution> estimatePose(const MarkerMap& map, const MountedCamera& camera,
                                         const std::vector<MarkerObservation>& observations,
                                         const PosePrior& prior, const EstimatorConfig& config) {
  if (observations.empty()) return std::nullopt;
  constexpr std::size_t kFewestToTriangulate = 3;
  const bool are_enough = observations.size() >= kFewestToTriangulate || !prior.knows_place;
  if (config.kind == EstimatorKind::kTriangulation && are_enough) {
    return triangulateRobustly(map, camera, observations, prior, config);
  }
  return reproject(map, camera, observations, prior, config);
}

}  // namespace omnitag
