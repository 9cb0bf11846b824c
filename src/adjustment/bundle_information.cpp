#include <ceres/crs_matrix.h>

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <utility>

#include "adjustment/bundle_adjustment.h"
#include "adjustment/bundle_problem.h"
#include "adjustment/undetermined.h"
#include "common/rotation.h"

namespace omnitag {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

/// The derivatives of all terms by the estimated blocks: first the poses, then the wanted ones,
/// which are the places, the sizes and the camera.
class Linearization {
 public:
  Linearization(const Bundle& bundle, const BundleConfig& config)
      : bundle_(bundle), problem_(bundle, config) {
    for (std::size_t i = 0; i < bundle.frames.size(); ++i) addBlock(problem_.poseBlock(i), 6);
    poses_ = unknowns_;
    for (std::size_t i = 0; i < bundle.landmarks.size(); ++i) {
      place_.push_back(addBlock(problem_.placeBlock(i), 6) - poses_);
      size_.push_back(addBlock(problem_.sizeBlock(i), 1) - poses_);
    }
    wanted_before_camera_ = unknowns_ - poses_;
    addBlock(problem_.cameraBlock(), static_cast<Eigen::Index>(config.free.size()));
    evaluate();
  }

  Eigen::Index wanted() const { return unknowns_ - poses_; }
  Eigen::Index camera() const { return wanted() - wanted_before_camera_; }
  /// Indices of a landmark's place and size among the wanted unknowns; negative if they are held.
  Eigen::Index placeOf(std::size_t landmark) const { return place_[landmark]; }
  Eigen::Index sizeOf(std::size_t landmark) const { return size_[landmark]; }

  /// The noise that the residuals show, relative to the assumed noise.
  double noise() const {
    return std::sqrt(weighted_squares_ /
                     std::max(1.0, 8.0 * static_cast<double>(bundle_.observations.size()) -
                                       static_cast<double>(unknowns_)));
  }

  /// The information of the wanted unknowns with the poses eliminated; likewise the gradients of
  /// common errors (a column for each way that all residuals may err in common).
  Eigen::MatrixXd reduced(const Eigen::MatrixX2d& common_errors,
                          Eigen::MatrixX2d* common_gradient) const {
    const Sparse by_wanted = jacobian_.rightCols(wanted());
    Eigen::MatrixXd information = Eigen::MatrixXd(Sparse(by_wanted.transpose() * by_wanted));
    *common_gradient = by_wanted.transpose() * common_errors;
    if (poses_ == 0) return information;
    const Sparse by_poses = jacobian_.leftCols(poses_);
    const Sparse mixed = by_wanted.transpose() * by_poses;
    const Eigen::SimplicialLDLT<Sparse> poses(Sparse(by_poses.transpose() * by_poses));
    // In slices: a whole recording at once would not fit in memory.
    constexpr Eigen::Index kSlice = 128;
    const Sparse transposed = mixed.transpose();
    for (Eigen::Index first = 0; first < wanted(); first += kSlice) {
      const Eigen::Index count = std::min(kSlice, wanted() - first);
      const Eigen::MatrixXd slice = transposed.middleCols(first, count);
      information.middleCols(first, count) -= mixed * poses.solve(slice);
    }
    const Eigen::MatrixXd pose_gradient = by_poses.transpose() * common_errors;
    *common_gradient -= mixed * poses.solve(pose_gradient);
    return information;
  }

