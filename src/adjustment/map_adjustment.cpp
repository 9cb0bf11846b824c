#include "omnitag/adjustment/map_adjustment.h"

#include <ceres/ceres.h>

#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "motion_costs.h"
#include "pose_blocks.h"

namespace omnitag {
namespace {

/// Chi-square with 8 degrees of freedom, which 99 of 100 observations stay below.
constexpr double kExpected = 20.1;

/// A marker's parameters. Its increment about the initial place is in two blocks, of which the
/// first can be held alone: what moves it over the floor (x, y, turn about z), and the rest (z,
/// turns about x and y).
struct MarkerBlocks {
  std::array<double, 3> on_floor{};
  std::array<double, 3> off_floor{};
  double size = 0.0;

  MarkerIncrement increment() const { return incrementOf(on_floor.data(), off_floor.data()); }

  static MarkerIncrement incrementOf(const double* on_floor, const double* off_floor) {
    MarkerIncrement increment;
    increment << on_floor[0], on_floor[1], off_floor[0], off_floor[1], off_floor[2], on_floor[2];
    return increment;
  }
};

/// Where in an increment the elements of the two blocks are.
constexpr std::array<int, 3> kOnFloor = {0, 1, 5};
constexpr std::array<int, 3> kOffFloor = {2, 3, 4};

/// Parameters that are estimated, and where in an increment they are.
struct UnknownBlock {
  const double* values = nullptr;
  std::array<int, 3> places{};
};
using Unknowns = std::vector<UnknownBlock>;

/// The covariance of an increment, zero where it is held.
MarkerCovariance covarianceOf(const ceres::Covariance& covariance, const Unknowns& unknowns) {
  MarkerCovariance whole = MarkerCovariance::Zero();
  for (const UnknownBlock& a : unknowns) {
    for (const UnknownBlock& b : unknowns) {
      Eigen::Matrix<double, 3, 3, Eigen::RowMajor> part;
      covariance.GetCovarianceBlock(a.values, b.values, part.data());
      for (std::size_t k = 0; k < 9; ++k) {
        whole(a.places[k / 3], b.places[k % 3]) = part.data()[k];
      }
    }
  }
  return whole;
}

Marker markerAt(const Marker& initial, const MarkerIncrement& increment, double size) {
  Marker marker = initial;
  marker.map_from_marker = moved(initial.map_from_marker, increment);
  marker.size = size;
  return marker;
}

/// Squares up to what is expected, and from there on Cauchy's function.
class ExpectedLoss : public ceres::LossFunction {
 public:
  void Evaluate(double square, double* out) const override {
    if (square <= kExpected) {
      out[0] = square;
      out[1] = 1.0;
      out[2] = 0.0;
    } else {
      out[0] = kExpected * (1.0 + std::log(square / kExpected));
      out[1] = kExpected / square;
      out[2] = -kExpected / (square * square);
    }
  }
};

/// What an observation's corners are off, whitened, by the pose's two blocks, the marker's two, and
/// its size.
class CornersCost : public ceres::SizedCostFunction<8, 3, 3, 3, 3, 1> {
 public:
  CornersCost(const MountedCamera& camera, const Marker& initial,
              const Bundle::Observation& observation)
      : camera_(camera), initial_(initial), observation_(observation) {}

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const Pose pose = PoseBlocks::poseOf(parameters[0], parameters[1]);
    const MarkerIncrement increment = MarkerBlocks::incrementOf(parameters[2], parameters[3]);
    const double size = parameters[4][0];
    if (!(size > 0.0)) return false;
    const auto projection = projectMarker(markerAt(initial_, increment, size), camera_, pose);
    if (!projection) return false;
    const Eigen::Matrix<double, 8, 8>& whitening = observation_.whitening;
    Eigen::Map<CornerPixels> residual(residuals);
    residual = whitening * (projection->pixels - observation_.pixels);
    if (jacobians == nullptr) return true;

