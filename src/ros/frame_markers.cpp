#include "ros/frame_markers.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "common/symmetric_matrix.h"
#include "omnitag/common/angle.h"
#include "ros/conversions.h"
#include "ros/rviz_marker.h"

namespace omnitag {
namespace {

using RvizMarker = visualization_msgs::Marker;
using RvizMarkers = std::vector<RvizMarker>;

/// m: length of the line to a rejected marker of unknown range.
constexpr double kUnknownRange = 2.0;
constexpr double kTextHeight = 0.2;

RvizMarker lines(const std::string& frame, const std::string& name_space, double width,
                 const std_msgs::ColorRGBA& color) {
  RvizMarker marker = rvizMarker(frame, name_space, RvizMarker::LINE_LIST, color);
  marker.scale.x = width;
  return marker;
}

RvizMarker text(const std::string& frame, const std::string& name_space,
                const Eigen::Vector3d& position, const std::string& words,
                const std_msgs::ColorRGBA& color) {
  RvizMarker marker = rvizMarker(frame, name_space, RvizMarker::TEXT_VIEW_FACING, color);
  marker.pose.position = toMessage(position);
  marker.scale.z = kTextHeight;
  marker.text = words;
  return marker;
}

/// The end of a detection's line of sight: along the measured bearing, at the map entry's range
/// and height.
Eigen::Vector3d endOfSight(const MarkerDetection& detection, const MarkerMap& map, const Pose& pose,
                           const Eigen::Vector3d& camera) {
  const double range = std::isfinite(detection.range) ? detection.range : kUnknownRange;
  const double azimuth = pose.yaw + detection.bearing;
  Eigen::Vector3d end = camera + range * Eigen::Vector3d(std::cos(azimuth), std::sin(azimuth), 0.0);
  if (detection.map_entry) end.z() = map.markers[*detection.map_entry].center().z();
  return end;
}

void addBearings(const std::string& frame, const FrameResult& result, const MarkerMap& map,
                 const Eigen::Vector3d& camera, RvizMarkers* markers) {
  const std_msgs::ColorRGBA orange = color(1.0, 0.45, 0.1);
  RvizMarker predicted = lines(frame, "predicted", 0.01, color(0.6, 0.6, 0.6, 0.6));
  RvizMarker accepted = lines(frame, "accepted", 0.025, color(0.2, 0.85, 0.35));
  RvizMarker rejected = lines(frame, "rejected", 0.025, orange);
  for (const PredictedMarker& marker : result.predicted) {
    predicted.points.push_back(toMessage(camera));
    predicted.points.push_back(toMessage(map.markers[marker.map_entry].center()));
  }
  int rejections = 0;
  for (const MarkerDetection& detection : result.detections) {
    const Eigen::Vector3d end = endOfSight(detection, map, result.map_from_base->pose, camera);
    RvizMarker& sight = detection.accepted ? accepted : rejected;
    sight.points.push_back(toMessage(camera));
    sight.points.push_back(toMessage(end));
    if (detection.accepted) continue;
    RvizMarker reason = text(frame, "reasons", end - kTextHeight * Eigen::Vector3d::UnitZ(),
                             std::to_string(detection.id) + ": " + detection.reason, orange);
    reason.id = rejections++;
    markers->push_back(reason);
  }
  for (const RvizMarker& marker : {predicted, accepted, rejected}) {
    if (!marker.points.empty()) markers->push_back(marker);
  }
}

void addRobot(const std::string& frame, const Pose& pose, double radius,
              const Eigen::Vector3d& camera, RvizMarkers* markers) {
  const double height = std::max(0.05, 0.4 * camera.z());
  RvizMarker body = rvizMarker(frame, "robot", RvizMarker::CYLINDER, color(0.25, 0.45, 0.75, 0.9));
  body.pose = toMessage(pose);
  body.pose.position.z = height / 2.0;
  body.scale.x = body.scale.y = 2.0 * radius;
  body.scale.z = height;

  RvizMarker mast = rvizMarker(frame, "robot", RvizMarker::CYLINDER, color(0.7, 0.7, 0.7));
  mast.id = 1;
  mast.pose.position = toMessage(Eigen::Vector3d(camera.x(), camera.y(), camera.z() / 2.0));
  mast.scale.x = mast.scale.y = 0.04;
  mast.scale.z = std::max(0.01, camera.z());

  RvizMarker heading = rvizMarker(frame, "robot", RvizMarker::ARROW, color(1.0, 0.85, 0.2));
  heading.id = 2;
  heading.pose = toMessage(pose);
  heading.pose.position.z = height + 0.03;
  heading.scale.x = 2.0 * radius;
  heading.scale.y = heading.scale.z = 0.3 * radius;

  markers->insert(markers->end(), {body, mast, heading});
}

RvizMarker ellipse(const std::string& frame, const std::string& name_space, const Pose& pose,
                   const Eigen::Vector2d& half_axes, const Eigen::Matrix2d& directions,
                   const std_msgs::ColorRGBA& color) {
  constexpr int kSegments = 48;
  RvizMarker marker = rvizMarker(frame, name_space, RvizMarker::LINE_STRIP, color);
  marker.scale.x = 0.015;
  for (int i = 0; i <= kSegments; ++i) {
    const double angle = 2.0 * kPi * i / kSegments;
    const Eigen::Vector2d offset =
        directions * half_axes.cwiseProduct(Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    marker.points.push_back(
        toMessage(Eigen::Vector3d(pose.x + offset.x(), pose.y + offset.y(), 0.02)));
  }
  return marker;
}

void addCovariance(const std::string& frame, const PoseEstimate& estimate, double robot_radius,
                   RvizMarkers* markers) {
  const EigenPairs eigen = eigenPairs(estimate.covariance.topLeftCorner<2, 2>());
  const Eigen::Vector2d half_axes = 3.0 * eigen.values.cwiseMax(0.0).cwiseSqrt();
  const double yaw = degrees(3.0 * std::sqrt(std::max(0.0, estimate.covariance(2, 2))));
  const Pose& pose = estimate.pose;
  const std_msgs::ColorRGBA yellow = color(1.0, 0.9, 0.3);
  markers->push_back(ellipse(frame, "covariance", pose, half_axes, eigen.vectors, yellow));

  // The power of ten that makes the ellipse about as large as the robot.
  const double power = std::floor(std::log10(3.0 * robot_radius / std::max(half_axes.y(), 1e-9)));
  const double enlargement = std::pow(10.0, std::max(0.0, power));
  std::array<char, 100> words{};
  if (enlargement > 1.0) {
    std::snprintf(words.data(), words.size(), "3 sigma: %.2g x %.2g mm, %.2g deg (drawn x %.0f)",
                  1e3 * half_axes.y(), 1e3 * half_axes.x(), yaw, enlargement);
    markers->push_back(ellipse(frame, "covariance_enlarged", pose, enlargement * half_axes,
                               eigen.vectors, color(1.0, 0.9, 0.3, 0.6)));
  } else {
    std::snprintf(words.data(), words.size(), "3 sigma: %.2f x %.2f m, %.2g deg", half_axes.y(),
                  half_axes.x(), yaw);
  }
  RvizMarker label =
      text(frame, "covariance", {pose.x, pose.y, -2.0 * kTextHeight}, words.data(), yellow);
  label.id = 1;
  markers->push_back(label);
}

/// An arrow at each pose that the robot may have, fainter the less probable it is; none if only one
/// is left.
void addHypotheses(const std::string& frame, const std::vector<WeightedPose>& hypotheses,
                   double robot_radius, RvizMarkers* markers) {
  if (hypotheses.size() < 2) return;
  int id = 0;
  for (const WeightedPose& hypothesis : hypotheses) {
    const Pose pose = hypothesis.map_from_base.pose;
    const double opacity = 0.2 + 0.8 * hypothesis.probability;
    const std_msgs::ColorRGBA pink = color(0.95, 0.35, 0.75, opacity);
    RvizMarker arrow = rvizMarker(frame, "hypotheses", RvizMarker::ARROW, pink);
    arrow.id = id++;
    arrow.pose = toMessage(pose);
    arrow.scale.x = 3.0 * robot_radius;
    arrow.scale.y = arrow.scale.z = 0.4 * robot_radius;
    std::array<char, 20> percent{};
    std::snprintf(percent.data(), percent.size(), "%.0f %%", 1e2 * hypothesis.probability);
    RvizMarker label = text(frame, "hypotheses", {pose.x, pose.y, pose.z + 2.0 * kTextHeight},
                            percent.data(), pink);
    label.id = id++;
    markers->insert(markers->end(), {arrow, label});
  }
}

/// Writes above the middle of the map why no robot is shown.
RvizMarker whyLost(const std::string& frame, const std::string& remark, const MarkerMap& map) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Marker& marker : map.markers) {
    middle += marker.center() / static_cast<double>(map.markers.size());
  }
  RvizMarker label = text(frame, "remark", middle, "searching: " + remark, color(1.0, 0.45, 0.1));
  label.scale.z = 2.0 * kTextHeight;
  return label;
}

/// The kinds that each camera has for itself.
const std::set<std::string> kOfCamera = {"predicted", "accepted", "rejected", "reasons"};

/// Whether a namespace belongs to another camera than the one whose namespaces end with
/// `of_camera`.
bool isOfAnother(const std::string& name_space, const std::string& of_camera) {
  const std::size_t space = name_space.find(' ');
  return space != std::string::npos && name_space.substr(space) != of_camera;
}

}  // namespace

