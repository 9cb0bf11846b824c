#include "adjustment/remaining_uncertainty.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "omnitag/common/angle.h"

namespace omnitag {
namespace {

/// A point that a pixel sees, in base_link.
struct SeenPoint {
  Eigen::Vector2d pixel;
  Eigen::Vector3d in_base;
};

/// Points all over the field, at the distance of typical markers.
std::vector<SeenPoint> pointsSeenBy(const MountedCamera& camera, double circle) {
  constexpr double kRange = 3.0;                                        // m
  constexpr std::array<double, 5> kShares{0.25, 0.4, 0.55, 0.7, 0.85};  // of the circle's radius
  constexpr int kDirections = 16;
  const Eigen::Vector2d center = camera.model().imagePlane().principalPoint();
  std::vector<SeenPoint> points;
  for (const double share : kShares) {
    for (int i = 0; i < kDirections; ++i) {
      const double azimuth = 2.0 * kPi * i / kDirections;
      const Eigen::Vector2d pixel =
          center + share * circle * Eigen::Vector2d(std::cos(azimuth), std::sin(azimuth));
      const std::optional<Ray> ray = camera.rayInBase(pixel);
      if (ray) points.push_back({pixel, ray->origin + kRange * ray->direction});
    }
  }
  return points;
}

/// Amplitudes of the modes (one pixel each) whose displacements are most like those from a change
/// of the parameters.
Eigen::Matrix<double, kCameraModes, 1> modesOf(const MountedCamera& larger,
                                               const MountedCamera& smaller,
                                               const std::vector<SeenPoint>& points,
                                               double circle) {
  constexpr CameraUncertainty kOnePixel{1.0, 1.0, 1.0, 1.0};
  const Eigen::Vector2d center = larger.model().imagePlane().principalPoint();
  std::vector<Eigen::Vector2d> displacements;
  Eigen::MatrixXd by_modes(2 * static_cast<Eigen::Index>(points.size()), kCameraModes);
  for (const SeenPoint& point : points) {
    const auto a = larger.pixelFromMap(Pose{}, point.in_base);
    const auto b = smaller.pixelFromMap(Pose{}, point.in_base);
    if (!a || !b) continue;
    by_modes.middleRows<2>(2 * static_cast<Eigen::Index>(displacements.size())) =
        displacementByError(kOnePixel, (point.pixel - center) / circle);
    displacements.emplace_back(0.5 * (*a - *b));
  }
  const auto rows = 2 * static_cast<Eigen::Index>(displacements.size());
  if (rows < Eigen::Index{2} * kCameraModes) return Eigen::Matrix<double, kCameraModes, 1>::Zero();
  const Eigen::Map<const Eigen::VectorXd> displaced(displacements.front().data(), rows);
  return by_modes.topRows(rows).colPivHouseholderQr().solve(displaced);
}

}  // namespace

CameraUncertainty remainingUncertainty(const CalibrationModel& model, const Eigen::VectorXd& values,
                                       const ParameterUncertainty& left, double common_error) {
  if (left.free.empty()) return {common_error, common_error, common_error, common_error};
  const double circle = model.camera().circle();
  const std::vector<SeenPoint> points = pointsSeenBy(model.mounted(values), circle);
  // Independent changes of the parameters that together make up their covariance.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(left.correlations);
  const Eigen::MatrixXd changes = left.deviations.asDiagonal() * eigen.eigenvectors() *
                                  eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
  Eigen::Matrix<double, kCameraModes, 1> variances;
  variances.setConstant(common_error * common_error);
  for (Eigen::Index k = 0; k < changes.cols(); ++k) {
    Eigen::VectorXd change = Eigen::VectorXd::Zero(values.size());
    for (std::size_t i = 0; i < left.free.size(); ++i) {
      change(left.free[i]) = changes(static_cast<Eigen::Index>(i), k);
    }
    const auto modes =
        modesOf(model.mounted(values + change), model.mounted(values - change), points, circle);
    variances += modes.cwiseAbs2();
  }
  return {std::sqrt(0.5 * (variances[0] + variances[1])), std::sqrt(variances[2]),
          std::sqrt(0.5 * (variances[3] + variances[4])), std::sqrt(variances[5])};
}

}  // namespace omnitag
