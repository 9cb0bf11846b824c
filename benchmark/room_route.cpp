#include "room_route.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "omnitag/common/angle.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

using Generator = std::mt19937;

constexpr double kClearance = 0.6;  // m
constexpr int kTries = 20000;

double uniform(double low, double high, Generator* generator) {
  return std::uniform_real_distribution<double>(low, high)(*generator);
}

Eigen::Vector2d placeOf(const Pose& pose) { return {pose.x, pose.y}; }

Eigen::Vector2d freePlace(const Room& room, Generator* generator) {
  for (int i = 0; i < kTries; ++i) {
    const double x = uniform(0.0, room.size.x(), generator);
    const double y = uniform(0.0, room.size.y(), generator);
    if (room.isFree({x, y}, kClearance)) return {x, y};
  }
  throw InputError("a room has no free place");
}

double sideOfGap(const Eigen::Vector2d& place, const Room& room) {
  return room.through_gap.dot(place - room.gap);
}

/// A robot that turns toward one place after another as it drives.
class Driver {
 public:
  Driver(const Pose& start, std::vector<Eigen::Vector2d> places, Generator* generator)
      : pose_(start), places_(std::move(places)) {
    cruise_ = uniform(0.2, 0.8, generator);
    const bool is_moving = std::bernoulli_distribution(0.5)(*generator);
    speed_ = is_moving ? std::min(cruise_, 0.6) : 0.0;
  }

  const Pose& pose() const { return pose_; }

  void step(double interval) {
    constexpr double kMostTurn = 1.0;          // rad/s
    constexpr double kAcceleration = 0.8;      // m/s^2
    constexpr double kTurnAcceleration = 1.5;  // rad/s^2
    constexpr double kNear = 0.3;              // m
    if (next_ + 1 < places_.size() && (places_[next_] - placeOf(pose_)).norm() < kNear) ++next_;
    const Eigen::Vector2d way = places_[next_] - placeOf(pose_);
    const double bearing = normalizeAngle(std::atan2(way.y(), way.x()) - pose_.yaw);
    const double wanted_turn = std::clamp(2.0 * bearing, -kMostTurn, kMostTurn);
    const bool has_arrived = next_ + 1 == places_.size() && way.norm() < kNear;
    const double wanted_speed =
        has_arrived ? 0.0 : cruise_ * std::max(0.3, std::cos(std::min(std::abs(bearing), kPi)));
    speed_ +=
        std::clamp(wanted_speed - speed_, -kAcceleration * interval, kAcceleration * interval);
    turn_ += std::clamp((has_arrived ? 0.0 : wanted_turn) - turn_, -kTurnAcceleration * interval,
                        kTurnAcceleration * interval);
    const double heading = pose_.yaw + 0.5 * turn_ * interval;
    pose_.x += speed_ * interval * std::cos(heading);
    pose_.y += speed_ * interval * std::sin(heading);
    pose_.yaw = normalizeAngle(pose_.yaw + turn_ * interval);
  }

 private:
  Pose pose_;
  std::vector<Eigen::Vector2d> places_;
  std::size_t next_ = 0;
  double cruise_ = 0.0;  // m/s
  double speed_ = 0.0;   // m/s
  double turn_ = 0.0;    // rad/s
};

/// None where it came too close to a wall.
std::optional<std::vector<Pose>> drive(Driver driver, const Room& room, std::size_t poses) {
  constexpr int kSteps = 10;
  std::vector<Pose> route;
  while (true) {
    if (!room.isFree(placeOf(driver.pose()), kClearance)) return std::nullopt;
    route.push_back(driver.pose());
    if (route.size() == poses) return route;
    for (int i = 0; i < kSteps; ++i) driver.step(kRouteInterval / kSteps);
  }
}

Pose headedFor(const Eigen::Vector2d& place, const Eigen::Vector2d& from, Generator* generator) {
  const Eigen::Vector2d way = place - from;
  const double off = std::normal_distribution<double>(0.0, 0.5)(*generator);
  return {from.x(), from.y(), normalizeAngle(std::atan2(way.y(), way.x()) + off)};
}

std::vector<Eigen::Vector2d> placesFor(const Room& room, Generator* generator) {
  return {freePlace(room, generator), freePlace(room, generator), freePlace(room, generator)};
}

bool passesGap(const std::vector<Pose>& route, const Room& room) {
  return sideOfGap(placeOf(route.front()), room) * sideOfGap(placeOf(route.back()), room) < 0.0;
}

}  // namespace

std::vector<Pose> randomRoute(const Room& room, std::size_t poses, Generator* generator) {
  constexpr double kNearGap = 2.0;  // m
  for (int i = 0; i < kTries; ++i) {
    const Eigen::Vector2d start = freePlace(room, generator);
    std::vector<Eigen::Vector2d> places = placesFor(room, generator);
    if (room.is_divided) {
      if ((start - room.gap).norm() > kNearGap) continue;
      const double side = sideOfGap(start, room) > 0.0 ? 1.0 : -1.0;
      places.front() = room.gap + 0.5 * side * room.through_gap;
      places.insert(places.begin() + 1, room.gap - 0.5 * side * room.through_gap);
    }
    const Pose first = headedFor(places.front(), start, generator);
    const auto route = drive(Driver(first, places, generator), room, poses);
    if (route && (!room.is_divided || passesGap(*route, room))) return *route;
  }
  throw InputError("a room has no free route");
}

std::vector<Pose> routeAfterCarrying(const Pose& from, const Room& room, std::size_t poses,
                                     Generator* generator) {
  for (int i = 0; i < kTries; ++i) {
    const double distance = uniform(0.3, 3.0, generator);
    const double direction = uniform(-kPi, kPi, generator);
    const double yaw = uniform(-kPi, kPi, generator);
    const Pose start{from.x + distance * std::cos(direction),
                     from.y + distance * std::sin(direction), yaw};
    if (!room.isFree(placeOf(start), kClearance)) continue;
    const auto route = drive(Driver(start, placesFor(room, generator), generator), room, poses);
    if (route) return *route;
  }
  throw InputError("a room has no free route");
}

std::vector<Pose> odometryOf(const std::vector<std::vector<Pose>>& routes, Generator* generator) {
  constexpr double kScaleDeviation = 0.01;
  constexpr double kNoise = 0.02;            // of each motion
  constexpr double kTurnPerDistance = 0.01;  // rad/m
  std::normal_distribution<double> normal(0.0, 1.0);
  const double distance_scale = 1.0 + kScaleDeviation * normal(*generator);
  const double turn_scale = 1.0 + kScaleDeviation * normal(*generator);
  std::vector<Pose> odometry;
  Pose last;
  for (const std::vector<Pose>& route : routes) {
    for (std::size_t i = 0; i < route.size(); ++i) {
      const Pose motion = i > 0 ? inverse(route[i - 1]) * route[i] : Pose{};
      Pose measured;
      const double distance = std::hypot(motion.x, motion.y);
      measured.x = distance_scale * motion.x + kNoise * distance * normal(*generator);
      measured.y = distance_scale * motion.y + kNoise * distance * normal(*generator);
      measured.yaw = turn_scale * motion.yaw + kNoise * motion.yaw * normal(*generator) +
                     kTurnPerDistance * distance * normal(*generator);
      last = last * measured;
      odometry.push_back(last);
    }
  }
  return odometry;
}

}  // namespace omnitag
