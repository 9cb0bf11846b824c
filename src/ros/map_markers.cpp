#include "ros/map_markers.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "marker/tag_pattern.h"
#include "ros/conversions.h"
#include "ros/rviz_marker.h"

namespace omnitag {
namespace {

/// An axis-aligned rectangle in a marker's plane, in halves of the marker's size.
struct Rectangle {
  double left, bottom, right, top;
};

/// Adds triangles in a marker's own frame to one list, so that a map of any size is one message.
class Sheet {
 public:
  Sheet(const Marker& marker, visualization_msgs::Marker* triangles)
      : marker_(marker), triangles_(triangles) {}

  /// `height`: m, out of the marker's face.
  void addRectangle(const Rectangle& r, double height, const std_msgs::ColorRGBA& color) {
    const double half = marker_.size / 2.0;
    const Eigen::Vector3d lower_left(half * r.left, half * r.bottom, height);
    const Eigen::Vector3d lower_right(half * r.right, half * r.bottom, height);
    const Eigen::Vector3d upper_right(half * r.right, half * r.top, height);
    const Eigen::Vector3d upper_left(half * r.left, half * r.top, height);
    addTriangle(lower_left, lower_right, upper_right, color);
    addTriangle(lower_left, upper_right, upper_left, color);
  }

  /// The border of a square of half width `outer`, around a square hole of half width `inner`.
  void addFrame(double outer, double inner, const std_msgs::ColorRGBA& color) {
    addRectangle({-outer, inner, outer, outer}, 0.0, color);
    addRectangle({-outer, -outer, outer, -inner}, 0.0, color);
    addRectangle({-outer, -inner, -inner, inner}, 0.0, color);
    addRectangle({inner, -inner, outer, inner}, 0.0, color);
  }

  void addTriangle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                   const std_msgs::ColorRGBA& color) {
    for (const Eigen::Vector3d& corner : {a, b, c}) {
      triangles_->points.push_back(toMessage(marker_.map_from_marker * corner));
      triangles_->colors.push_back(color);
    }
  }

 private:
  const Marker& marker_;
  visualization_msgs::Marker* triangles_;
};

/// More would make the message too large for RViz; the faces are then white.
constexpr std::size_t kMostWithPatterns = 200;

std_msgs::ColorRGBA greyOf(double white) {
  const double level = 0.08 + 0.87 * white;
  return color(level, level, level);
}

/// The modules row by row, neighbours of about the same colour together.
void addPattern(const TagPattern& pattern, Sheet* sheet) {
  const double module = 2.0 / pattern.widthBetweenCorners();
  const double edge = 0.5 * module * pattern.width();
  for (int row = 0; row < pattern.width(); ++row) {
    const double top = edge - row * module;
    int first = 0;
    for (int column = 1; column <= pattern.width(); ++column) {
      constexpr double kSame = 0.1;
      const double white = pattern.whiteAt(first, row);
      if (column < pattern.width() && std::abs(pattern.whiteAt(column, row) - white) < kSame) {
        continue;
      }
      sheet->addRectangle({first * module - edge, top - module, column * module - edge, top}, 0.0,
                          greyOf(white));
      first = column;
    }
  }
}

void addTag(const Marker& marker, bool with_pattern, visualization_msgs::Marker* triangles) {
  // Proportions of tag36h11: 10 modules with the white margin, 8 with the border, 6 of data.
  constexpr double kMargin = 10.0 / 8.0;
  constexpr double kBorder = 1.0;
  constexpr double kInside = 6.0 / 8.0;
  constexpr double kThickness = 0.01;
  Sheet sheet(marker, triangles);
  if (with_pattern) {
    addPattern(TagPattern(marker), &sheet);
  } else {
    sheet.addFrame(kMargin, kBorder, greyOf(1.0));
    sheet.addFrame(kBorder, kInside, greyOf(0.0));
    sheet.addRectangle({-kInside, -kInside, kInside, kInside}, 0.0, greyOf(1.0));
  }
  sheet.addRectangle({-kMargin, -kMargin, kMargin, kMargin}, -kThickness, color(0.45, 0.45, 0.5));
}

/// Perpendicular to the face, and flat if the marker is on a wall, so that it can be seen from
/// above.
void addNormal(const Marker& marker, visualization_msgs::Marker* triangles) {
  const double half_width = marker.size / 10.0;
  const double length = marker.size / 2.0;
  const Eigen::Matrix3d rotation = marker.map_from_marker.linear();
  const bool is_x_level = std::abs(rotation(2, 0)) <= std::abs(rotation(2, 1));
  const Eigen::Vector3d across =
      half_width * (is_x_level ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY());
  Sheet(marker, triangles)
      .addTriangle(-across, across, length * Eigen::Vector3d::UnitZ(), color(0.25, 0.55, 0.95));
}

/// A frame around a tag that mapping has found.
void addMappedFrame(const Marker& marker, const std_msgs::ColorRGBA& color,
                    visualization_msgs::Marker* triangles) {
  constexpr double kInside = 10.0 / 8.0;  // the white margin's edge
  constexpr double kOutside = 1.15 * kInside;
  Sheet(marker, triangles).addFrame(kOutside, kInside, color);
}

bool isSame(const Marker& a, const Marker& b) { return a.id == b.id && a.family == b.family; }

/// Whether people could see the difference.
bool looksDifferent(const std::vector<ProvisionalMarker>& a,
                    const std::vector<ProvisionalMarker>& b) {
  constexpr double kVisible = 0.01;  // m
  return !std::equal(a.begin(), a.end(), b.begin(), b.end(),
                     [](const ProvisionalMarker& one, const ProvisionalMarker& other) {
                       const Marker& marker = one.estimate.marker;
                       return marker.id == other.estimate.marker.id &&
                              one.is_used == other.is_used &&
                              (marker.center() - other.estimate.marker.center()).norm() < kVisible;
                     });
}

}  // namespace

