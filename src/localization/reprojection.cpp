#include "localization/reprojection.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/symmetric_matrix.h"
#include "measurement/frame_equations.h"
#include "measurement/marker_misplacement.h"

namespace omnitag {
namespace {

constexpr double kCoordinates = 8.0;  // of four corners

using CornerJacobian = Eigen::Matrix<double, 8, kFrameUnknowns>;
using CornerResiduals = Eigen::Matrix<double, 8, 1>;

/// What is estimated.
struct State {
  Pose pose;
  ImagingError error = ImagingError::Zero();
};

/// An observation's corners minus their projections at a state, and the derivatives.
struct Projection {
  CornerResiduals residuals;
  CornerJacobian by_frame;
};

/// Transforms the corners' coordinates to independent ones of standard deviation 1. A marker's
/// place as a whole is measured to within a corner's noise, its shape only as well as it was known
/// before.
template <typename Rows>
Rows whitened(const Rows& rows, double noise, double shape_deviation) {
  const auto mean = 0.25 * (rows.template middleRows<2>(0) + rows.template middleRows<2>(2) +
                            rows.template middleRows<2>(4) + rows.template middleRows<2>(6));
  const Eigen::Matrix<double, 2, Rows::ColsAtCompileTime> middle = mean;
  const double per_shape = 1.0 / std::hypot(noise, shape_deviation);
  Rows white = rows;
  for (int k = 0; k < 8; k += 2) {
    white.template middleRows<2>(k) =
        per_shape * (rows.template middleRows<2>(k) - middle) + middle / noise;
  }
  return white;
}

/// A whitened projection.
struct Whitened {
  CornerResiduals residuals;
  CornerJacobian by_frame;

  Whitened(const Projection& projection, double noise, double shape_deviation)
      : residuals(whitened(projection.residuals, noise, shape_deviation)),
        by_frame(whitened(projection.by_frame, noise, shape_deviation)) {}

  FrameEquations equations() const {
    FrameEquations marker;
    // Eigen would otherwise treat these matrices as large.
    marker.information = by_frame.transpose().lazyProduct(by_frame);
    marker.gradient = by_frame.transpose().lazyProduct(residuals);
    marker.by_chance = marker.information;
    return marker;
  }
};

/// r^T (1 + J M J^T)^-1 r of white residuals, by the matrix inversion lemma.
double chiSquare(double squares, const PoseVector& gradient, const PoseMatrix& information,
                 const PoseMatrix& misplacement) {
  const PoseMatrix factor = PoseMatrix::Identity() + information * misplacement;
  return std::max(0.0, squares - gradient.dot(misplacement * factor.inverse() * gradient));
}

/// The problem linearised at a state, and its cost there.
struct Linearization {
  FrameEquations markers;
  double cost = 0.0;
  /// Sum over the markers of their squared residuals in standard deviations, each with its
  /// robust weight.
  double weighted_squares = 0.0;
  int seen = 0;
};

class Problem {
 public:
  Problem(const MarkerMap& map, const MountedCamera& camera,
          const std::vector<MarkerObservation>& observations, const PosePrior& prior,
          const ReprojectionConfig& config)
      : map_(map), camera_(camera), observations_(observations), prior_(prior), config_(config) {
    // If edges are more blurred than by a sharp lens, corners err by a share of the additional
    // blur.
    constexpr double kShareOfBlur = 0.2;
    constexpr double kSharp = 0.5;  // pixels
    const double blur = std::max(0.0, camera.blur().largestDeviation() - kSharp);
    const double local = std::hypot(camera.model().uncertainty().local(), kShareOfBlur * blur);
    config_.corner_noise = std::hypot(config.corner_noise, local);
    config_.poor_corner_noise = std::hypot(config.poor_corner_noise, local);
    corners_.reserve(observations.size());
    for (const MarkerObservation& observation : observations) {
      corners_.push_back(map.markers[observation.map_entry].corners());
    }
  }

  Linearization linearize(const State& state) const {
    Linearization linear;
    const PoseVector error = prior_.errorOf(state.pose);
    linear.cost = 0.5 * (error.dot(prior_.information * error) + state.error.squaredNorm());
    const MountedCamera camera = camera_.withError(state.error);
    const Eigen::Isometry3d isometry = state.pose.toIsometry();
    for (std::size_t i = 0; i < observations_.size(); ++i) {
      addMarker(i, project(camera, isometry, i), state.pose, &linear);
    }
    return linear;
  }

