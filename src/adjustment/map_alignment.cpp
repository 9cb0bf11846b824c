#include "adjustment/map_alignment.h"

#include <algorithm>
#include <cmath>

#include "adjustment/outliers.h"
#include "common/format.h"
#include "omnitag/common/angle.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

Eigen::Vector2d placeOf(const Pose& pose) { return {pose.x, pose.y}; }

Eigen::Vector2d transformed(const Pose& other_from_map, const Eigen::Vector2d& point) {
  return placeOf(other_from_map) + Eigen::Rotation2Dd(other_from_map.yaw) * point;
}

/// The planar transform that fits weighted points best; each heading counts by `heading_weight`
/// (1/rad^2, relative to 1/m^2 for a point).
Pose bestFit(const std::vector<PosePair>& pairs, const Eigen::VectorXd& weights,
             double heading_weight) {
  const double sum = weights.sum();
  Eigen::Vector2d middle_in_map = Eigen::Vector2d::Zero();
  Eigen::Vector2d middle_in_other = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double share = weights(static_cast<Eigen::Index>(i)) / sum;
    middle_in_map += share * placeOf(pairs[i].in_map);
    middle_in_other += share * placeOf(pairs[i].in_other);
  }
  // Weighted sums of the sine and cosine of the angle given by each pair.
  double sine = 0.0;
  double cosine = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double weight = weights(static_cast<Eigen::Index>(i));
    const Eigen::Vector2d a = placeOf(pairs[i].in_map) - middle_in_map;
    const Eigen::Vector2d b = placeOf(pairs[i].in_other) - middle_in_other;
    const double turn = pairs[i].in_other.yaw - pairs[i].in_map.yaw;
    sine += weight * (a.x() * b.y() - a.y() * b.x() + heading_weight * std::sin(turn));
    cosine += weight * (a.dot(b) + heading_weight * std::cos(turn));
  }
  Pose fit;
  fit.yaw = std::atan2(sine, cosine);
  const Eigen::Vector2d shift = middle_in_other - Eigen::Rotation2Dd(fit.yaw) * middle_in_map;
  fit.x = shift.x();
  fit.y = shift.y();
  return fit;
}

/// The share of the errors in a sequence that count as independent, from the correlation of
/// successive ones.
double independentShare(const std::vector<Eigen::Vector2d>& errors) {
  double together = 0.0;
  double alone = 0.0;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    alone += errors[i].squaredNorm();
    if (i > 0) together += errors[i].dot(errors[i - 1]);
  }
  const double correlation = alone > 0.0 ? std::clamp(together / alone, 0.0, 0.98) : 0.0;
  return (1.0 - correlation) / (1.0 + correlation);
}

/// Covariance of the fit, about the middle of the points that agree, if their errors have these
/// variances.
Eigen::Matrix3d covarianceOf(const std::vector<PosePair>& pairs, const std::vector<bool>& agrees,
                             double position_variance, double heading_variance) {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  double count = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (!agrees[i]) continue;
    middle += placeOf(pairs[i].in_other);
    count += 1.0;
  }
  middle /= count;
  double spread = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (agrees[i]) spread += (placeOf(pairs[i].in_other) - middle).squaredNorm();
  }
  double heading_information = spread / position_variance;
  if (heading_variance > 0.0) heading_information += count / heading_variance;
  const double position = position_variance / count;
  return Eigen::Vector3d(position, position, 1.0 / heading_information).asDiagonal();
}

}  // namespace

double MapAlignment::positionDeviation() const {
  return std::sqrt(covariance.topLeftCorner<2, 2>().trace());
}

double MapAlignment::headingDeviation() const { return std::sqrt(covariance(2, 2)); }

