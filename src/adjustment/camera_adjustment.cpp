#include "omnitag/adjustment/camera_adjustment.h"

#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <memory>
#include <tuple>
#include <utility>

#include "../common/least_squares.h"
#include "omnitag/common/error.h"
#include "perturbed_cameras.h"

namespace omnitag {
namespace {

/// Pixels, of a corner that the camera would not see.
constexpr double kHidden = 300.0;

constexpr int kPoseSize = std::tuple_size<PoseBlock>::value;

/// A corner as a function of the shared parameters (where any is free) and of its frame's pose.
class CornerCost final : public ceres::CostFunction {
 public:
  CornerCost(PerturbedCameras* cameras, const Eigen::Vector3d& point, const Eigen::Vector2d& pixel)
      : cameras_(cameras), point_(point), pixel_(pixel) {
    set_num_residuals(2);
    if (cameras->size() > 0) {
      mutable_parameter_block_sizes()->push_back(static_cast<int>(cameras->size()));
    }
    mutable_parameter_block_sizes()->push_back(kPoseSize);
  }

  bool Evaluate(const double* const* parameters, double* residuals,
                double** jacobians) const override {
    const bool has_shared = cameras_->size() > 0;
    double* by_shared = jacobians != nullptr && has_shared ? jacobians[0] : nullptr;
    double* by_pose = jacobians != nullptr ? jacobians[has_shared ? 1 : 0] : nullptr;
    const double* pose = parameters[has_shared ? 1 : 0];
    if (!cameras_->moveTo(has_shared ? parameters[0] : nullptr, by_shared != nullptr)) return false;

    Eigen::Matrix2Xd shared_jacobian = Eigen::Matrix2Xd::Zero(2, cameras_->size());
    Eigen::Matrix<double, 2, 3> pose_jacobian = Eigen::Matrix<double, 2, 3>::Zero();
    const auto image =
        cameras_->project(poseOf(pose), point_, by_shared != nullptr ? &shared_jacobian : nullptr,
                          by_pose != nullptr ? &pose_jacobian : nullptr);
    const Eigen::Vector2d residual = image ? Eigen::Vector2d(*image - pixel_) : hiddenResidual();
    std::copy_n(residual.data(), 2, residuals);
    copyRows(shared_jacobian, by_shared);
    copyRows(pose_jacobian, by_pose);
    return true;
  }

 private:
  static Eigen::Vector2d hiddenResidual() { return {kHidden, 0.0}; }

  /// Ceres stores row by row.
  template <typename Matrix>
  static void copyRows(const Matrix& matrix, double* rows) {
    if (rows == nullptr) return;
    for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
      for (Eigen::Index column = 0; column < matrix.cols(); ++column) {
        *rows++ = matrix(row, column);
      }
    }
  }

  PerturbedCameras* cameras_;
  Eigen::Vector3d point_;
  Eigen::Vector2d pixel_;
};

/// How far the shared parameters are from the guess: hardly more than nothing beside what the
/// images tell, but where they tell nothing, as along the valley in which a mirror that is farther
/// away and a longer lens image alike, it keeps the solution from running off.
class GuessCost final : public ceres::CostFunction {
 public:
  /// `start`: where the offsets are counted from, in scales from the guess.
  explicit GuessCost(Eigen::VectorXd start) : start_(std::move(start)) {
    set_num_residuals(static_cast<int>(start_.size()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(start_.size()));
  }

  bool Evaluate(const double* const* parameters, double* residuals,
                double** jacobians) const override {
    constexpr double kNoise = 0.05;  // pixels, of a corner
    constexpr double kScales = 4.0;  // by which a guess may be off
    constexpr double kWeight = kNoise / kScales;
    const Eigen::Index size = start_.size();
    Eigen::Map<Eigen::VectorXd>(residuals, size) =
        kWeight * (start_ + Eigen::Map<const Eigen::VectorXd>(parameters[0], size));
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      Eigen::Map<Eigen::MatrixXd>(jacobians[0], size, size) =
          kWeight * Eigen::MatrixXd::Identity(size, size);
    }
    return true;
  }