FrameMarkers::FrameMarkers(std::string map_frame, double robot_radius)
    : map_frame_(std::move(map_frame)), robot_radius_(robot_radius) {}

visualization_msgs::MarkerArray FrameMarkers::draw(const LocalizedImage& localized,
                                                   const MarkerMap& map) {
  visualization_msgs::MarkerArray array;
  if (localized.result.map_from_base) {
    const PoseEstimate estimate = localized.result.publishedPose();
    const Eigen::Isometry3d map_from_camera =
        estimate.pose.toIsometry() * localized.input.frame.base_from_camera;
    const Eigen::Vector3d camera = map_from_camera.translation();
    addRobot(map_frame_, estimate.pose, robot_radius_, camera, &array.markers);
    addBearings(map_frame_, localized.result, map, camera, &array.markers);
    addCovariance(map_frame_, estimate, robot_radius_, &array.markers);
  } else {
    array.markers.push_back(whyLost(map_frame_, localized.result.remark, map));
  }
  addHypotheses(map_frame_, localized.result.hypotheses, robot_radius_, &array.markers);

  const std::string of_camera = localized.camera_name.empty() ? "" : " " + localized.camera_name;
  std::set<std::pair<std::string, int>> shown;
  for (RvizMarker& marker : array.markers) {
    if (kOfCamera.count(marker.ns) > 0) marker.ns += of_camera;
    marker.header.stamp = localized.input.header.stamp;
    shown.emplace(marker.ns, marker.id);
  }
  for (const auto& [name_space, id] : shown_) {
    if (shown.count({name_space, id}) > 0) continue;
    if (isOfAnother(name_space, of_camera)) {
      shown.emplace(name_space, id);
      continue;
    }
    RvizMarker gone = rvizMarker(map_frame_, name_space, RvizMarker::CUBE, color(0, 0, 0, 0));
    gone.id = id;
    gone.action = RvizMarker::DELETE;
    array.markers.push_back(gone);
  }
  shown_ = shown;
  return array;
}

}  // namespace omnitag
