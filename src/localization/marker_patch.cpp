#include "omnitag/localization/marker_patch.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace omnitag {

MarkerPatch::MarkerPatch(const cv::Mat& panorama, const Marker& marker, const TagPattern& pattern,
                         const MountedCamera& camera, const Pose2& map_from_base, double blur)
    : panorama_(panorama),
      pattern_(pattern),
      marker_from_map_(marker.map_from_marker.inverse()),
      modules_per_metre_(pattern.widthBetweenCorners() / marker.size),
      blur_variance_(blur * blur) {
  const Eigen::Vector2d low_limit(1.0, 1.0);
  const Eigen::Vector2d high_limit(panorama.cols - 2.0, panorama.rows - 2.0);
  Eigen::Vector2d low = high_limit;
  Eigen::Vector2d high = low_limit;
  const double with_border = 1.0 * pattern.width() / pattern.widthBetweenCorners();
  for (const Eigen::Vector3d& corner : marker.corners()) {
    const Eigen::Vector3d outer = marker.center() + with_border * (corner - marker.center());
    const auto pixel = camera.pixelFromMap(map_from_base, outer);
    if (!pixel) continue;
    low = low.cwiseMin(*pixel);
    high = high.cwiseMax(*pixel);
  }
  low = low.cwiseMax(low_limit);
  high = high.cwiseMin(high_limit);
  left_ = static_cast<int>(low.x()) - 1;
  top_ = static_cast<int>(low.y()) - 1;
  columns_ = std::max(0, static_cast<int>(high.x()) + 2 - left_);
  rows_ = std::max(0, static_cast<int>(high.y()) + 2 - top_);
  rays_.reserve(indexOf(0, rows_));
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      rays_.push_back(camera.rayInBase({left_ + column, top_ + row}));
    }
  }
}

std::vector<MarkerPixel> MarkerPatch::pixels(const Pose2& map_from_base) const {
  const Eigen::Matrix3d map_from_base_rotation = map_from_base.toIsometry().linear();
  const Eigen::Vector3d base_in_map(map_from_base.x, map_from_base.y, 0.0);
  std::vector<std::optional<Meeting>> meetings;
  meetings.reserve(rays_.size());
  for (const std::optional<Ray>& ray : rays_) {
    meetings.push_back(
        ray ? meet({map_from_base_rotation * ray->origin, map_from_base_rotation * ray->direction},
                   base_in_map)
            : std::nullopt);
  }
  std::vector<MarkerPixel> pixels;
  for (int row = 1; row + 1 < rows_; ++row) {
    for (int column = 1; column + 1 < columns_; ++column) {
      const std::size_t here = indexOf(column, row);
      const auto& left = meetings[here - 1];
      const auto& right = meetings[here + 1];
      const auto& above = meetings[here - static_cast<std::size_t>(columns_)];
      const auto& below = meetings[here + static_cast<std::size_t>(columns_)];
      if (!meetings[here] || !left || !right || !above || !below) continue;
      const std::optional<MarkerPixel> pixel =
          predict(*meetings[here], 0.5 * (right->position - left->position),
                  0.5 * (below->position - above->position));
      if (!pixel) continue;
      pixels.push_back(*pixel);
      pixels.back().grey = panorama_.at<std::uint8_t>(top_ + row, left_ + column);
    }
  }
  return pixels;
}

std::optional<MarkerPatch::Meeting> MarkerPatch::meet(const Ray& ray,
                                                      const Eigen::Vector3d& base_in_map) const {
  const Eigen::Matrix3d& rotation = marker_from_map_.linear();
  const Eigen::Vector3d origin = marker_from_map_ * (ray.origin + base_in_map);
  const Eigen::Vector3d direction = rotation * ray.direction;
  if (origin.z() <= 0.0 || direction.z() >= 0.0) return std::nullopt;
  const double slope_x = direction.x() / direction.z();
  const double slope_y = direction.y() / direction.z();
  const double x = origin.x() - origin.z() * slope_x;
  const double y = origin.y() - origin.z() * slope_y;

  // Turning the robot turns origin and direction about the z axis of base_link.
  const Eigen::Vector3d origin_by_yaw =
      rotation * Eigen::Vector3d(-ray.origin.y(), ray.origin.x(), 0.0);
  const Eigen::Vector3d direction_by_yaw =
      rotation * Eigen::Vector3d(-ray.direction.y(), ray.direction.x(), 0.0);
  Eigen::Matrix3d origin_by_pose;
  origin_by_pose << rotation.leftCols<2>(), origin_by_yaw;
  const double range = -origin.z() / direction.z();
  const double half = 0.5 * pattern_.width();
  Meeting meeting;
  meeting.position = {half + modules_per_metre_ * x, half - modules_per_metre_ * y};
  meeting.by_pose.row(0) = origin_by_pose.row(0) - slope_x * origin_by_pose.row(2);
  meeting.by_pose.row(1) = origin_by_pose.row(1) - slope_y * origin_by_pose.row(2);
  meeting.by_pose(0, 2) += range * (direction_by_yaw.x() - slope_x * direction_by_yaw.z());
  meeting.by_pose(1, 2) += range * (direction_by_yaw.y() - slope_y * direction_by_yaw.z());
  meeting.by_pose.row(0) *= modules_per_metre_;
  meeting.by_pose.row(1) *= -modules_per_metre_;
  return meeting;
}

std::optional<MarkerPixel> MarkerPatch::predict(const Meeting& meeting, Eigen::Vector2d side_u,
                                                Eigen::Vector2d side_v) const {
  // A Gaussian blur and a box have the same variance where the box is sqrt(12) deviations wide.
  const double stretch = std::sqrt(1.0 + 12.0 * blur_variance_);
  side_u *= stretch;
  side_v *= stretch;
  const Eigen::Vector2d reach = 0.5 * (side_u.cwiseAbs() + side_v.cwiseAbs());
  const double width = pattern_.width();
  if ((meeting.position - reach).minCoeff() < 0.0 ||
      (meeting.position + reach).maxCoeff() > width) {
    return std::nullopt;
  }
  constexpr int kParts = 2;
  const Eigen::Vector2d size = (side_u.cwiseAbs2() + side_v.cwiseAbs2()).cwiseSqrt() / kParts;
  MarkerPixel pixel;
  Eigen::Vector2d by_position = Eigen::Vector2d::Zero();
  for (const double i : {-0.25, 0.25}) {
    for (const double j : {-0.25, 0.25}) {
      const TagPattern::White white =
          pattern_.average(meeting.position + i * side_u + j * side_v, size);
      pixel.white += white.share / (kParts * kParts);
      by_position += white.by_position / (kParts * kParts);
    }
  }
  pixel.position = meeting.position / width - Eigen::Vector2d(0.5, 0.5);
  pixel.white_by_pose = by_position.transpose() * meeting.by_pose;
  pixel.gradient = std::hypot(by_position.dot(side_u), by_position.dot(side_v));
  return pixel;
}

}  // namespace omnitag