  /// The equations of each marker, with the noise of poor corners; nothing for one that is not
  /// visible from the pose.
  std::vector<std::optional<FrameEquations>> equations(const State& state) const {
    const MountedCamera camera = camera_.withError(state.error);
    const Eigen::Isometry3d isometry = state.pose.toIsometry();
    std::vector<std::optional<FrameEquations>> equations;
    equations.reserve(observations_.size());
    for (std::size_t i = 0; i < observations_.size(); ++i) {
      const auto projection = project(camera, isometry, i);
      equations.emplace_back();
      if (!projection) continue;
      const Whitened white(*projection, config_.poor_corner_noise,
                           observations_[i].shape_deviation);
      const auto misplaced = misplacement(i, state.pose, projection->by_frame);
      equations.back() =
          misplaced ? withMisplacement(white.equations(), *misplaced) : white.equations();
    }
    return equations;
  }

  FrameEquations withPriors(const Linearization& linear, const State& state) const {
    return omnitag::withPriors(linear.markers, prior_, state.pose, state.error);
  }

  std::vector<Misfit> misfits(const State& state) const {
    const MountedCamera camera = camera_.withError(state.error);
    const Eigen::Isometry3d isometry = state.pose.toIsometry();
    std::vector<Misfit> misfits;
    misfits.reserve(observations_.size());
    for (std::size_t i = 0; i < observations_.size(); ++i) {
      const auto projection = project(camera, isometry, i);
      if (!projection) {
        constexpr double kInfinity = std::numeric_limits<double>::infinity();
        misfits.push_back({kInfinity, kInfinity});
        continue;
      }
      const double shape = observations_[i].shape_deviation;
      const CornerResiduals white =
          whitened(projection->residuals, config_.poor_corner_noise, shape);
      double chi_square = white.squaredNorm();
      if (const auto misplaced = misplacement(i, state.pose, projection->by_frame)) {
        const auto by_pose = whitened<Eigen::Matrix<double, 8, 6>>(
            projection->by_frame.leftCols<6>(), config_.poor_corner_noise, shape);
        chi_square = chiSquare(chi_square, by_pose.transpose() * white,
                               by_pose.transpose() * by_pose, *misplaced);
      }
      misfits.push_back({projection->residuals.norm() / 2.0, std::sqrt(chi_square / kCoordinates)});
    }
    return misfits;
  }

 private:
  std::optional<Projection> project(const MountedCamera& camera, const Eigen::Isometry3d& pose,
                                    std::size_t index) const {
    Projection projection;
    for (std::size_t corner = 0; corner < 4; ++corner) {
      const Eigen::Index row = 2 * static_cast<Eigen::Index>(corner);
      FrameJacobian by_frame;
      const auto pixel = camera.pixelFromMap(pose, corners_[index][corner], &by_frame);
      if (!pixel) return std::nullopt;
      projection.residuals.segment<2>(row) = observations_[index].corners[corner] - *pixel;
      projection.by_frame.middleRows<2>(row) = by_frame;
    }
    return projection;
  }

  /// Nothing if the marker hangs exactly in its place and the camera is exact. `by_frame`:
  /// derivatives of the corners.
  std::optional<PoseMatrix> misplacement(std::size_t index, const Pose& pose,
                                         const CornerJacobian& by_frame) const {
    const Marker& marker = map_.markers[observations_[index].map_entry];
    const double pixels_per_metre = 0.5 * by_frame.leftCols<2>().norm();
    const Misplacement misplaced = misplacementOf(marker, camera_.model(), pixels_per_metre, 0.0);
    if (misplaced.isNone()) return std::nullopt;
    return seenFrom(pose, marker, misplaced);
  }

  void addMarker(std::size_t index, const std::optional<Projection>& projection, const Pose& pose,
                 Linearization* linear) const {
    const double width = kCoordinates * config_.robust_misfit * config_.robust_misfit;
    if (!projection) {
      linear->cost += 0.5 * width * std::log1p(kHiddenChiSquare / width);
      return;
    }
    const Whitened white(*projection, config_.corner_noise, observations_[index].shape_deviation);
    FrameEquations marker = white.equations();
    double chi_square = white.residuals.squaredNorm();
    if (const auto misplaced = misplacement(index, pose, projection->by_frame)) {
      chi_square = chiSquare(chi_square, marker.gradient.head<6>(),
                             marker.information.topLeftCorner<6, 6>(), *misplaced);
      marker = withMisplacement(marker, *misplaced);
    }
    // The derivative of Cauchy's function by half the square.
    const double weight = 1.0 / (1.0 + chi_square / width);
    linear->markers.add(marker, weight);
    linear->cost += 0.5 * width * std::log1p(chi_square / width);
    linear->weighted_squares += weight * chi_square;
    ++linear->seen;
  }

  /// A marker that is not visible from the pose costs as much as one whose corners are this far
  /// off.
  static constexpr double kHiddenChiSquare = 1e9;