    Eigen::Matrix<double, 8, 6> by_increment = whitening * projection->by_marker;
    by_increment.rightCols<3>() = by_increment.rightCols<3>() * leftJacobian(increment.tail<3>());
    using By3 = Eigen::Matrix<double, 8, 3, Eigen::RowMajor>;
    const PoseDerivatives derivatives(pose);
    const Eigen::Matrix<double, 8, 6> by_pose = whitening * projection->by_pose;
    if (jacobians[0] != nullptr) {
      Eigen::Map<By3> block(jacobians[0]);
      block = by_pose * derivatives.by_on_floor;
    }
    if (jacobians[1] != nullptr) {
      Eigen::Map<By3> block(jacobians[1]);
      block = by_pose * derivatives.by_off_floor;
    }
    const auto pick = [&](double* jacobian, const std::array<int, 3>& columns) {
      if (jacobian == nullptr) return;
      Eigen::Map<By3> block(jacobian);
      for (int i = 0; i < 3; ++i) {
        block.col(i) = by_increment.col(columns[static_cast<std::size_t>(i)]);
      }
    };
    pick(jacobians[2], kOnFloor);
    pick(jacobians[3], kOffFloor);
    if (jacobians[4] != nullptr) {
      Eigen::Map<CornerPixels> by_size(jacobians[4]);
      by_size = whitening * projection->by_size;
    }
    return true;
  }

 private:
  const MountedCamera& camera_;
  Marker initial_;
  const Bundle::Observation& observation_;
};

/// The bundle's unknowns and, over them, Ceres's problem.
class Adjustment {
 public:
  Adjustment(const Bundle& bundle, const BundleConfig& config)
      : bundle_(bundle),
        config_(config),
        poses_(bundle.frames.size()),
        blocks_(bundle.landmarks.size()) {
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      poses_[i] = PoseBlocks::of(bundle.frames[i].map_from_base);
    }
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      blocks_[i].size = bundle.landmarks[i].marker.size;
    }
    addObservations();
    for (const Bundle::Motion& motion : bundle.motions) addMotion(motion);
    hold();
  }

  ceres::Problem& problem() { return problem_; }

  /// Puts the result into the bundle that this was made from.
  void store(Bundle* bundle) const {
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      bundle->frames[i].map_from_base = poses_[i].pose();
    }
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      Marker& marker = bundle->landmarks[i].marker;
      marker = markerAt(marker, blocks_[i].increment(), blocks_[i].size);
    }
  }

  /// Blocks of a landmark's increment that are estimated; none for one that no frame shows.
  Unknowns unknownsOf(std::size_t landmark) const {
    const MarkerBlocks& blocks = blocks_[landmark];
    const Hold hold = bundle_.landmarks[landmark].hold;
    Unknowns unknowns;
    if (!isSeen(landmark)) return unknowns;
    if (hold == Hold::kNothing) unknowns.push_back({blocks.on_floor.data(), kOnFloor});
    if (hold != Hold::kAll) unknowns.push_back({blocks.off_floor.data(), kOffFloor});
    return unknowns;
  }

  bool estimatesSizeOf(std::size_t landmark) const {
    return config_.estimates_sizes && isSeen(landmark) &&
           bundle_.landmarks[landmark].hold == Hold::kNothing;
  }

  const double* sizeOf(std::size_t landmark) const { return &blocks_[landmark].size; }

 private:
  bool isSeen(std::size_t landmark) const {
    return problem_.HasParameterBlock(blocks_[landmark].on_floor.data());
  }

  void addObservations() {
    for (const Bundle::Observation& observation : bundle_.observations) {
      const Bundle::Frame& frame = bundle_.frames[observation.frame];
      const Marker& marker = bundle_.landmarks[observation.landmark].marker;
      if (!projectMarker(marker, frame.camera, frame.map_from_base)) continue;
      MarkerBlocks& blocks = blocks_[observation.landmark];
      costs_.push_back(std::make_unique<CornersCost>(frame.camera, marker, observation));
      PoseBlocks& pose = poses_[observation.frame];
      problem_.AddResidualBlock(costs_.back().get(), &loss_, pose.on_floor.data(),
                                pose.off_floor.data(), blocks.on_floor.data(),
                                blocks.off_floor.data(), &blocks.size);
    }
  }

  void addMotion(const Bundle::Motion& motion) {
    PoseBlocks& from = poses_[motion.from];
    PoseBlocks& to = poses_[motion.to];
    if (config_.is_free) {
      auto free_motion = std::make_unique<FreeMotion>(FreeMotion{motion});
      costs_.push_back(std::make_unique<FreeMotionCost>(free_motion.release()));
      problem_.AddResidualBlock(costs_.back().get(), nullptr, from.on_floor.data(),
                                from.off_floor.data(), to.on_floor.data(), to.off_floor.data());
    } else {
      costs_.push_back(std::make_unique<MotionCost>(motion));
      problem_.AddResidualBlock(costs_.back().get(), nullptr, from.on_floor.data(),
                                to.on_floor.data());
    }
  }

  void hold() {
    const auto holdBlock = [this](double* block) {
      if (problem_.HasParameterBlock(block)) problem_.SetParameterBlockConstant(block);
    };
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      const bool is_held = bundle_.frames[i].is_held;
      if (is_held) holdBlock(poses_[i].on_floor.data());
      if (is_held || !config_.is_free) holdBlock(poses_[i].off_floor.data());
    }
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      const Hold hold = bundle_.landmarks[i].hold;
      if (hold != Hold::kNothing) holdBlock(blocks_[i].on_floor.data());
      if (hold == Hold::kAll) holdBlock(blocks_[i].off_floor.data());
      if (hold != Hold::kNothing || !config_.estimates_sizes) holdBlock(&blocks_[i].size);
    }
  }

  const Bundle& bundle_;
  const BundleConfig& config_;
  std::vector<PoseBlocks> poses_;
  std::vector<MarkerBlocks> blocks_;
  std::vector<std::unique_ptr<ceres::CostFunction>> costs_;
  ExpectedLoss loss_;
  ceres::Problem problem_{notOwning()};
};

}  // namespace

