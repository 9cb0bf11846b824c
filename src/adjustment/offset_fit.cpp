#include "adjustment/offset_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "omnitag/common/angle.h"

namespace omnitag {
namespace {

/// Standard deviations at which a motion counts half.
constexpr double kRobust = 3.0;

/// A motion in the base's frame before it: x, y and yaw (m and rad).
using FloorMotion = Eigen::Vector3d;

Pose poseBetween(const Pose& from, const Pose& to) {
  return inverse(from.onFloor()) * to.onFloor();
}

FloorMotion motionOf(const Pose& pose) { return {pose.x, pose.y, pose.yaw}; }

FloorMotion minus(const FloorMotion& a, const FloorMotion& b) {
  FloorMotion difference = a - b;
  difference.z() = normalizeAngle(difference.z());
  return difference;
}

/// Errors of odometry: variances per square metre and square radian.
struct OdometryNoise {
  Eigen::Vector2d translation;
  Eigen::Vector2d rotation;
};

/// A motion from one frame to the next.
struct Motion {
  double from_stamp = 0.0;
  double to_stamp = 0.0;
  FloorMotion by_images;
  /// Covariance of `by_images`.
  Eigen::Matrix3d covariance;
  /// Square metres and square radians.
  Eigen::Vector2d squares;
};

/// The same by odometry, at an offset.
struct Comparison {
  const Motion* motion;
  /// Odometry's motion minus the images', and its derivative by the offset.
  FloorMotion residual;
  FloorMotion by_offset;
};

class OffsetFitter {
 public:
  OffsetFitter(const std::vector<MovingFrame>& frames, const OdometryAt& odometry,
               const MotionModelConfig& config)
      : odometry_(odometry),
        noise_{{std::pow(config.odometry_translation_per_metre, 2),
                std::pow(config.odometry_translation_per_rotation, 2)},
               {std::pow(config.odometry_rotation_per_metre, 2),
                std::pow(config.odometry_rotation_per_rotation, 2)}} {
    for (std::size_t i = 1; i < frames.size(); ++i) addMotion(frames[i - 1], frames[i]);
  }

  OffsetFit run() {
    constexpr int kRounds = 10;
    OffsetFit fit{scan(), std::numeric_limits<double>::infinity(), 0};
    for (int round = 0; round < kRounds; ++round) {
      const std::vector<Comparison> comparisons = compare(fit.offset);
      fit.motions = comparisons.size();
      if (comparisons.size() < OffsetFit::kFewestMotions) break;
      learnNoise(comparisons);
      double information = 0.0;
      double gradient = 0.0;
      for (const Comparison& comparison : comparisons) {
        const Eigen::Matrix3d weight = weightOf(comparison) * informationOf(*comparison.motion);
        information += comparison.by_offset.dot(weight * comparison.by_offset);
        gradient -= comparison.by_offset.dot(weight * comparison.residual);
      }
      if (!(information > 0.0)) break;
      fit.offset = std::clamp(fit.offset + gradient / information, -kReach, kReach);
      fit.deviation = 1.0 / std::sqrt(information);
    }
    return fit;
  }

 private:
  /// Largest offset in s: exposure and transport cannot explain more.
  static constexpr double kReach = 0.5;
  /// Lower bound of odometry's deviations for any motion, in m and rad.
  static constexpr double kResolution = 1e-4;

  void addMotion(const MovingFrame& from, const MovingFrame& to) {
    Motion motion;
    motion.from_stamp = from.seen.stamp;
    motion.to_stamp = to.seen.stamp;
    const Pose moved = poseBetween(from.map_from_base, to.map_from_base);
    motion.by_images = motionOf(moved);
    const auto [by_from, by_to] = floorMotionDerivatives(from.map_from_base, moved);
    motion.covariance =
        by_from * from.covariance * by_from.transpose() + by_to * to.covariance * by_to.transpose();
    motion.squares << motion.by_images.head<2>().squaredNorm(), std::pow(motion.by_images.z(), 2);
    motions_.push_back(motion);
  }

  std::optional<FloorMotion> byOdometry(const Motion& motion, double offset) const {
    const std::optional<Pose> from = odometry_(motion.from_stamp + offset);
    const std::optional<Pose> to = odometry_(motion.to_stamp + offset);
    if (!from || !to) return std::nullopt;
    return motionOf(poseBetween(*from, *to));
  }