  const MarkerMap& map_;
  const MountedCamera& camera_;
  const std::vector<MarkerObservation>& observations_;
  PosePrior prior_;
  ReprojectionConfig config_;
  std::vector<Corners<Eigen::Vector3d>> corners_;
};

State moved(const State& state, const FrameVector& change) {
  return {omnitag::moved(state.pose, change.head<6>()),
          state.error + change.tail<kImagingUnknowns>()};
}

/// Levenberg-Marquardt until a step is shorter than the tolerance (m and rad); that step is still
/// taken. Nothing if the pose is undetermined.
std::optional<State> descend(const Problem& problem, const State& initial, double tolerance) {
  constexpr int kMaxIterations = 100;
  State state = initial;
  Linearization linear = problem.linearize(state);
  double damping = 1e-6;
  for (int i = 0; i < kMaxIterations; ++i) {
    FrameEquations damped = problem.withPriors(linear, state);
    damped.information.diagonal() *= 1.0 + damping;
    const auto step = solutionOf(damped);
    if (!step) return std::nullopt;
    const State next = moved(state, *step);
    if (step->head<6>().norm() < tolerance) return next;
    Linearization there = problem.linearize(next);
    if (there.cost <= linear.cost) {
      state = next;
      linear = std::move(there);
      damping = std::max(damping * 0.1, 1e-9);
    } else {
      damping = std::max(damping * 10.0, 1e-4);
    }
  }
  return state;
}

/// Whether markers and prior determine every direction on the floor.
bool isDetermined(const PoseEstimate& estimate) {
  constexpr double kSmallestRatio = 1e-9;
  const Eigen::Matrix3d covariance = floorCovariance(estimate);
  if (!covariance.allFinite()) return false;
  const SmallVector values = eigenPairs(covariance).values;
  return values(0) > kSmallestRatio * values(2);
}

}  // namespace

std::optional<ReprojectionFit> refineByReprojection(
    const MarkerMap& map, const MountedCamera& camera,
    const std::vector<MarkerObservation>& observations, const Pose& initial, const PosePrior& prior,
    const ReprojectionConfig& config) {
  // The remaining error is far less.
  constexpr double kTolerance = 1e-6;
  const Problem problem(map, camera, observations, prior, config);
  const std::optional<State> state = descend(problem, {initial, ImagingError::Zero()}, kTolerance);
  if (!state) return std::nullopt;
  const Linearization linear = problem.linearize(*state);
  if (!solutionOf(problem.withPriors(linear, *state))) return std::nullopt;

  ReprojectionFit fit;
  constexpr double kPoseUnknowns = 6.0;
  const double freedom = kCoordinates * linear.seen - kPoseUnknowns + possibleErrors(state->error);
  if (linear.seen > 0) {
    const double squares = linear.weighted_squares + state->error.squaredNorm();
    fit.excess = std::max(1.0, squares / freedom);
  }
  fit.map_from_base = estimateOf(linear.markers, prior, state->pose, fit.excess);
  if (!isDetermined(fit.map_from_base)) return std::nullopt;
  fit.imaging_error = state->error;
  fit.misfits = problem.misfits(*state);
  return fit;
}

std::optional<ReprojectionFit> refineFromAfar(const MarkerMap& map, const MountedCamera& camera,
                                              const std::vector<MarkerObservation>& observations,
                                              const Pose& initial, const PosePrior& prior,
                                              const ReprojectionConfig& config) {
  constexpr std::array<double, 2> kWidths = {250.0, 30.0};  // standard deviations
  // Close enough for the next width to converge from.
  constexpr double kTolerance = 1e-3;
  State state{initial, ImagingError::Zero()};
  for (const double width : kWidths) {
    ReprojectionConfig wide = config;
    wide.robust_misfit = std::max(width, config.robust_misfit);
    const auto end = descend(Problem(map, camera, observations, prior, wide), state, kTolerance);
    if (end) state = *end;
  }
  return refineByReprojection(map, camera, observations, state.pose, prior, config);
}

std::vector<Misfit> misfitsAt(const MarkerMap& map, const MountedCamera& camera,
                              const std::vector<MarkerObservation>& observations,
                              const Pose& map_from_base, const ImagingError& error,
                              const ReprojectionConfig& config) {
  return Problem(map, camera, observations, PosePrior{}, config).misfits({map_from_base, error});
}

std::vector<std::optional<FrameEquations>> equationsAt(
    const MarkerMap& map, const MountedCamera& camera,
    const std::vector<MarkerObservation>& observations, const Pose& map_from_base,
    const ImagingError& error, const ReprojectionConfig& config) {
  return Problem(map, camera, observations, PosePrior{}, config).equations({map_from_base, error});
}

}  // namespace omnitag
