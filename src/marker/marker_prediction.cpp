#include "marker/marker_prediction.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "common/yaml_reader.h"

namespace omnitag {
namespace {

/// The widest white border of the library's families, as a share of the size: tagCircle21h7 has one
/// module on each side of the five between its corners.
constexpr double kQuietZone = 0.2;

std::optional<PredictedMarker> predict(const Marker& marker, const MountedCamera& camera,
                                       const PoseEstimate& map_from_base,
                                       const Eigen::Vector3d& viewpoint,
                                       const VisibilityConfig& config) {
  const Eigen::Vector3d to_camera = viewpoint - marker.center();
  PredictedMarker predicted;
  predicted.range = to_camera.norm();
  if (predicted.range > config.max_range) return std::nullopt;
  predicted.incidence =
      std::atan2(marker.normal().cross(to_camera).norm(), marker.normal().dot(to_camera));
  if (predicted.incidence > config.max_incidence) return std::nullopt;

  const bool is_certain = map_from_base.covariance.isZero(0.0);
  const Eigen::Isometry3d isometry = map_from_base.pose.toIsometry();
  FrameJacobian center_by_frame;
  Eigen::Matrix<double, 2, 3> center_by_point;
  const auto center =
      camera.pixelFromMap(isometry, marker.center(), &center_by_frame, &center_by_point);
  if (!center) return std::nullopt;
  predicted.center = *center;
  const Corners<Eigen::Vector3d> corners = marker.corners();
  double shape_variance = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    FrameJacobian by_frame;
    const auto pixel = camera.pixelFromMap(isometry, corners[i], is_certain ? nullptr : &by_frame);
    if (!pixel) return std::nullopt;
    predicted.corners[i] = *pixel;
    if (is_certain) continue;
    const Eigen::Matrix<double, 2, 6> apart = (by_frame - center_by_frame).leftCols<6>();
    shape_variance += (apart * map_from_base.covariance * apart.transpose()).trace() / 8.0;
  }
  predicted.shape_deviation = std::sqrt(std::max(0.0, shape_variance));
  if (longestEdge(predicted.corners) < config.min_edge_pixels) return std::nullopt;

  const auto center_by_pose = center_by_frame.leftCols<6>();
  const auto center_by_error = center_by_frame.rightCols<kImagingUnknowns>();
  const Eigen::Matrix2d covariance =
      center_by_pose * map_from_base.covariance * center_by_pose.transpose() +
      marker.deviation * marker.deviation * center_by_point * center_by_point.transpose() +
      center_by_error * center_by_error.transpose();
  const Eigen::Vector2d from_axis = predicted.center - camera.model().imagePlane().principalPoint();
  // On the axis any direction will do.
  const Eigen::Vector2d radial =
      from_axis.norm() > 0.0 ? from_axis.normalized() : Eigen::Vector2d::UnitX();
  const Eigen::Vector2d tangential(-radial.y(), radial.x());
  const auto margin = [&covariance, &config](const Eigen::Vector2d& direction) {
    const double variance = std::max(0.0, direction.dot(covariance * direction));
    return std::max(config.min_margin_pixels, config.margin_deviations * std::sqrt(variance));
  };
  predicted.tangential_margin = margin(tangential);
  predicted.radial_margin = margin(radial);
  return predicted;
}

/// A corner moved outward, at least to the end of the marker's white border.
Eigen::Vector2d withBorder(const Eigen::Vector2d& corner, const PredictedMarker& marker) {
  return corner + 2.0 * kQuietZone * (corner - marker.center);
}

double angleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// The marker with its border and margins, if these come near the optical axis.
std::optional<ViewCone> coneNearAxis(const PredictedMarker& marker, const CameraModel& camera) {
  const auto directionOf = [&](const Eigen::Vector2d& pixel) -> std::optional<Eigen::Vector3d> {
    const std::optional<Ray> ray = camera.rayFromPixel(pixel);
    if (!ray) return std::nullopt;
    return (ray->origin + marker.range * ray->direction).normalized();
  };
  const auto center = directionOf(marker.center);
  if (!center) return std::nullopt;
  ViewCone cone;
  cone.direction = *center;
  for (const Eigen::Vector2d& corner : marker.corners) {
    auto direction = directionOf(withBorder(corner, marker));
    if (!direction) direction = directionOf(corner);
    if (!direction) return std::nullopt;
    const double angle = angleBetween(*center, *direction);
    cone.half_angle = std::max(cone.half_angle, angle);
    cone.resolution =
        std::max(cone.resolution, (withBorder(corner, marker) - marker.center).norm() / angle);
  }
  // A displacement along the tangent does not bring it nearer to the axis.
  const double off_axis = std::acos(std::min(1.0, std::abs(center->z())));
  const double nearest = off_axis - cone.half_angle - marker.radial_margin / cone.resolution;
  if (!(nearest < kNearAxis)) return std::nullopt;
  cone.half_angle += std::max(marker.tangential_margin, marker.radial_margin) / cone.resolution;
  return cone;
}

}  // namespace

