#include "localization/marker_in_camera.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "common/rotation.h"
#include "localization/marker_pose.h"

namespace omnitag {
namespace {

/// b_from_a of an estimate of a_from_b. If that errs by a translation t along a's axes and a
/// rotation r about b's own, the inverse (R, p) errs by p x r - R t along b's axes and by -R^T r
/// about a's own.
PoseEstimate inverseOf(const PoseEstimate& estimate) {
  const Eigen::Isometry3d inverse = estimate.pose.toIsometry().inverse();
  const Eigen::Matrix3d rotation = inverse.linear();
  PoseMatrix by_error;
  for (int i = 0; i < 6; ++i) {
    const PoseVector unit = PoseVector::Unit(i);
    const Eigen::Vector3d t = translationPart(unit);
    const Eigen::Vector3d r = rotationPart(unit);
    by_error.col(i) = poseVector(crossMatrix(inverse.translation()) * r - rotation * t,
                                 -rotation.transpose() * r);
  }
  return {Pose::fromIsometry(inverse), by_error * estimate.covariance * by_error.transpose(),
          by_error * estimate.shared * by_error.transpose()};
}

double angleBetween(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return Eigen::AngleAxisd(a.transpose() * b).angle();
}

}  // namespace

double sizeOf(const MarkerDetection& detection, const MarkerMap& map) {
  if (detection.map_entry) return map.markers[*detection.map_entry].size;
  const std::vector<std::size_t> entries = entriesOf(map, detection.family, detection.id);
  return entries.empty() ? map.default_size : map.markers[entries.front()].size;
}

std::optional<PoseEstimate> markerInCamera(std::shared_ptr<const CameraModel> camera,
                                           const MarkerDetection& detection, double size,
                                           const std::optional<Eigen::Isometry3d>& expected,
                                           const EstimatorConfig& config) {
  // To the solver, the marker is the map and the camera the robot.
  MarkerMap alone;
  Marker marker;
  marker.family = detection.family;
  marker.id = detection.id;
  marker.size = size;
  alone.markers.push_back(marker);
  const MountedCamera robot(std::move(camera), Eigen::Isometry3d::Identity());
  const std::vector<ReprojectionFit> fits =
      posesFromMarker(alone, robot, {0, detection.corners, detection.center}, {}, config);
  if (fits.empty()) return std::nullopt;
  auto best = fits.begin();
  if (expected) {
    const Eigen::Matrix3d turned = expected->linear().transpose();
    best = std::min_element(fits.begin(), fits.end(), [&](const auto& a, const auto& b) {
      return angleBetween(a.map_from_base.pose.toIsometry().linear(), turned) <
             angleBetween(b.map_from_base.pose.toIsometry().linear(), turned);
    });
  }
  return inverseOf(best->map_from_base);
}

}  // namespace omnitag