 private:
  Eigen::VectorXd start_;
};

class ProgressCallback final : public ceres::IterationCallback {
 public:
  explicit ProgressCallback(const BundleAdjustment::Progress& progress) : progress_(progress) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    if (summary.iteration == 0) start_ = summary.cost;
    if (progress_) progress_(summary.iteration, start_ > 0.0 ? summary.cost / start_ : 0.0);
    return ceres::SOLVER_CONTINUE;
  }

 private:
  const BundleAdjustment::Progress& progress_;
  double start_ = 0.0;
};

/// What one frame adds to the information.
struct FrameInformation {
  Eigen::MatrixXd shared;
  Eigen::MatrixX3d mixed;
  Eigen::Matrix3d pose = Eigen::Matrix3d::Zero();
  Eigen::MatrixX2d shared_gradient;
  Eigen::Matrix<double, 3, 2> pose_gradient = Eigen::Matrix<double, 3, 2>::Zero();
  double weighted_squares = 0.0;
  int corners = 0;

  explicit FrameInformation(Eigen::Index size)
      : shared(Eigen::MatrixXd::Zero(size, size)),
        mixed(Eigen::MatrixX3d::Zero(size, 3)),
        shared_gradient(Eigen::MatrixX2d::Zero(size, 2)) {}

  void add(const Eigen::Matrix2Xd& by_shared, const Eigen::Matrix<double, 2, 3>& by_pose,
           const Eigen::Matrix2d& common_errors, double weight) {
    shared += weight * by_shared.transpose() * by_shared;
    mixed += weight * by_shared.transpose() * by_pose;
    pose += weight * by_pose.transpose() * by_pose;
    shared_gradient += weight * by_shared.transpose() * common_errors;
    pose_gradient += weight * by_pose.transpose() * common_errors;
    ++corners;
  }
};

}  // namespace

BundleAdjustment::BundleAdjustment(const MarkerMap& map,
                                   const std::vector<CalibrationFrame>& frames,
                                   const CalibrationModel& model)
    : map_(map), frames_(frames), model_(model) {}

Eigen::VectorXd BundleAdjustment::offsetsOf(const Eigen::VectorXd& values,
                                            const std::vector<Eigen::Index>& indices) const {
  Eigen::VectorXd offsets(static_cast<Eigen::Index>(indices.size()));
  std::transform(indices.begin(), indices.end(), offsets.data(), [&](Eigen::Index index) {
    const CalibrationParameter& parameter = model_.parameters()[static_cast<std::size_t>(index)];
    return (values(index) - parameter.value) / parameter.scale;
  });
  return offsets;
}

CalibrationState BundleAdjustment::minimize(const CalibrationState& start,
                                            const AdjustmentConfig& config,
                                            const Progress& progress) const {
  PerturbedCameras cameras(model_, start.values, config.free);
  std::vector<double> shared(config.free.size(), 0.0);
  std::vector<PoseBlock> poses;
  poses.reserve(start.poses.size());
  for (const Pose& pose : start.poses) poses.push_back(blockOf(pose));

  ceres::CauchyLoss loss(config.robust_width);
  std::vector<std::unique_ptr<CornerCost>> costs;
  GuessCost guess_cost(offsetsOf(start.values, config.free));
  ceres::Problem problem(notOwning());
  if (!shared.empty()) problem.AddResidualBlock(&guess_cost, nullptr, shared.data());
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    for (const MarkerObservation& observation : frames_[i].observations) {
      const auto corners = map_.markers[observation.map_entry].corners();
      for (std::size_t k = 0; k < corners.size(); ++k) {
        costs.push_back(std::make_unique<CornerCost>(&cameras, corners[k], observation.corners[k]));
        std::vector<double*> blocks = {poses[i].data()};
        if (!shared.empty()) blocks.insert(blocks.begin(), shared.data());
        problem.AddResidualBlock(costs.back().get(), &loss, blocks);
      }
    }
    if (!config.adjusts_poses) problem.SetParameterBlockConstant(poses[i].data());
  }

  ProgressCallback callback(progress);
  ceres::Solver::Options options = solverOptions(ceres::DENSE_SCHUR, config.max_iterations);
  options.parameter_tolerance = 1e-10;
  options.callbacks.push_back(&callback);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable()) return start;

  CalibrationState state;
  state.values = cameras.valuesAt(shared.data());
  for (const auto& pose : poses) state.poses.push_back(poseOf(pose.data()));
  return state;
}

