#include "room.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "omnitag/common/angle.h"

namespace omnitag {
namespace {

using Generator = std::mt19937;

double uniform(double low, double high, Generator* generator) {
  return std::uniform_real_distribution<double>(low, high)(*generator);
}

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

void addOuterWalls(Room* room) {
  const std::vector<Eigen::Vector2d> corners = {
      {0.0, 0.0}, {room->size.x(), 0.0}, room->size, {0.0, room->size.y()}};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    room->walls.push_back({corners[i], corners[(i + 1) % corners.size()]});
  }
}

/// Across the room, near its middle.
void addDivision(Room* room, Generator* generator) {
  const bool is_along_x = std::bernoulli_distribution(0.5)(*generator);
  const Eigen::Vector2d along = is_along_x ? Eigen::Vector2d::UnitX() : Eigen::Vector2d::UnitY();
  const Eigen::Vector2d through = is_along_x ? Eigen::Vector2d::UnitY() : Eigen::Vector2d::UnitX();
  const double length = along.dot(room->size);
  const double place = uniform(0.4, 0.6, generator) * through.dot(room->size);
  const double width = uniform(1.5, 2.5, generator);
  const double begin = uniform(0.3, length - width - 0.3, generator);
  const Eigen::Vector2d origin = place * through;
  room->walls.push_back({origin, origin + begin * along});
  room->walls.push_back({origin + (begin + width) * along, origin + length * along});
  room->is_divided = true;
  room->gap = origin + (begin + 0.5 * width) * along;
  room->through_gap = through;
}

/// A place for a marker: on which side of which wall, how far along it, and how high.
struct Place {
  std::size_t wall = 0;
  bool is_left = true;
  double along = 0.0;
  double height = 0.0;
};

/// Every point of the sides of walls that are seen is as likely as any other.
Place randomPlace(const Room& room, Generator* generator) {
  constexpr std::size_t kOuterWalls = 4;
  std::vector<double> weights;
  for (std::size_t i = 0; i < room.walls.size(); ++i) {
    weights.push_back((i < kOuterWalls ? 1.0 : 2.0) * room.walls[i].length());
  }
  Place place;
  place.wall = std::discrete_distribution<std::size_t>(weights.begin(), weights.end())(*generator);
  place.along = uniform(0.0, room.walls[place.wall].length(), generator);
  place.height = uniform(0.7, 1.8, generator);
  const bool is_left = std::bernoulli_distribution(0.5)(*generator);
  // The room lies to the left of the walls around it.
  place.is_left = place.wall < kOuterWalls || is_left;
  return place;
}

Place placeBeside(Place place, Generator* generator) {
  constexpr double kSpread = 0.7;  // m
  place.along += std::normal_distribution<double>(0.0, kSpread)(*generator);
  place.height = uniform(0.7, 1.8, generator);
  return place;
}

/// m across a marker's white border, and half of it.
double widthOf(const Marker& marker) { return 1.25 * marker.size; }
double reachOf(const Marker& marker) { return 0.5 * widthOf(marker); }

Marker markerAt(const Place& place, const Room& room, int id, double size) {
  constexpr double kBoard = 0.01;  // m
  const Wall& wall = room.walls[place.wall];
  const Eigen::Vector2d along = wall.along();
  const Eigen::Vector2d normal =
      (place.is_left ? 1.0 : -1.0) * Eigen::Vector2d(-along.y(), along.x());
  const Eigen::Vector2d center = wall.from + place.along * along + kBoard * normal;
  Marker marker;
  marker.family = "tag36h11";
  marker.id = id;
  marker.size = size;
  marker.map_from_marker = Eigen::Translation3d(center.x(), center.y(), place.height) *
                           uprightOrientation(std::atan2(normal.y(), normal.x()), 0.0);
  return marker;
}

bool overlap(const Marker& a, const Marker& b) {
  constexpr double kGap = 0.03;  // m
  if (a.normal().dot(b.normal()) < 0.9) return false;
  const Eigen::Vector3d offset = a.map_from_marker.inverse() * b.center();
  return offset.cwiseAbs().maxCoeff() < reachOf(a) + reachOf(b) + kGap;
}

bool fits(const Marker& marker, const Place& place, const Room& room) {
  const double reach = reachOf(marker);
  if (place.along < reach || place.along > room.walls[place.wall].length() - reach) return false;
  const Eigen::Vector3d right = reach * marker.map_from_marker.linear().col(0);
  const Eigen::Vector3d left_end = marker.center() - right;
  const Eigen::Vector3d right_end = marker.center() + right;
  if (isHidden(left_end.head<2>(), right_end.head<2>(), room.walls)) return false;
  return std::none_of(room.markers.markers.begin(), room.markers.markers.end(),
                      [&](const Marker& other) { return overlap(marker, other); });
}

void hangMarkers(Room* room, Generator* generator) {
  constexpr int kIds = 587;
  constexpr int kTries = 2000;
  const bool is_clustered = std::bernoulli_distribution(0.5)(*generator);
  const auto count = static_cast<std::size_t>(std::uniform_int_distribution(6, 14)(*generator));
  std::vector<int> ids(kIds);
  for (int i = 0; i < kIds; ++i) ids[static_cast<std::size_t>(i)] = i;
  std::shuffle(ids.begin(), ids.end(), *generator);
  std::optional<Place> last;
  for (int i = 0; i < kTries && room->markers.markers.size() < count; ++i) {
    const bool is_beside = last && is_clustered && std::bernoulli_distribution(0.7)(*generator);
    const Place place = is_beside ? placeBeside(*last, generator) : randomPlace(*room, generator);
    const Marker marker =
        markerAt(place, *room, ids[room->markers.markers.size()], uniform(0.3, 0.5, generator));
    if (!fits(marker, place, *room)) continue;
    room->markers.markers.push_back(marker);
    last = place;
  }
}

}  // namespace

