#include "localization/image_lag.h"

#include <cmath>

namespace omnitag {

void ImageLag::add(double yaw_innovation, const PoseVector& velocity, bool is_carried_on) {
  const double turn_rate = velocity[2];
  if (last_turn_rate_ && is_carried_on) {
    constexpr double kRemembered = 0.995;
    const double change = turn_rate - *last_turn_rate_;
    count_ = kRemembered * count_ + 1.0;
    rate_rate_ = kRemembered * rate_rate_ + change * change;
    rate_innovation_ = kRemembered * rate_innovation_ + change * yaw_innovation;
    innovation_innovation_ = kRemembered * innovation_innovation_ + yaw_innovation * yaw_innovation;
  }
  last_turn_rate_ = turn_rate;
}

std::optional<double> ImageLag::lag() const {
  constexpr double kFewest = 15.0;
  constexpr double kDeviations = 4.0;
  constexpr double kLeast = 1e-3;  // s
  if (count_ < kFewest || !(rate_rate_ > 0.0)) return std::nullopt;
  const double lag = rate_innovation_ / rate_rate_;
  const double unexplained = innovation_innovation_ - lag * rate_innovation_;
  const double deviation = std::sqrt(std::max(0.0, unexplained) / (count_ - 1.0) / rate_rate_);
  const bool is_certain = std::abs(lag) > kDeviations * deviation && std::abs(lag) > kLeast;
  return is_certain ? std::optional(lag) : std::nullopt;
}

PoseMatrix covarianceOfLag(double lag, const PoseVector& velocity) {
  // m: nearer markers are displaced less. When rows see a turn at different times, the robot seems
  // displaced as much as the markers do.
  constexpr double kRange = 3.0;
  const double turn = lag * velocity[2];
  PoseMatrix covariance = PoseMatrix::Zero();
  covariance(0, 0) = covariance(1, 1) =
      (lag * translationPart(velocity)).squaredNorm() + kRange * kRange * turn * turn;
  covariance(2, 2) = turn * turn;
  return covariance;
}

}  // namespace omnitag
