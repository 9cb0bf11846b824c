#include "omnitag/localization/relocalization.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pose_hypotheses.h"

namespace omnitag {
namespace {

/// Whether the better of two leaves the other one possible.
bool isRival(const PoseHypothesis& best, const PoseHypothesis& other, double min_lead) {
  for (std::size_t i = 0; i < best.entries.size(); ++i) {
    if (best.entries[i].has_value() != other.entries[i].has_value()) {
      return other.saturated_cost - best.saturated_cost < min_lead;
    }
  }
  return other.cost - best.cost < min_lead;
}

/// The best hypothesis; nothing, and the reason in words, where there is none or more than one.
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

/// The covariance that corners leave. Nothing but they tell, and few of them hardly tell how good
/// they are.
Eigen::Matrix3d covarianceOf(const PoseHypothesis& hypothesis,
                             const RelocalizationProblem& problem) {
  const double rise = problem.config.corner_noise / problem.reprojection.corner_noise;
  return std::max(rise * rise, varianceFactor(hypothesis.fit)) *
         hypothesis.fit.map_from_base.covariance;
}

/// The covariance of a pose that stands on one marker. Along the way around a marker that is seen
/// from its front, the corners hardly change, and by no means as a straight line: how far the
/// robot may be off along the least certain direction is found by going there.
Eigen::Matrix3d spread(const PoseHypothesis& hypothesis, const RelocalizationProblem& problem) {
  constexpr double kDeviations = 3.0;
  constexpr double kFirstStep = 0.5;  // deviations
  constexpr double kFarthest = 5.0;   // m
  constexpr int kMaxSteps = 60;
  std::size_t reading = 0;
  while (!hypothesis.entries[reading]) ++reading;
  const MarkerObservation observation = problem.observation(reading, *hypothesis.entries[reading]);
  const double rise = problem.config.corner_noise / problem.reprojection.corner_noise;
  const Eigen::Matrix3d covariance = rise * rise * hypothesis.fit.map_from_base.covariance;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(covariance);
  const Eigen::Vector3d axis = eigen.eigenvectors().col(2);
  const double deviation = std::sqrt(eigen.eigenvalues()(2));

  double reach = kDeviations * deviation;
  for (const double side : {-1.0, 1.0}) {
    Pose2 pose = hypothesis.fit.map_from_base.pose;
    double offset = 0.0;
    for (int step = 0; step < kMaxSteps && offset < kFarthest; ++step) {
      offset += kFirstStep * deviation;
      const Eigen::Vector3d shift = side * offset * axis;
      const Pose2& optimum = hypothesis.fit.map_from_base.pose;
      PoseEstimate pinned;
      pinned.pose = {optimum.x + shift.x(), optimum.y + shift.y(), optimum.yaw + shift.z()};
      constexpr double kFree = 1e4;
      constexpr double kPinned = 1e-10;
      pinned.covariance =
          kFree * Eigen::Matrix3d::Identity() + (kPinned - kFree) * axis * axis.transpose();
      const auto fit = refineByReprojection(problem.map, problem.camera, {observation}, pose,
                                            pinned, problem.reprojection);
      if (!fit) break;
      pose = fit->map_from_base.pose;
      if (costOf(fit->residuals[0], problem.config) - hypothesis.cost >
          0.5 * kDeviations * kDeviations)
        break;
      reach = std::max(reach, offset);
    }
  }
  const double stretched = reach / kDeviations;
  return covariance + (stretched * stretched - deviation * deviation) * axis * axis.transpose();
}

Relocalization explained(const PoseHypothesis& hypothesis, const Eigen::Matrix3d& covariance) {
  return {PoseEstimate{hypothesis.fit.map_from_base.pose, covariance}, "", hypothesis.entries,
          hypothesis.residuals};
}

Relocalization unexplained(std::size_t readings, std::string reason) {
  return {std::nullopt, std::move(reason), std::vector<std::optional<std::size_t>>(readings),
          std::vector<double>(readings, std::numeric_limits<double>::quiet_NaN())};
}

}  // namespace

Relocalization relocalize(const MarkerMap& map, const MountedCamera& camera,
                          const std::vector<MarkerReading>& readings,
                          const ReprojectionConfig& reprojection, double max_residual,
                          const RelocalizationConfig& config) {
  const RelocalizationProblem problem{
      map, camera, readings, reprojection, max_residual, config, candidatesOf(readings, map)};
  std::string reason;
  const std::optional<PoseHypothesis> best = likeliest(problem, &reason);
  if (!best) return unexplained(readings.size(), std::move(reason));
  if (best->explained > 1) return explained(*best, covarianceOf(*best, problem));
  const Eigen::Matrix3d covariance = spread(*best, problem);
  if (covariance.topLeftCorner<2, 2>().trace() >
      config.max_deviation_of_one * config.max_deviation_of_one) {
    return unexplained(readings.size(), "the only marker that was read leaves the pose uncertain");
  }
  return explained(*best, covariance);
}

std::vector<Relocalization> roughPoses(const MarkerMap& map, const MountedCamera& camera,
                                       const std::vector<MarkerReading>& readings,
                                       const ReprojectionConfig& reprojection, double max_residual,
                                       const RelocalizationConfig& config) {
  // What others are to confirm need not be believable alone.
  RelocalizationConfig trusting = config;
  trusting.max_residual_of_one = max_residual;
  trusting.max_hamming_of_one = std::numeric_limits<int>::max();
  const RelocalizationProblem problem{
      map, camera, readings, reprojection, max_residual, trusting, candidatesOf(readings, map)};
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
    poses.push_back(explained(hypothesis, covarianceOf(hypothesis, problem)));
  }
  return poses;
}

}  // namespace omnitag