double longestEdge(const Corners<Eigen::Vector2d>& corners) {
  double longest = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    longest = std::max(longest, (corners[(i + 1) % corners.size()] - corners[i]).norm());
  }
  return longest;
}

VisibilityConfig readVisibilityConfig(const YamlReader& reader) {
  reader.allowOnly({"max_range", "max_incidence", "min_edge_pixels", "min_decodable_edge_pixels",
                    "margin_deviations", "min_margin_pixels"});
  VisibilityConfig config;
  reader.read("max_range", &config.max_range, kPositive);
  reader.read("max_incidence", &config.max_incidence, {0.0, 0.5 * kPi});
  reader.read("min_edge_pixels", &config.min_edge_pixels, kNonNegative);
  reader.read("min_decodable_edge_pixels", &config.min_decodable_edge_pixels, kNonNegative);
  reader.read("margin_deviations", &config.margin_deviations, kPositive);
  reader.read("min_margin_pixels", &config.min_margin_pixels, kNonNegative);
  return config;
}

std::vector<PredictedMarker> predictMarkers(const MarkerMap& map, const MountedCamera& camera,
                                            const PoseEstimate& map_from_base,
                                            const VisibilityConfig& config) {
  return predictMarkers(map, MarkerIndex(map), camera, map_from_base, config);
}

std::vector<PredictedMarker> predictMarkers(const MarkerMap& map, const MarkerIndex& index,
                                            const MountedCamera& camera,
                                            const PoseEstimate& map_from_base,
                                            const VisibilityConfig& config) {
  const Eigen::Vector3d viewpoint = camera.mapFromCamera(map_from_base.pose).translation();
  std::vector<PredictedMarker> predicted;
  for (const std::size_t entry : index.within(config.max_range, viewpoint)) {
    auto marker = predict(map.markers[entry], camera, map_from_base, viewpoint, config);
    if (!marker) continue;
    marker->map_entry = entry;
    predicted.push_back(*marker);
  }
  return predicted;
}

std::optional<PredictedMarker> predictMarker(const MarkerMap& map, std::size_t entry,
                                             const MountedCamera& camera,
                                             const PoseEstimate& map_from_base,
                                             const VisibilityConfig& config) {
  const Eigen::Vector3d viewpoint = camera.mapFromCamera(map_from_base.pose).translation();
  auto marker = predict(map.markers[entry], camera, map_from_base, viewpoint, config);
  if (marker) marker->map_entry = entry;
  return marker;
}

ViewTarget viewTarget(const PredictedMarker& marker, const CameraModel& camera) {
  const ImagePlane& plane = camera.imagePlane();
  const auto polar = [&plane](const Eigen::Vector2d& pixel) {
    const Eigen::Vector2d ideal = plane.idealFromPixel(pixel).value_or(Eigen::Vector2d::Zero());
    return Eigen::Vector2d(std::atan2(ideal.y(), ideal.x()), ideal.norm());
  };
  const Eigen::Vector2d center = polar(marker.center);
  double min_offset = 0.0;
  double max_offset = 0.0;
  ViewTarget target;
  target.min_radius = target.max_radius = center.y();
  for (const Eigen::Vector2d& corner : marker.corners) {
    const Eigen::Vector2d with_border = polar(withBorder(corner, marker));
    const double offset = normalizeAngle(with_border.x() - center.x());
    min_offset = std::min(min_offset, offset);
    max_offset = std::max(max_offset, offset);
    target.min_radius = std::min(target.min_radius, with_border.y());
    target.max_radius = std::max(target.max_radius, with_border.y());
  }
  const double scale = plane.scale();
  target.azimuth = normalizeAngle(center.x() + 0.5 * (min_offset + max_offset));
  target.half_width =
      0.5 * (max_offset - min_offset) + marker.tangential_margin / (scale * center.y());
  target.min_radius =
      std::max(camera.minRadius(), target.min_radius - marker.radial_margin / scale);
  target.max_radius =
      std::min(camera.maxRadius(), target.max_radius + marker.radial_margin / scale);
  target.distance = marker.range;
  target.cone = coneNearAxis(marker, camera);
  return target;
}

}  // namespace omnitag
