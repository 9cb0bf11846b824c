#pragma once

#include <cstddef>
#include <random>
#include <vector>

#include "omnitag/common/pose.h"
#include "room.h"

namespace omnitag {

/// s between the poses of a route.
constexpr double kRouteInterval = 0.1;

/// A smooth drive between random places of the room, up to 0.8 m/s and 1 rad/s, at least 0.6 m from
/// every wall: so many poses. One of a divided room passes the gap.
std::vector<Pose> randomRoute(const Room& room, std::size_t poses, std::mt19937* generator);

/// Another drive, which begins 0.3 to 3 m away from a pose, at any heading.
std::vector<Pose> routeAfterCarrying(const Pose& from, const Room& room, std::size_t poses,
                                     std::mt19937* generator);

/// What odometry makes of routes that follow each other, of which nothing leads from one to the
/// next: distance and turn off by 1 % (standard deviation) each, and by 2 % of each motion.
std::vector<Pose> odometryOf(const std::vector<std::vector<Pose>>& routes, std::mt19937* generator);

}  // namespace omnitag