  /// Whitened residuals if all corners were off by a pixel, a column for each direction.
  Eigen::MatrixX2d commonErrors(const Eigen::Vector2d& centre, double noise) const {
    Eigen::MatrixX2d errors = Eigen::MatrixX2d::Zero(jacobian_.rows(), 2);
    for (std::size_t i = 0; i < bundle_.observations.size(); ++i) {
      const Bundle::Observation& observation = bundle_.observations[i];
      const auto row = static_cast<Eigen::Index>(8 * i);
      Eigen::Vector2d middle = Eigen::Vector2d::Zero();
      for (Eigen::Index k = 0; k < 4; ++k) middle += 0.25 * observation.pixels.segment<2>(2 * k);
      Eigen::Matrix<double, 8, 2> ways;
      for (Eigen::Index k = 0; k < 4; ++k) {
        const Eigen::Vector2d pixel = observation.pixels.segment<2>(2 * k);
        ways.block<2, 1>(2 * k, 0) = (pixel - centre).normalized();
        ways.block<2, 1>(2 * k, 1) = (pixel - middle).normalized();
      }
      errors.middleRows<8>(row) = weights_[i] * observation.whitening / noise * ways;
    }
    return errors;
  }

 private:
  /// Returns the block's first index; negative for none.
  Eigen::Index addBlock(double* block, Eigen::Index size) {
    constexpr Eigen::Index kNone = -(Eigen::Index{1} << 40);
    if (block == nullptr) return kNone;
    blocks_.push_back(block);
    unknowns_ += size;
    return unknowns_ - size;
  }

  void evaluate() {
    ceres::Problem::EvaluateOptions options;
    options.parameter_blocks = blocks_;
    options.residual_blocks = problem_.observationTerms();
    options.residual_blocks.insert(options.residual_blocks.end(), problem_.otherTerms().begin(),
                                   problem_.otherTerms().end());
    // Keep the weights fixed: Ceres's correction for their change would not give a covariance.
    options.apply_loss_function = false;
    std::vector<double> residuals;
    ceres::CRSMatrix crs;
    double cost = 0.0;
    problem_.problem().Evaluate(options, &cost, &residuals, nullptr, &crs);
    Eigen::VectorXd by_row = Eigen::VectorXd::Ones(crs.num_rows);
    for (std::size_t i = 0; i < bundle_.observations.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(8 * i);
      const double square =
          Eigen::Map<const Eigen::VectorXd>(residuals.data() + row, 8).squaredNorm();
      const double weight = square <= kExpectedOfMarker ? 1.0 : kExpectedOfMarker / square;
      weighted_squares_ += weight * square;
      weights_.push_back(std::sqrt(weight));
      by_row.segment<8>(row).setConstant(weights_.back());
    }
    const Eigen::Map<const Eigen::SparseMatrix<double, Eigen::RowMajor>> jacobian(
        crs.num_rows, crs.num_cols, static_cast<Eigen::Index>(crs.values.size()), crs.rows.data(),
        crs.cols.data(), crs.values.data());
    jacobian_ = by_row.asDiagonal() * Sparse(jacobian);
  }

  const Bundle& bundle_;
  BundleProblem problem_;
  std::vector<double*> blocks_;
  std::vector<Eigen::Index> place_;
  std::vector<Eigen::Index> size_;
  Eigen::Index unknowns_ = 0;
  Eigen::Index poses_ = 0;
  Eigen::Index wanted_before_camera_ = 0;
  Sparse jacobian_;
  std::vector<double> weights_;
  double weighted_squares_ = 0.0;
};

/// Derivatives of the landmarks' increments by a shift of the whole map along x, y, z and a
/// rotation about them.
Eigen::MatrixXd wholeMapMotions(const Bundle& bundle, const std::vector<Eigen::Index>& places,
                                Eigen::Index size) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Bundle::Landmark& each : bundle.landmarks) {
    middle += each.marker.center() / static_cast<double>(bundle.landmarks.size());
  }
  Eigen::MatrixXd motions = Eigen::MatrixXd::Zero(size, 6);
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i] < 0) continue;
    motions.block<3, 3>(places[i], 0).setIdentity();
    motions.block<3, 3>(places[i], 3) = -crossMatrix(bundle.landmarks[i].marker.center() - middle);
    motions.block<3, 3>(places[i] + 3, 3).setIdentity();
  }
  return motions;
}

