#include "localization/measured_pose.h"

#include <vector>

#include "localization/frame_search.h"
#include "localization/motion_model.h"

namespace omnitag {
namespace {

/// A prior that says how the robot may stand, and next to nothing else.
PosePrior weakPrior(const Pose& about, const Frame& frame, const LocalizerConfig& config) {
  constexpr double kOpen = 100.0;  // m and rad
  const Eigen::Matrix3d nothing = Eigen::Matrix3d::Zero();
  // A new motion model has learned nothing from earlier images.
  PosePrior prior = MotionModel(config.motion).standing(frame.odom_from_base);
  const bool stands = prior.knowsStanding();
  prior = prior.withPlace(about, nothing);
  if (!stands) prior.pose = about;
  prior.information += PoseMatrix::Identity() / (kOpen * kOpen);
  return prior;
}

/// Whether a pose from a single marker is the wrong one of the two from which it looks almost the
/// same.
bool isMirrored(const TrackingTools& tools, const MountedCamera& camera,
                const std::vector<std::size_t>& entries, const Pose& start, const Pose& measured) {
  if (entries.size() > 1) return false;
  const auto other = otherPose(tools, tools.map.markers[entries.front()], camera, start);
  return other && difference(measured, *other).norm() < difference(measured, start).norm();
}

std::optional<PoseEstimate> poseOfPixels(const TrackingTools& tools, const Frame& frame,
                                         const MountedCamera& camera,
                                         const std::vector<std::size_t>& entries, const Pose& start,
                                         const PosePrior& prior) {
  const EstimatorConfig& config = tools.config.estimation;
  if (config.kind != EstimatorKind::kPhotometric) return std::nullopt;
  const auto aligned =
      refinePhotometrically(frame.image, tools.map, camera, tools.patterns, entries, start, prior,
                            config.photometric, tools.config.threads, tools.lasting_excess);
  return aligned ? std::optional(aligned->map_from_base) : std::nullopt;
}

std::optional<PoseEstimate> poseOfCorners(const TrackingTools& tools, const MountedCamera& camera,
                                          const FrameResult& result, const PosePrior& prior) {
  const std::vector<MarkerObservation> observations = acceptedObservations(result);
  const auto solution =
      estimatePose(tools.map, camera, observations, prior, tools.config.estimation);
  if (!solution) return std::nullopt;
  return standingOnCorners(solution->map_from_base, observations.size(), tools.config);
}

}  // namespace

std::optional<PoseEstimate> measuredPose(const TrackingTools& tools, const Frame& frame,
                                         const MountedCamera& camera, const FrameResult& result) {
  const std::vector<std::size_t> entries = acceptedEntries(result);
  if (!result.map_from_base || entries.empty()) return std::nullopt;
  const Pose& start = result.map_from_base->pose;
  const PosePrior prior = weakPrior(start, frame, tools.config);
  const MountedCamera blurred = camera.withBlur(result.blur);
  auto measured = poseOfPixels(tools, frame, blurred, entries, start, prior);
  if (!measured) measured = poseOfCorners(tools, blurred, result, prior);
  const bool is_right = measured && !isMirrored(tools, blurred, entries, start, measured->pose);
  return is_right ? measured : std::nullopt;
}

}  // namespace omnitag
