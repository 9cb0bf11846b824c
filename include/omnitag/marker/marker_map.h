#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace omnitag {

struct PatternPicture;

/// Width of the border of a picture whose map does not say, as a share of the marker's edge;
/// ARToolKit's own.
constexpr double kPictureBorder = 0.25;

/// The four corners that the AprilTag library reports, in its order. In the marker's frame, times
/// half its size: (-1, -1), (1, -1), (1, 1), (-1, 1); that is, counter-clockwise from the lower
/// left for a person who looks at the upright marker.
template <typename Point>
using Corners = std::array<Point, 4>;

/// A marker in the world. Its frame: origin at its centre, x to the right and y up for a person who
/// looks at the upright marker, z out of its face toward that person.
struct Marker {
  std::string family;
  /// For a picture, the first entry of the map that has it.
  int id = 0;
  /// What is within the border; null for families of codes.
  std::shared_ptr<const PatternPicture> picture = nullptr;
  /// Unique in the map if given.
  std::string name;
  /// m, edge of the square between the corners that the library reports.
  double size = 0.0;
  Eigen::Isometry3d map_from_marker = Eigen::Isometry3d::Identity();
  /// m and rad, standard deviations of its misplacement along and about each axis; 0 if it is
  /// exactly in its place.
  double deviation = 0.0;
  double orientation_deviation = 0.0;

  Eigen::Vector3d center() const { return map_from_marker.translation(); }
  /// Unit vector out of the marker's face, in the map.
  Eigen::Vector3d normal() const { return map_from_marker.linear().col(2); }
  /// In the map.
  Corners<Eigen::Vector3d> corners() const;
};

/// The places of the markers. An entry is identified by its index; several may have the same id.
struct MarkerMap {
  std::string frame_id = "map";
  std::vector<Marker> markers;
  /// For markers without their own; empty and 0 if there are none.
  std::string default_family = {};
  double default_size = 0.0;
  double default_border = kPictureBorder;
  /// For markers without their own; see Marker.
  double default_deviation = 0.0;
  double default_orientation_deviation = 0.0;
};

/// The entries of this family and id; empty if the map has no such marker.
std::vector<std::size_t> entriesOf(const MarkerMap& map, const std::string& family, int id);

/// Orientation of a marker on a vertical surface: `yaw` is the heading of its outward normal in the
/// map, `roll` turns it in its own plane, counter-clockwise as seen by a person who looks at it
/// (radians).
Eigen::Quaterniond uprightOrientation(double yaw, double roll);

}  // namespace omnitag
