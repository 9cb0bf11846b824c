#include "localization/relocalization.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/symmetric_matrix.h"
#include "localization/pose_hypotheses.h"

namespace omnitag {
namespace {

/// Whether the other hypothesis remains possible besides the best one.
bool isRival(const PoseHypothesis& best, const PoseHypothesis& other, double min_lead) {
  for (std::size_t i = 0; i < best.entries.size(); ++i) {
    if (best.entries[i].has_value() != other.entries[i].has_value()) {
      return other.saturated_cost - best.saturated_cost < min_lead &&
             !agree(best.fit.map_from_base, other.fit.map_from_base);
    }
  }
  return other.cost - best.cost < min_lead;
}

/// The best hypothesis; nothing, and the reason in words, if there is none or more than one.
std::optional<PoseHypothesis> likeliest(const RelocalizationProblem& problem, std::string* reason) {
  const bool is_any_mapped = std::any_of(problem.candidates.begin(), problem.candidates.end(),
                                         [](const auto& entries) { return !entries.empty(); });
  if (!is_any_mapped) {
    *reason = "no marker of the map was read";
    return std::nullopt;
  }
  std::vector<PoseHypothesis> all = poseHypotheses(problem);
  if (all.empty()) {
    *reason = "no pose explains what was read";
    return std::nullopt;
  }
  const auto rivals = std::count_if(all.begin() + 1, all.end(), [&](const PoseHypothesis& other) {
    return isRival(all.front(), other, problem.config.min_lead);
  });
  if (rivals > 0) {
    *reason = std::to_string(rivals + 1) + " poses explain what was read about equally well";
    return std::nullopt;
  }
  return std::move(all.front());
}

/// A few markers hardly show how good their corners are: they are assumed to be poor, or several
/// times poorer.
ReprojectionConfig poorCorners(const RelocalizationProblem& problem, double times) {
  ReprojectionConfig config = problem.estimation.reprojection;
  config.corner_noise = std::max(config.corner_noise, times * config.poor_corner_noise);
  return config;
}

/// How many times poorer than poor the corners of a single marker may be without being noticed. On
/// a floor, their misfit shows it. A free pose, with six numbers, absorbs nearly all errors of the
/// eight coordinates: the corners may then be as poor as the largest accepted misfit allows.
double unnoticed(const RelocalizationProblem& problem) {
  return problem.standing.knowsStanding() ? 1.0 : std::max(1.0, problem.config.max_misfit_of_one);
}

/// The pose of a hypothesis by corners alone, several times poorer than poor ones.
PoseEstimate poseOf(const PoseHypothesis& hypothesis, const RelocalizationProblem& problem,
                    double times = 1.0) {
  std::vector<MarkerObservation> observations;
  for (std::size_t i = 0; i < hypothesis.entries.size(); ++i) {
    if (!hypothesis.entries[i]) continue;
    observations.push_back(problem.observation(i, *hypothesis.entries[i]));
  }
  const PoseEstimate& found = hypothesis.fit.map_from_base;
  const auto fit = refineByReprojection(problem.map, problem.camera, observations, found.pose,
                                        problem.standing, poorCorners(problem, times));
  return fit ? PoseEstimate{found.pose, fit->map_from_base.covariance, fit->map_from_base.shared}
             : found;
}

/// The pose from one marker. As the robot moves around a marker that it sees from the front, the
/// corners hardly change, and the path is far from straight: following it shows how far the robot
/// may be off along the least certain direction on the floor.
PoseEstimate spread(const PoseHypothesis& hypothesis, const RelocalizationProblem& problem) {
  constexpr double kDeviations = 3.0;
  constexpr double kFirstStep = 0.5;  // deviations
  constexpr double kFarthest = 5.0;   // m
  constexpr int kMaxSteps = 60;
  std::size_t reading = 0;
  while (!hypothesis.entries[reading]) ++reading;
  const MarkerObservation observation = problem.observation(reading, *hypothesis.entries[reading]);
  const double times = unnoticed(problem);
  PoseEstimate estimate = poseOf(hypothesis, problem, times);
  const EigenPairs spread = eigenPairs(floorCovariance(estimate));
  const Eigen::Vector3d axis = spread.vectors.col(2);
  const double deviation = std::sqrt(spread.values(2));

  double reach = kDeviations * deviation;
  for (const double side : {-1.0, 1.0}) {
    Pose pose = estimate.pose;
    double offset = 0.0;
    for (int step = 0; step < kMaxSteps && offset < kFarthest; ++step) {
      offset += kFirstStep * deviation;
      PoseVector shift = PoseVector::Zero();
      shift.head<3>() = side * offset * axis;
      constexpr double kPinned = 1e10;
      const PosePrior pinned = problem.standing.withPlace(moved(estimate.pose, shift),
                                                          kPinned * axis * axis.transpose());
      const auto fit = refineByReprojection(problem.map, problem.camera, {observation}, pose,
                                            pinned, problem.estimation.reprojection);
      if (!fit) break;
      pose = fit->map_from_base.pose;
      const double most = kDeviations * times;
      if (costOf(fit->misfits[0]) - hypothesis.cost > 0.5 * most * most) break;
      reach = std::max(reach, offset);
    }
  }
  const double stretched = reach / kDeviations;
  estimate.covariance.topLeftCorner<3, 3>() +=
      (stretched * stretched - deviation * deviation) * axis * axis.transpose();
  return estimate;
}

Relocalization explained(const PoseHypothesis& hypothesis, const PoseEstimate& pose) {
  return {pose, "", hypothesis.fit.imaging_error, hypothesis.entries, hypothesis.misfits};
}

Relocalization unexplained(std::size_t readings, std::string reason) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  return {std::nullopt, std::move(reason), ImagingError::Zero(),
          std::vector<std::optional<std::size_t>>(readings),
          std::vector<Misfit>(readings, {kNaN, kNaN})};
}

}  // namespace