double Wall::distanceTo(const Eigen::Vector2d& point) const {
  const double place = std::clamp(along().dot(point - from), 0.0, length());
  return (from + place * along() - point).norm();
}

bool isHidden(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const std::vector<Wall>& walls) {
  return std::any_of(walls.begin(), walls.end(), [&](const Wall& wall) {
    const Eigen::Vector2d along = wall.to - wall.from;
    if (cross(along, a - wall.from) * cross(along, b - wall.from) >= 0.0) return false;
    return cross(b - a, wall.from - a) * cross(b - a, wall.to - a) < 0.0;
  });
}

bool Room::isFree(const Eigen::Vector2d& point, double clearance) const {
  const bool is_inside = (point.array() > 0.0).all() && (point.array() < size.array()).all();
  return is_inside && std::all_of(walls.begin(), walls.end(), [&](const Wall& wall) {
           return wall.distanceTo(point) >= clearance;
         });
}

Room randomRoom(Generator* generator) {
  Room room;
  room.size.x() = uniform(5.0, 9.0, generator);
  room.size.y() = uniform(5.0, 9.0, generator);
  addOuterWalls(&room);
  if (std::bernoulli_distribution(0.4)(*generator)) addDivision(&room, generator);
  hangMarkers(&room, generator);
  return room;
}

MovedGroup randomGroup(const MarkerMap& markers, bool is_turned, Generator* generator) {
  const std::size_t all = markers.markers.size();
  const std::size_t most = std::min<std::size_t>(6, all - 2);
  const auto count = std::uniform_int_distribution<std::size_t>(2, most)(*generator);
  const auto first = std::uniform_int_distribution<std::size_t>(0, all - 1)(*generator);
  std::vector<std::size_t> nearest;
  for (std::size_t i = 0; i < all; ++i) nearest.push_back(i);
  const auto distance = [&](std::size_t entry) {
    return (markers.markers[entry].center() - markers.markers[first].center()).norm();
  };
  std::sort(nearest.begin(), nearest.end(),
            [&](std::size_t a, std::size_t b) { return distance(a) < distance(b); });
  MovedGroup group;
  group.entries.insert(nearest.begin(), nearest.begin() + static_cast<std::ptrdiff_t>(count));
  group.shift = std::exp(uniform(std::log(0.05), std::log(1.0), generator));
  group.direction = uniform(-kPi, kPi, generator);
  const double turn = uniform(-radians(20.0), radians(20.0), generator);
  if (is_turned) group.turn = turn;
  return group;
}

MarkerMap displaced(const MarkerMap& markers, const MovedGroup& group) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const std::size_t entry : group.entries) middle += markers.markers[entry].center();
  middle /= static_cast<double>(group.entries.size());
  const Eigen::Vector3d shift(group.shift * std::cos(group.direction),
                              group.shift * std::sin(group.direction), 0.0);
  const Eigen::Isometry3d motion = Eigen::Translation3d(middle + shift) *
                                   Eigen::AngleAxisd(group.turn, Eigen::Vector3d::UnitZ()) *
                                   Eigen::Translation3d(-middle);
  MarkerMap map = markers;
  for (const std::size_t entry : group.entries) {
    Eigen::Isometry3d& map_from_marker = map.markers[entry].map_from_marker;
    map_from_marker = motion * map_from_marker;
  }
  return map;
}

}  // namespace omnitag