/// Fills in the landmarks' part; `covariance`: of the places and sizes.
void addLandmarks(const Bundle& bundle, const Linearization& linear,
                  const Eigen::MatrixXd& covariance, BundleInformation* information) {
  std::vector<Eigen::Index> places;
  for (std::size_t i = 0; i < bundle.landmarks.size(); ++i) places.push_back(linear.placeOf(i));
  const Eigen::MatrixXd motions = wholeMapMotions(bundle, places, covariance.rows());
  // The map is aligned with the true one by the markers' positions alone.
  Eigen::MatrixXd by_position = Eigen::MatrixXd::Zero(6, covariance.rows());
  for (const Eigen::Index place : places) {
    if (place >= 0) by_position.middleCols<3>(place) = motions.middleRows<3>(place).transpose();
  }
  const Eigen::Matrix<double, 6, 6> squares = by_position * motions;
  const Eigen::MatrixXd fit = squares.completeOrthogonalDecomposition().solve(by_position);
  const Eigen::MatrixXd fit_by_all = fit * covariance;
  information->placement = fit_by_all * fit.transpose();
  for (std::size_t i = 0; i < places.size(); ++i) {
    MarkerCovariance whole = MarkerCovariance::Zero();
    MarkerCovariance within = MarkerCovariance::Zero();
    if (places[i] >= 0) {
      const Eigen::Matrix<double, 6, 6> own = motions.middleRows<6>(places[i]);
      const Eigen::Matrix<double, 6, 6> shared = own * fit_by_all.middleCols<6>(places[i]);
      whole = covariance.block<6, 6>(places[i], places[i]);
      within = whole - shared - shared.transpose() + own * information->placement * own.transpose();
    }
    information->landmarks.push_back(whole);
    information->landmarks_within.push_back(within);
    const Eigen::Index size = linear.sizeOf(i);
    information->sizes.push_back(size >= 0 ? covariance(size, size) : 0.0);
  }
}

}  // namespace

double alikeFactor(std::size_t readings) {
  // With this many readings, the common error is as large as the noise.
  constexpr double kAlike = 20.0;
  return 1.0 + static_cast<double>(readings) / kAlike;
}

std::optional<BundleInformation> information(const Bundle& bundle, const BundleConfig& config,
                                             Undetermined* undetermined) {
  const Linearization linear(bundle, config);
  const Eigen::Vector2d centre =
      bundle.model->cameraAt(bundle.values)->imagePlane().principalPoint();
  Eigen::MatrixX2d gradient;
  const Eigen::MatrixXd reduced =
      linear.reduced(linear.commonErrors(centre, config.noise), &gradient);

  BundleInformation result;
  result.noise = config.noise * linear.noise();
  const Eigen::Index camera = linear.camera();
  const Eigen::Index markers = linear.wanted() - camera;
  result.camera = reduced.bottomRightCorner(camera, camera);
  result.common_error_gradient = gradient.bottomRows(camera);
  Eigen::MatrixXd covariance(0, 0);
  if (markers > 0) {
    const ScaledInverse inverse(reduced.topLeftCorner(markers, markers));
    if (!inverse.isDetermined()) {
      if (undetermined != nullptr) {
        std::vector<Eigen::Index> places;
        for (std::size_t i = 0; i < bundle.landmarks.size(); ++i) {
          places.push_back(linear.placeOf(i));
        }
        undetermined->direction = nameOfDirection(bundle, places, inverse.weakest());
      }
      return std::nullopt;
    }
    covariance = inverse.matrix();
    const Eigen::MatrixXd mixed = reduced.topRightCorner(markers, camera);
    const Eigen::MatrixXd by_camera = covariance * mixed;
    result.camera -= mixed.transpose() * by_camera;
    result.common_error_gradient -= by_camera.transpose() * gradient.topRows(markers);
    if (camera > 0) {
      // The camera's uncertainty adds to that of the markers.
      Eigen::MatrixXd with_guess = result.camera;
      with_guess.diagonal().array() += 1.0 / 16.0;
      covariance += by_camera * with_guess.ldlt().solve(by_camera.transpose());
    }
  }
  addLandmarks(bundle, linear, covariance, &result);
  return result;
}

}  // namespace omnitag
