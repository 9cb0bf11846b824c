#pragma once

#include <cmath>

namespace omnitag {

constexpr double kPi = 3.14159265358979323846;

constexpr double radians(double degrees) { return degrees * (kPi / 180.0); }
constexpr double degrees(double radians) { return radians * (180.0 / kPi); }

/// The same angle in [-pi, pi], for any finite angle in radians.
inline double normalizeAngle(double angle) { return std::remainder(angle, 2.0 * kPi); }

}  // namespace omnitag
