#include "omnitag/localization/reprojection.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "omnitag/common/angle.h"

namespace omnitag {
namespace {

/// The problem linearised at a pose: J^T W J, J^T W r and the cost that the step should lower.
struct Linearization {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  double cost = 0.0;
  double weighted_squares = 0.0;
  std::vector<double> residuals;
};

class Problem {
 public:
  Problem(const MarkerMap& map, const MountedCamera& camera,
          const std::vector<MarkerObservation>& observations,
          const std::optional<PoseEstimate>& prior, const ReprojectionConfig& config)
      : camera_(camera), observations_(observations), prior_(prior), config_(config) {
    corners_.reserve(observations.size());
    for (const MarkerObservation& observation : observations) {
      corners_.push_back(map.markers[observation.map_entry].corners());
    }
    if (prior_) prior_information_ = prior_->covariance.inverse();
  }

  Linearization linearize(const Pose2& pose) const {
    Linearization linear;
    if (prior_) {
      const Eigen::Vector3d error = difference(pose, prior_->pose);
      linear.information = prior_information_;
      linear.gradient = prior_information_ * error;
      linear.cost = 0.5 * error.dot(prior_information_ * error);
    }
    for (std::size_t i = 0; i < observations_.size(); ++i) addMarker(pose, i, &linear);
    return linear;
  }

 private:
  void addMarker(const Pose2& pose, std::size_t index, Linearization* linear) const {
    const double noise_square = config_.corner_noise * config_.corner_noise;
    const double width_square = config_.robust_width * config_.robust_width;
    double squares = 0.0;
    for (std::size_t k = 0; k < corners_[index].size(); ++k) {
      Eigen::Matrix<double, 2, 3> by_pose;
      const auto pixel = camera_.pixelFromMap(pose, corners_[index][k], &by_pose);
      Eigen::Vector2d residual(kHiddenResidual, 0.0);
      if (pixel) {
        residual = *pixel - observations_[index].corners[k];
        // The derivative of Cauchy's function below by half of the square.
        const double weight = 1.0 / ((1.0 + residual.squaredNorm() / width_square) * noise_square);
        linear->information += weight * by_pose.transpose() * by_pose;
        linear->gradient += weight * by_pose.transpose() * residual;
        linear->weighted_squares += weight * residual.squaredNorm();
        squares += residual.squaredNorm();
      } else {
        squares = std::numeric_limits<double>::infinity();
      }
      linear->cost +=
          0.5 * width_square / noise_square * std::log1p(residual.squaredNorm() / width_square);
    }
    linear->residuals.push_back(std::sqrt(squares / 4.0));
  }

  /// Pixels; a corner that the pose hides costs as much as one this far off.
  static constexpr double kHiddenResidual = 1e3;

  const MountedCamera& camera_;
  const std::vector<MarkerObservation>& observations_;
  std::optional<PoseEstimate> prior_;
  ReprojectionConfig config_;
  std::vector<Corners<Eigen::Vector3d>> corners_;
  Eigen::Matrix3d prior_information_ = Eigen::Matrix3d::Zero();
};

/// Levenberg-Marquardt until a step, which is still taken, is shorter than the tolerance (m and
/// rad); nothing where the pose is not determined.
std::optional<Pose2> descend(const Problem& problem, const Pose2& initial, double tolerance) {
  constexpr int kMaxIterations = 100;
  Pose2 pose = initial;
  Linearization linear = problem.linearize(pose);
  double damping = 1e-6;
  for (int i = 0; i < kMaxIterations; ++i) {
    Eigen::Matrix3d damped = linear.information;
    damped.diagonal() *= 1.0 + damping;
    const Eigen::LLT<Eigen::Matrix3d> factors(damped);
    if (factors.info() != Eigen::Success) return std::nullopt;
    const Eigen::Vector3d step = -factors.solve(linear.gradient);
    if (!step.allFinite()) return std::nullopt;
    const Pose2 next{pose.x + step.x(), pose.y + step.y(), normalizeAngle(pose.yaw + step.z())};
    if (step.norm() < tolerance) return next;
    Linearization there = problem.linearize(next);
    if (there.cost <= linear.cost) {
      pose = next;
      linear = std::move(there);
      damping = std::max(damping * 0.1, 1e-9);
    } else {
      damping = std::max(damping * 10.0, 1e-4);
    }
  }
  return pose;
}

}  // namespace

std::optional<ReprojectionFit> refineByReprojection(
    const MarkerMap& map, const MountedCamera& camera,
    const std::vector<MarkerObservation>& observations, const Pose2& initial,
    const std::optional<PoseEstimate>& prior, const ReprojectionConfig& config) {
  // What is left then is far less.
  constexpr double kTolerance = 1e-6;
  const Problem problem(map, camera, observations, prior, config);
  const std::optional<Pose2> pose = descend(problem, initial, kTolerance);
  if (!pose) return std::nullopt;
  Linearization linear = problem.linearize(*pose);

  // An information matrix without a direction says nothing about the pose along it.
  constexpr double kSmallestEigenvalue = 1e-9;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(linear.information);
  if (!(eigen.eigenvalues()(0) > kSmallestEigenvalue * eigen.eigenvalues()(2))) {
    return std::nullopt;
  }
  ReprojectionFit fit;
  fit.map_from_base.pose = *pose;
  fit.map_from_base.covariance = linear.information.inverse();
  fit.residuals = std::move(linear.residuals);
  fit.weighted_squares = linear.weighted_squares;
  return fit;
}

std::optional<ReprojectionFit> refineFromAfar(const MarkerMap& map, const MountedCamera& camera,
                                              const std::vector<MarkerObservation>& observations,
                                              const Pose2& initial,
                                              const std::optional<PoseEstimate>& prior,
                                              const ReprojectionConfig& config) {
  constexpr std::array<double, 2> kWidths = {16.0, 2.0};  // pixels
  // From where the next one finds its way.
  constexpr double kTolerance = 1e-3;
  Pose2 pose = initial;
  for (const double width : kWidths) {
    ReprojectionConfig wide = config;
    wide.robust_width = std::max(width, config.robust_width);
    const auto end = descend(Problem(map, camera, observations, prior, wide), pose, kTolerance);
    if (end) pose = *end;
  }
  return refineByReprojection(map, camera, observations, pose, prior, config);
}

double varianceFactor(const ReprojectionFit& fit) {
  constexpr double kResidualsPerMarker = 8.0;
  const double freedom = kResidualsPerMarker * static_cast<double>(fit.residuals.size()) - 3.0;
  return std::max(1.0, fit.weighted_squares / freedom);
}

std::vector<double> reprojectionResiduals(const MarkerMap& map, const MountedCamera& camera,
                                          const std::vector<MarkerObservation>& observations,
                                          const Pose2& map_from_base) {
  return Problem(map, camera, observations, std::nullopt, {}).linearize(map_from_base).residuals;
}

}  // namespace omnitag
