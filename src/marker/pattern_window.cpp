#include "marker/pattern_window.h"

#include <algorithm>
#include <cmath>

namespace omnitag {

PatternWindow::PatternWindow(const Eigen::Vector2d& side_u, const Eigen::Vector2d& side_v,
                             double blur_variance, const Eigen::Vector2d& sweep) {
  // Pixels squared. A smaller variance only makes the pixel a little larger.
  constexpr double kSharp = 0.05;
  constexpr double kVarianceOfPixel = 1.0 / 12.0;  // along either side
  const double variance = kVarianceOfPixel + blur_variance;
  const double width = std::sqrt(variance / kVarianceOfPixel);
  const double side = width * std::min(side_u.norm(), side_v.norm());
  const double steps_needed = std::ceil(2.0 * sweep.norm() / side);
  constexpr double kMostSteps = 8.0;
  steps_ = static_cast<int>(std::clamp(steps_needed, 1.0, kMostSteps));
  step_ = sweep / steps_;
  const Eigen::Vector2d squares = side_u.cwiseAbs2() + side_v.cwiseAbs2();
  is_blurred_ = blur_variance >= kSharp;
  if (is_blurred_) {
    const double mixed = variance * (side_u.x() * side_u.y() + side_v.x() * side_v.y());
    const Eigen::Vector2d variances = variance * squares;
    const double correlation = mixed / std::sqrt(variances.prod());
    Eigen::Vector2d line = (std::abs(correlation) * variances).cwiseSqrt();
    if (mixed < 0.0) line.y() = -line.y();
    // Gauss-Hermite rules with three and with five points. The Gaussian at each point must be wide
    // enough to fill the gap to the next.
    constexpr double kStrong = 0.35;
    add(Eigen::Vector2d::Zero(), std::abs(correlation) < kStrong ? 2.0 / 3.0 : 8.0 / 15.0);
    const auto addBeside = [&](double deviations, double share) {
      add(-deviations * line, share);
      add(deviations * line, share);
    };
    if (std::abs(correlation) < kStrong) {
      addBeside(std::sqrt(3.0), 1.0 / 6.0);
    } else {
      addBeside(std::sqrt(5.0 - std::sqrt(10.0)), (7.0 + 2.0 * std::sqrt(10.0)) / 60.0);
      addBeside(std::sqrt(5.0 + std::sqrt(10.0)), (7.0 - 2.0 * std::sqrt(10.0)) / 60.0);
    }
    // Each step also includes the sweep within it.
    extent_ = ((1.0 - std::abs(correlation)) * variances + step_.cwiseAbs2() / 12.0).cwiseSqrt();
    constexpr double kMostOfIt = 3.0;
    constexpr double kNearlyAllOfIt = 1.75;
    const Eigen::Vector2d deviations = variances.cwiseSqrt();
    reach_ = kMostOfIt * deviations + 0.5 * sweep.cwiseAbs();
    core_ = kNearlyAllOfIt * deviations + 0.5 * sweep.cwiseAbs();
  } else {
    const Eigen::Vector2d sum = 0.25 * width * (side_u + side_v);
    const Eigen::Vector2d difference = 0.25 * width * (side_u - side_v);
    for (const Eigen::Vector2d& place : {sum, difference}) {
      add(-place, 0.25);
      add(place, 0.25);
    }
    extent_ = 0.5 * (0.25 * width * width * squares + step_.cwiseAbs2()).cwiseSqrt();
    reach_ = 0.5 * (width * (side_u.cwiseAbs() + side_v.cwiseAbs()) + sweep.cwiseAbs());
    core_ = reach_;
  }
  size_ = (width * width * squares + sweep.cwiseAbs2()).cwiseSqrt();
}

}  // namespace omnitag
