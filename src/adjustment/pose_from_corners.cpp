#include "adjustment/pose_from_corners.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "localization/marker_pose.h"
#include "localization/reprojection.h"

namespace omnitag {
namespace {

/// Pixels: how far a guessed camera displaces the corners of one marker relative to one another.
constexpr double kGuessed = 3.0;

/// Mean over the markers of how far their corners are off (pixels); infinity if one is not visible
/// from the pose.
double meanResidual(const std::vector<Misfit>& misfits) {
  double sum = 0.0;
  for (const Misfit& misfit : misfits) sum += misfit.residual;
  return sum / static_cast<double>(misfits.size());
}

}  // namespace

std::optional<Pose> poseFromCorners(const MarkerMap& map, const MountedCamera& camera,
                                    const CalibrationFrame& frame) {
  EstimatorConfig config;
  config.reprojection.corner_noise = config.reprojection.poor_corner_noise = kGuessed;
  std::optional<Pose> best;
  double least = std::numeric_limits<double>::infinity();
  for (const MarkerObservation& observation : frame.observations) {
    for (const ReprojectionFit& of_one : posesFromMarker(map, camera, observation, {}, config)) {
      const Pose& start = of_one.map_from_base.pose;
      const auto of_all =
          refineFromAfar(map, camera, frame.observations, start, {}, config.reprojection);
      if (!of_all) continue;
      const double residual = meanResidual(of_all->misfits);
      if (residual >= least) continue;
      least = residual;
      best = of_all->map_from_base.pose;
    }
    // A few tags of a board are enough for a start.
    if (least < kGuessed) break;
  }
  constexpr double kFar = 20.0;  // pixels
  return least < kFar ? best : std::nullopt;
}

}  // namespace omnitag