  std::vector<Comparison> compare(double offset) const {
    // About the time between two of odometry's transforms, which are interpolated linearly.
    constexpr double kStep = 0.01;  // s
    std::vector<Comparison> comparisons;
    for (const Motion& motion : motions_) {
      const auto now = byOdometry(motion, offset);
      const auto later = byOdometry(motion, offset + kStep);
      const auto sooner = byOdometry(motion, offset - kStep);
      if (!now || !later || !sooner) continue;
      comparisons.push_back(
          {&motion, minus(*now, motion.by_images), minus(*later, *sooner) / (2.0 * kStep)});
    }
    return comparisons;
  }

  /// The best offset on an even grid, as a start.
  double scan() const {
    double best = 0.0;
    double least = std::numeric_limits<double>::infinity();
    constexpr int kSteps = 25;  // to either side
    constexpr double kStep = kReach / kSteps;
    for (int i = -kSteps; i <= kSteps; ++i) {
      double cost = 0.0;
      std::size_t count = 0;
      for (const Motion& motion : motions_) {
        const auto now = byOdometry(motion, kStep * i);
        if (!now) continue;
        const FloorMotion residual = minus(*now, motion.by_images);
        const double square = residual.dot(informationOf(motion) * residual);
        cost += std::log1p(square / (kRobust * kRobust));
        ++count;
      }
      cost /= static_cast<double>(std::max<std::size_t>(count, 1));
      if (2 * count < motions_.size() || cost >= least) continue;
      least = cost;
      best = kStep * i;
    }
    return best;
  }

  Eigen::Vector3d odometryVariances(const Motion& motion) const {
    const double translation = noise_.translation.dot(motion.squares);
    return {translation, translation, noise_.rotation.dot(motion.squares)};
  }

  Eigen::Matrix3d informationOf(const Motion& motion) const {
    Eigen::Matrix3d covariance = motion.covariance;
    covariance.diagonal() +=
        odometryVariances(motion) + Eigen::Vector3d::Constant(kResolution * kResolution);
    return covariance.ldlt().solve(Eigen::Matrix3d::Identity());
  }

  double weightOf(const Comparison& comparison) const {
    const double square =
        comparison.residual.dot(informationOf(*comparison.motion) * comparison.residual);
    return 1.0 / (1.0 + square / (kRobust * kRobust));
  }

  void learnNoise(const std::vector<Comparison>& comparisons) {
    const OdometryNoise before = noise_;
    noise_.translation = varianceComponents(comparisons, before.translation, {0, 1});
    noise_.rotation = varianceComponents(comparisons, before.rotation, {2});
  }

  /// One round of weighted least squares: explains the squared residuals along some axes, minus the
  /// variances of the images' motions, by the squares of the motions.
  Eigen::Vector2d varianceComponents(const std::vector<Comparison>& comparisons,
                                     const Eigen::Vector2d& before,
                                     const std::vector<int>& axes) const {
    // Per metre and per rad.
    constexpr double kLeast = 5e-4 * 5e-4;
    Eigen::Matrix2d matrix = Eigen::Matrix2d::Zero();
    Eigen::Vector2d right = Eigen::Vector2d::Zero();
    for (const Comparison& comparison : comparisons) {
      const Eigen::Vector2d& squares = comparison.motion->squares;
      const double robust = weightOf(comparison);
      for (const int axis : axes) {
        const double by_images = comparison.motion->covariance(axis, axis);
        const double variance = before.dot(squares) + by_images + kResolution * kResolution;
        const double weight = robust / (variance * variance);
        const double observed = std::pow(comparison.residual(axis), 2) - by_images;
        matrix += weight * squares * squares.transpose();
        right += weight * observed * squares;
      }
    }
    Eigen::Vector2d components = matrix.ldlt().solve(right);
    for (int i = 0; i < 2; ++i) {
      const int other = 1 - i;
      if (components(i) >= kLeast) continue;
      components(i) = kLeast;
      components(other) = (right(other) - matrix(other, i) * kLeast) / matrix(other, other);
    }
    if (!components.allFinite()) return before;
    return components.cwiseMax(kLeast);
  }

  const OdometryAt& odometry_;
  OdometryNoise noise_;
  std::vector<Motion> motions_;
};

}  // namespace

OffsetFit fitOffset(const std::vector<MovingFrame>& frames, const OdometryAt& odometry,
                    const MotionModelConfig& config) {
  return OffsetFitter(frames, odometry, config).run();
}

}  // namespace omnitag