MapAlignment alignByPoses(const std::vector<PosePair>& pairs) {
  constexpr std::size_t kFewest = 3;
  constexpr int kRounds = 30;
  constexpr double kMedians = 3.0;  // beyond, a pair does not agree
  constexpr double kLeast = 1e-4;   // m and rad: nothing is fitted more exactly
  constexpr double kLever = 1.0;    // m: a heading counts as a point this far away
  if (pairs.size() < kFewest) {
    throw InputError(format("poses of the other localizer: expected at least %zu, found %zu",
                            kFewest, pairs.size()));
  }
  const auto size = static_cast<Eigen::Index>(pairs.size());
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(size);
  MapAlignment alignment;
  std::vector<Eigen::Vector2d> errors(pairs.size());
  std::vector<double> turns(pairs.size());
  std::vector<bool> agrees(pairs.size());
  for (int round = 0; round < kRounds; ++round) {
    alignment.other_from_map = bestFit(pairs, weights, kLever * kLever);
    std::vector<double> lengths;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      errors[i] = transformed(alignment.other_from_map, placeOf(pairs[i].in_map)) -
                  placeOf(pairs[i].in_other);
      turns[i] = normalizeAngle(pairs[i].in_map.yaw + alignment.other_from_map.yaw -
                                pairs[i].in_other.yaw);
      lengths.push_back(std::hypot(errors[i].norm(), kLever * turns[i]));
    }
    const double limit = kMedians * std::max(medianOf(lengths), kLeast);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      agrees[i] = lengths[i] <= limit;
      const double share = lengths[i] / limit;
      weights(static_cast<Eigen::Index>(i)) = 1.0 / (1.0 + std::pow(share, 4));
    }
  }
  double position_squares = 0.0;
  double heading_squares = 0.0;
  std::vector<Eigen::Vector2d> agreeing;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (!agrees[i]) continue;
    position_squares += errors[i].squaredNorm();
    heading_squares += turns[i] * turns[i];
    agreeing.push_back(errors[i]);
  }
  alignment.all = pairs.size();
  alignment.agreeing = agreeing.size();
  if (2 * alignment.agreeing < alignment.all) {
    throw InputError(format(
        "poses of the other localizer: %zu of %zu agree with the map that was built: is it lost?",
        alignment.agreeing, alignment.all));
  }
  const auto count = static_cast<double>(alignment.agreeing);
  alignment.position_residual = std::sqrt(position_squares / count);
  alignment.heading_residual = std::sqrt(heading_squares / count);
  const double share = independentShare(agreeing);
  const double position = std::max(alignment.position_residual, kLeast);
  const double heading = std::max(alignment.heading_residual, kLeast);
  alignment.covariance =
      covarianceOf(pairs, agrees, 0.5 * position * position / share, heading * heading / share);
  return alignment;
}

MapAlignment alignByPoints(const std::vector<PointPair>& pairs) {
  constexpr std::size_t kFewest = 2;
  constexpr double kNear = 0.5;  // m
  if (pairs.size() < kFewest) {
    throw InputError(format("points: expected at least %zu, found %zu", kFewest, pairs.size()));
  }
  double farthest = 0.0;
  std::vector<PosePair> poses;
  for (const PointPair& pair : pairs) {
    farthest = std::max(farthest, (pair.in_other - pairs.front().in_other).norm());
    poses.push_back(
        {{pair.in_map.x(), pair.in_map.y(), 0.0}, {pair.in_other.x(), pair.in_other.y(), 0.0}});
  }
  if (farthest < kNear) {
    throw InputError(
        format("points: expected some that are %.1f m apart, found %.2f m", kNear, farthest));
  }
  const auto size = static_cast<Eigen::Index>(pairs.size());
  MapAlignment alignment;
  alignment.other_from_map = bestFit(poses, Eigen::VectorXd::Ones(size), 0.0);
  double squares = 0.0;
  for (const PosePair& pair : poses) {
    squares +=
        (transformed(alignment.other_from_map, placeOf(pair.in_map)) - placeOf(pair.in_other))
            .squaredNorm();
  }
  alignment.all = pairs.size();
  alignment.agreeing = pairs.size();
  alignment.position_residual = std::sqrt(squares / static_cast<double>(size));
  // Variance of each coordinate: each point has two, and the fit uses up three.
  constexpr double kLeast = 1e-6;  // m
  const double variance =
      std::max(squares, kLeast * kLeast) / (2.0 * static_cast<double>(size) - 3.0);
  alignment.covariance = covarianceOf(poses, std::vector<bool>(pairs.size(), true), variance, 0.0);
  return alignment;
}

}  // namespace omnitag