bool adjust(Bundle* bundle, const BundleConfig& config) {
  Adjustment adjustment(*bundle, config);
  constexpr int kMaxIterations = 100;
  const ceres::Solver::Options options =
      solverOptions(ceres::SPARSE_NORMAL_CHOLESKY, kMaxIterations);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &adjustment.problem(), &summary);
  if (!summary.IsSolutionUsable()) return false;
  adjustment.store(bundle);
  return true;
}

std::optional<BundleCovariances> covariances(const Bundle& bundle, const BundleConfig& config) {
  Adjustment adjustment(bundle, config);
  std::vector<std::pair<const double*, const double*>> wanted;
  for (std::size_t i = 0; i < bundle.landmarks.size(); ++i) {
    const Unknowns unknowns = adjustment.unknownsOf(i);
    for (const UnknownBlock& a : unknowns) {
      // Each pair once.
      for (const UnknownBlock& b : unknowns) {
        if (b.values <= a.values) wanted.emplace_back(b.values, a.values);
      }
    }
    if (adjustment.estimatesSizeOf(i)) {
      wanted.emplace_back(adjustment.sizeOf(i), adjustment.sizeOf(i));
    }
  }
  const ceres::Covariance::Options options;
  ceres::Covariance covariance(options);
  if (!covariance.Compute(wanted, &adjustment.problem())) return std::nullopt;

  BundleCovariances result;
  for (std::size_t i = 0; i < bundle.landmarks.size(); ++i) {
    result.landmarks.push_back(covarianceOf(covariance, adjustment.unknownsOf(i)));
    double size_variance = 0.0;
    if (adjustment.estimatesSizeOf(i)) {
      covariance.GetCovarianceBlock(adjustment.sizeOf(i), adjustment.sizeOf(i), &size_variance);
    }
    result.sizes.push_back(size_variance);
  }
  return result;
}

std::vector<ReadingMisfit> misfits(const Bundle& bundle) {
  std::vector<ReadingMisfit> result;
  for (const Bundle::Observation& observation : bundle.observations) {
    const Bundle::Frame& frame = bundle.frames[observation.frame];
    const auto projection = projectMarker(bundle.landmarks[observation.landmark].marker,
                                          frame.camera, frame.map_from_base);
    if (projection) {
      const CornerPixels off = projection->pixels - observation.pixels;
      result.push_back(
          {std::sqrt(off.squaredNorm() / 4.0), (observation.whitening * off).squaredNorm()});
    } else {
      constexpr double kInfinity = std::numeric_limits<double>::infinity();
      result.push_back({kInfinity, kInfinity});
    }
  }
  return result;
}

}  // namespace omnitag