std::vector<CornerResidual> BundleAdjustment::residuals(const CalibrationState& state) const {
  PerturbedCameras cameras(model_, state.values, {});
  if (!cameras.moveTo(nullptr, false)) throw InputError("these numbers make no camera");
  std::vector<CornerResidual> residuals;
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    for (const MarkerObservation& observation : frames_[i].observations) {
      const auto corners = map_.markers[observation.map_entry].corners();
      for (std::size_t k = 0; k < corners.size(); ++k) {
        const Eigen::Vector2d& pixel = observation.corners[k];
        const auto image = cameras.project(state.poses[i], corners[k], nullptr, nullptr);
        std::optional<Eigen::Vector2d> residual;
        if (image) residual = *image - pixel;
        residuals.push_back({i, observation.map_entry, pixel, residual});
      }
    }
  }
  return residuals;
}

AdjustmentInformation BundleAdjustment::information(const CalibrationState& state,
                                                    const AdjustmentConfig& config) const {
  PerturbedCameras cameras(model_, state.values, config.free);
  const std::vector<double> offsets(config.free.size(), 0.0);
  if (!cameras.moveTo(offsets.data(), true)) throw InputError("these numbers make no camera");

  const double width_square = config.robust_width * config.robust_width;
  const Eigen::Index size = cameras.size();
  AdjustmentInformation information;
  information.matrix = Eigen::MatrixXd::Zero(size, size);
  information.common_error_gradient = Eigen::MatrixX2d::Zero(size, 2);
  const Eigen::Vector2d centre = model_.mounted(state.values).model().imagePlane().principalPoint();
  double weighted_squares = 0.0;
  double freedom = -static_cast<double>(size);
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    FrameInformation frame(size);
    for (const MarkerObservation& observation : frames_[i].observations) {
      const auto corners = map_.markers[observation.map_entry].corners();
      for (std::size_t k = 0; k < corners.size(); ++k) {
        Eigen::Matrix2Xd by_shared;
        Eigen::Matrix<double, 2, 3> by_pose;
        const auto image = cameras.project(state.poses[i], corners[k], &by_shared, &by_pose);
        if (!image) continue;
        const double squares = (*image - observation.corners[k]).squaredNorm();
        const double weight = 1.0 / (1.0 + squares / width_square);
        Eigen::Matrix2d common_errors;
        common_errors.col(0) = (observation.corners[k] - centre).normalized();
        common_errors.col(1) = (observation.corners[k] - observation.center).normalized();
        frame.add(by_shared, by_pose, common_errors, weight);
        frame.weighted_squares += weight * squares;
      }
    }
    const Eigen::LDLT<Eigen::Matrix3d> factors(frame.pose);
    if (frame.corners < 2 || !factors.isPositive()) continue;
    information.common_error_gradient +=
        frame.shared_gradient - frame.mixed * factors.solve(frame.pose_gradient);
    information.matrix += frame.shared - frame.mixed * factors.solve(frame.mixed.transpose());
    weighted_squares += frame.weighted_squares;
    freedom += 2.0 * frame.corners - kPoseSize;
  }
  information.noise = std::sqrt(weighted_squares / std::max(1.0, freedom));
  return information;
}

}  // namespace omnitag