visualization_msgs::MarkerArray mapMarkers(const MarkerMap& map,
                                           const std::vector<ProvisionalMarker>& provisional,
                                           const std::string& map_frame) {
  using RvizMarker = visualization_msgs::Marker;
  const std_msgs::ColorRGBA white = color(1.0, 1.0, 1.0);
  const std_msgs::ColorRGBA used = color(0.2, 0.8, 0.3);
  const std_msgs::ColorRGBA unsure = color(1.0, 0.6, 0.1);
  RvizMarker tags = rvizMarker(map_frame, "tags", RvizMarker::TRIANGLE_LIST, white);
  RvizMarker normals = rvizMarker(map_frame, "normals", RvizMarker::TRIANGLE_LIST, white);
  visualization_msgs::MarkerArray array;
  const auto add = [&](const Marker& marker, const std_msgs::ColorRGBA* mapped) {
    addTag(marker, map.markers.size() <= kMostWithPatterns, &tags);
    addNormal(marker, &normals);
    if (mapped != nullptr) addMappedFrame(marker, *mapped, &tags);

    RvizMarker name = rvizMarker(map_frame, "names", RvizMarker::TEXT_VIEW_FACING,
                                 mapped != nullptr ? *mapped : white);
    name.id = static_cast<int>(array.markers.size());
    name.text = std::to_string(marker.id) + (marker.name.empty() ? "" : "  " + marker.name);
    name.scale.z = 0.2;
    name.pose.position =
        toMessage(marker.center() + (marker.size + name.scale.z) * Eigen::Vector3d::UnitZ());
    array.markers.push_back(name);
  };
  for (const Marker& marker : map.markers) {
    const bool is_mapped =
        std::any_of(provisional.begin(), provisional.end(), [&](const ProvisionalMarker& each) {
          return each.is_used && isSame(each.estimate.marker, marker);
        });
    add(marker, is_mapped ? &used : nullptr);
  }
  for (const ProvisionalMarker& each : provisional) {
    if (!each.is_used) add(each.estimate.marker, &unsure);
  }
  array.markers.push_back(tags);
  array.markers.push_back(normals);
  return array;
}

MapDrawing::MapDrawing(const MarkerMap& map, const std::string& map_frame)
    : map_frame_(map_frame), markers_(mapMarkers(map, {}, map_frame)) {}

void MapDrawing::replace(const MarkerMap& map, const std::vector<ProvisionalMarker>& provisional) {
  const std::size_t before = markers_.markers.size();
  visualization_msgs::MarkerArray array = mapMarkers(map, provisional, map_frame_);
  // Deletes names beyond the new count: RViz knows each by its number.
  constexpr std::size_t kOthers = 2;
  for (std::size_t id = array.markers.size() - kOthers; id + kOthers < before; ++id) {
    visualization_msgs::Marker gone;
    gone.header.frame_id = map_frame_;
    gone.ns = "names";
    gone.id = static_cast<int>(id);
    gone.action = visualization_msgs::Marker::DELETE;
    array.markers.push_back(gone);
  }
  markers_ = std::move(array);
  drawn_ = provisional;
}

// Compares with what was drawn, not with the previous frame, because small moves add up.
bool MapDrawing::update(const MarkerMap& map, const std::vector<ProvisionalMarker>& provisional,
                        bool is_refined) {
  if (!is_refined && !looksDifferent(provisional, drawn_)) return false;
  markers_ = mapMarkers(map, provisional, map_frame_);
  drawn_ = provisional;
  return true;
}

}  // namespace omnitag