Relocalization relocalize(const MarkerMap& map, const MountedCamera& camera,
                          const std::vector<MarkerReading>& readings, const PosePrior& standing,
                          const EstimatorConfig& estimation, const RelocalizationConfig& config) {
  const RelocalizationProblem problem{
      map, camera, readings, standing, estimation, config, candidatesOf(readings, map)};
  std::string reason;
  const std::optional<PoseHypothesis> best = likeliest(problem, &reason);
  if (!best) return unexplained(readings.size(), std::move(reason));
  if (best->explained > 1) return explained(*best, poseOf(*best, problem));
  const PoseEstimate alone = spread(*best, problem);
  const double height_deviation = std::sqrt(alone.covariance(3, 3));
  if (std::hypot(positionDeviation(alone), height_deviation) > config.max_deviation_of_one) {
    return unexplained(readings.size(), "the only marker that was read leaves the pose uncertain");
  }
  return explained(*best, alone);
}

std::vector<Relocalization> roughPoses(const MarkerMap& map, const MountedCamera& camera,
                                       const std::vector<MarkerReading>& readings,
                                       const PosePrior& standing, const EstimatorConfig& estimation,
                                       const RelocalizationConfig& config) {
  // A pose that other markers have to confirm need not be believable by itself.
  RelocalizationConfig trusting = config;
  trusting.max_misfit_of_one = estimation.max_misfit;
  trusting.max_hamming_of_one = std::numeric_limits<int>::max();
  const RelocalizationProblem problem{
      map, camera, readings, standing, estimation, trusting, candidatesOf(readings, map)};
  std::size_t mapped = 0;
  std::size_t candidates = 0;
  for (const std::vector<std::size_t>& entries : problem.candidates) {
    if (!entries.empty()) ++mapped;
    candidates += entries.size();
  }
  std::vector<PoseHypothesis> hypotheses;
  if (mapped == 1) {
    if (candidates > 1) return {};
    hypotheses = poseHypotheses(problem);
  } else if (std::string reason; auto best = likeliest(problem, &reason)) {
    hypotheses.push_back(std::move(*best));
  }
  std::vector<Relocalization> poses;
  poses.reserve(hypotheses.size());
  for (const PoseHypothesis& hypothesis : hypotheses) {
    poses.push_back(explained(hypothesis, poseOf(hypothesis, problem)));
  }
  return poses;
}

}  // namespace omnitag
