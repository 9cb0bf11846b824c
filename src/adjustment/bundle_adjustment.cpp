#include "adjustment/bundle_adjustment.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <vector>

#include "adjustment/bundle_problem.h"
#include "adjustment/ceres_options.h"
#include "adjustment/perturbed_cameras.h"

namespace omnitag {
namespace {

class ProgressCallback final : public ceres::IterationCallback {
 public:
  explicit ProgressCallback(const AdjustmentProgress& progress) : progress_(progress) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    if (summary.iteration == 0) start_ = summary.cost;
    if (progress_) progress_(summary.iteration, start_ > 0.0 ? summary.cost / start_ : 0.0);
    return ceres::SOLVER_CONTINUE;
  }

 private:
  const AdjustmentProgress& progress_;
  double start_ = 0.0;
};

/// The poses are eliminated first.
std::shared_ptr<ceres::ParameterBlockOrdering> orderingOf(BundleProblem* bundle) {
  const std::vector<double*> poses = bundle->independentPoses();
  if (poses.empty()) return nullptr;
  auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  std::vector<double*> blocks;
  bundle->problem().GetParameterBlocks(&blocks);
  for (double* block : blocks) ordering->AddElementToGroup(block, 1);
  for (double* block : poses) ordering->AddElementToGroup(block, 0);
  return ordering;
}

}  // namespace

bool adjust(Bundle* bundle, const BundleConfig& config, const AdjustmentProgress& progress) {
  BundleProblem problem(*bundle, config);
  ProgressCallback callback(progress);
  ceres::Solver::Options options = solverOptions(ceres::SPARSE_SCHUR, config.max_iterations);
  options.parameter_tolerance = 1e-10;
  options.linear_solver_ordering = orderingOf(&problem);
  options.callbacks.push_back(&callback);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem.problem(), &summary);
  if (!summary.IsSolutionUsable()) return false;
  problem.store(bundle);
  return true;
}

std::vector<std::optional<CornerPixels>> predictions(const Bundle& bundle) {
  PerturbedCameras cameras(*bundle.model, bundle.values, {});
  std::vector<std::optional<CornerPixels>> result(bundle.observations.size());
  if (!cameras.moveTo(nullptr, false)) return result;
  for (std::size_t i = 0; i < result.size(); ++i) {
    const Bundle::Observation& observation = bundle.observations[i];
    const Bundle::Frame& frame = bundle.frames[observation.frame];
    const Eigen::Isometry3d map_from_base = frame.map_from_base.toIsometry();
    CornerPixels pixels;
    bool is_seen = true;
    const auto corners = bundle.landmarks[observation.landmark].marker.corners();
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const auto pixel = cameras.project(map_from_base, frame.base_from_camera, corners[k]);
      is_seen = is_seen && pixel;
      if (pixel) pixels.segment<2>(static_cast<Eigen::Index>(2 * k)) = *pixel;
    }
    if (is_seen) result[i] = pixels;
  }
  return result;
}

std::vector<ReadingResidual> misfits(const Bundle& bundle, double noise) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const std::vector<std::optional<CornerPixels>> predicted = predictions(bundle);
  std::vector<ReadingResidual> result;
  for (std::size_t i = 0; i < predicted.size(); ++i) {
    const Bundle::Observation& observation = bundle.observations[i];
    ReadingResidual misfit{kInfinity, kInfinity};
    if (predicted[i]) {
      const CornerPixels off = *predicted[i] - observation.pixels;
      misfit.pixels = std::sqrt(off.squaredNorm() / 4.0);
      misfit.square = (observation.whitening * off / noise).squaredNorm();
    }
    result.push_back(misfit);
  }
  return result;
}

PlacePrior PlacePrior::surveyed(const Marker& marker) {
  PlacePrior prior;
  prior.map_from_marker = marker.map_from_marker;
  prior.deviations << Eigen::Vector3d::Constant(marker.deviation),
      Eigen::Vector3d::Constant(marker.orientation_deviation);
  return prior;
}

PlacePrior PlacePrior::exact(const Marker& marker) {
  PlacePrior prior;
  prior.map_from_marker = marker.map_from_marker;
  prior.deviations.setZero();
  return prior;
}

PlacePrior PlacePrior::gauge(const Marker& marker) {
  PlacePrior prior;
  prior.map_from_marker = marker.map_from_marker;
  constexpr Eigen::Index kTurnAboutZ = 5;
  prior.deviations.head<2>().setZero();
  prior.deviations[kTurnAboutZ] = 0.0;
  return prior;
}

}  // namespace omnitag
