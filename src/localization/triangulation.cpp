#include "localization/triangulation.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "omnitag/common/angle.h"

namespace omnitag {
namespace {

Eigen::Rotation2Dd rotation(double yaw) { return Eigen::Rotation2Dd(yaw); }

/// The lines of sight at a given heading, a x + b y + c = 0 for the robot's position (x, y), times
/// the square root of their weights, and their derivatives with respect to the heading.
struct Lines {
  Eigen::MatrixX2d normals;  // rows (a, b)
  Eigen::VectorXd offsets;   // c
  Eigen::MatrixX2d normals_by_yaw;
  Eigen::VectorXd offsets_by_yaw;
  Eigen::VectorXd offsets_by_yaw_twice;
};

Lines linesAt(const std::vector<LandmarkBearing>& sights, double yaw) {
  const auto count = static_cast<Eigen::Index>(sights.size());
  Lines lines{Eigen::MatrixX2d(count, 2), Eigen::VectorXd(count), Eigen::MatrixX2d(count, 2),
              Eigen::VectorXd(count), Eigen::VectorXd(count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const LandmarkBearing& sight = sights[static_cast<std::size_t>(i)];
    const double phi = yaw + sight.bearing;
    const double scale = std::sqrt(sight.weight);
    const Eigen::Vector2d normal = scale * Eigen::Vector2d(std::sin(phi), -std::cos(phi));
    const Eigen::Vector2d normal_by_yaw = scale * Eigen::Vector2d(std::cos(phi), std::sin(phi));
    // The line passes through the landmark; the robot is at the viewpoint minus the mounting. Both
    // the normal and the mounting turn with the heading, so their product is constant.
    lines.normals.row(i) = normal;
    lines.normals_by_yaw.row(i) = normal_by_yaw;
    const double mounting = normal.dot(rotation(yaw) * sight.viewpoint);
    lines.offsets(i) = mounting - normal.dot(sight.landmark);
    lines.offsets_by_yaw(i) = -normal_by_yaw.dot(sight.landmark);
    lines.offsets_by_yaw_twice(i) = normal.dot(sight.landmark);
  }
  return lines;
}

}  // namespace

std::optional<PoseEstimate> triangulate(const std::vector<LandmarkBearing>& sights,
                                        double initial_yaw) {
  if (sights.size() < 3) return std::nullopt;

  constexpr int kMaxIterations = 50;
  constexpr double kTolerance = 1e-12;
  constexpr double kMaxStep = 0.2;
  constexpr double kSmallestDeterminant = 1e-9;
  double yaw = initial_yaw;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  Lines lines;
  for (int i = 0; i < kMaxIterations; ++i) {
    lines = linesAt(sights, yaw);
    const Eigen::Matrix2d normal_matrix = lines.normals.transpose() * lines.normals;
    const auto count = static_cast<double>(sights.size());
    if (normal_matrix.determinant() < kSmallestDeterminant * count * count) return std::nullopt;
    const Eigen::Matrix2d inverse = normal_matrix.inverse();
    position = -inverse * (lines.normals.transpose() * lines.offsets);  // Eqn 1

    // Newton on half of Eqn 2 as a function of the heading alone, the position following Eqn 1.
    const Eigen::VectorXd distance = lines.normals * position + lines.offsets;
    const Eigen::VectorXd distance_by_yaw = lines.normals_by_yaw * position + lines.offsets_by_yaw;
    const Eigen::VectorXd distance_by_yaw_twice =
        -lines.normals * position + lines.offsets_by_yaw_twice;
    const double gradient = distance.dot(distance_by_yaw);
    const Eigen::Vector2d mixed =
        lines.normals.transpose() * distance_by_yaw + lines.normals_by_yaw.transpose() * distance;
    const double curvature = distance_by_yaw.squaredNorm() + distance.dot(distance_by_yaw_twice) -
                             mixed.dot(inverse * mixed);
    // If the curvature is not positive, Newton would climb to a maximum: go downhill instead.
    double step = curvature > 0.0 ? -gradient / curvature : -std::copysign(kMaxStep, gradient);
    step = std::clamp(step, -kMaxStep, kMaxStep);
    yaw += step;
    if (std::abs(step) < kTolerance) break;
    if (i + 1 == kMaxIterations) return std::nullopt;
  }

  for (const LandmarkBearing& sight : sights) {
    const Eigen::Vector2d viewpoint = position + rotation(yaw) * sight.viewpoint;
    const double phi = yaw + sight.bearing;
    const Eigen::Vector2d direction(std::cos(phi), std::sin(phi));
    if (direction.dot(sight.landmark - viewpoint) <= 0.0) return std::nullopt;
  }

  // Each distance errs by its bearing's error times its range, and by its landmark's error; the
  // pose is linear in the distances. If the distances are larger than that explains, so is the
  // covariance.
  const auto count = static_cast<Eigen::Index>(sights.size());
  Eigen::MatrixX3d jacobian(count, 3);
  jacobian << lines.normals, lines.normals_by_yaw * position + lines.offsets_by_yaw;
  const Eigen::VectorXd distance = lines.normals * position + lines.offsets;
  Eigen::VectorXd deviations(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const LandmarkBearing& sight = sights[static_cast<std::size_t>(i)];
    const double range = (position + rotation(yaw) * sight.viewpoint - sight.landmark).norm();
    deviations(i) = std::sqrt(sight.weight) *
                    std::hypot(range * sight.bearing_deviation, sight.landmark_deviation);
  }
  const Eigen::FullPivLU<Eigen::Matrix3d> factors(jacobian.transpose() * jacobian);
  if (!factors.isInvertible()) return std::nullopt;
  const Eigen::Matrix3Xd gain = factors.inverse() * jacobian.transpose();
  const double freedom = std::max(1.0, static_cast<double>(sights.size()) - 3.0);
  const double squares = (distance.array() / deviations.array()).square().sum();
  return floorEstimate({position.x(), position.y(), normalizeAngle(yaw)},
                       std::max(1.0, squares / freedom) * gain *
                           deviations.cwiseAbs2().asDiagonal() * gain.transpose());
}

}  // namespace omnitag
