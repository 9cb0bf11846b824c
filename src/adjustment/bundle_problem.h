#pragma once

#include <ceres/problem.h>

#include <memory>
#include <vector>

#include "adjustment/bundle.h"
#include "adjustment/bundle_costs.h"
#include "adjustment/perturbed_cameras.h"

namespace omnitag {

/// A bundle's parameters and Ceres's problem over them.
class BundleProblem {
 public:
  /// Keeps references to both.
  BundleProblem(const Bundle& bundle, const BundleConfig& config);

  ceres::Problem& problem() { return problem_; }

  /// Writes the parameters to the bundle that the problem was made from, or to a copy of it.
  void store(Bundle* bundle) const;

  /// The blocks that are estimated; null if a frame, a landmark or its size is held, or no term
  /// depends on it.
  double* poseBlock(std::size_t frame) { return estimated(poses_[frame].data()); }
  double* placeBlock(std::size_t landmark) {
    return estimated(markers_[landmark].increment.data());
  }
  double* sizeBlock(std::size_t landmark) { return estimated(&markers_[landmark].size); }
  double* cameraBlock() { return offsets_.size() == 0 ? nullptr : estimated(offsets_.data()); }

  /// Terms of the bundle's observations, in their order.
  const std::vector<ceres::ResidualBlockId>& observationTerms() const { return observations_; }
  /// All other terms except the prior of the camera's parameters.
  const std::vector<ceres::ResidualBlockId>& otherTerms() const { return others_; }

  /// Frames that can be eliminated at once: none are tied to each other by odometry.
  std::vector<double*> independentPoses();

 private:
  /// The increment is relative to the prior's place, or to the initial place if there is no prior.
  struct MarkerBlocks {
    Marker about;
    SixBlock increment{};
    double size = 0.0;
  };

  double* estimated(double* block);
  template <typename Cost>
  ceres::ResidualBlockId add(std::unique_ptr<Cost> cost, ceres::LossFunction* loss,
                             const std::vector<double*>& blocks);
  void addObservations();
  void addPriorsOfMarkers();
  void addPriorsOfPoses();
  void addPriorOfCamera();
  void addConstraints();
  void hold();

  const Bundle& bundle_;
  const BundleConfig& config_;
  PerturbedCameras cameras_;
  Eigen::VectorXd offsets_;
  std::vector<SixBlock> poses_;
  std::vector<MarkerBlocks> markers_;
  std::vector<std::unique_ptr<ceres::CostFunction>> costs_;
  std::vector<ceres::ResidualBlockId> observations_;
  std::vector<ceres::ResidualBlockId> others_;
  ExpectedLoss marker_loss_{kExpectedOfMarker};
  ExpectedLoss place_loss_{kExpectedOfPlace};
  ExpectedLoss number_loss_{kExpectedOfNumber};
  ceres::Problem problem_;
};

}  // namespace omnitag
