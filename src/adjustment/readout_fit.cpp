#include "adjustment/readout_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "adjustment/outliers.h"

namespace omnitag {
namespace {

/// s per row: the solver's unit of the readout time, and the standard deviation of its prior.
constexpr double kReadoutUnit = 1e-5;
constexpr double kLargestReadout = 2e-4;

/// Unknowns that all frames share: the camera's modes and the readout time in its unit.
constexpr int kShared = kCameraModes + 1;
/// Unknowns of each frame: the pose (a PoseVector) and the velocity's error.
constexpr int kOwn = 6 + 3;
using SharedVector = Eigen::Matrix<double, kShared, 1>;
using SharedMatrix = Eigen::Matrix<double, kShared, kShared>;
using OwnVector = Eigen::Matrix<double, kOwn, 1>;
using OwnMatrix = Eigen::Matrix<double, kOwn, kOwn>;

/// A linearised corner: pixels, and pixels per unit.
struct CornerEquation {
  Eigen::Vector2d residual;
  Eigen::Matrix<double, 2, kShared> by_shared;
  Eigen::Matrix<double, 2, kOwn> by_own;
};

/// Normal equations of a frame, with its priors.
struct FrameNormals {
  SharedMatrix shared = SharedMatrix::Zero();
  Eigen::Matrix<double, kShared, kOwn> mixed = Eigen::Matrix<double, kShared, kOwn>::Zero();
  OwnMatrix own = OwnMatrix::Zero();
  SharedVector shared_gradient = SharedVector::Zero();
  OwnVector own_gradient = OwnVector::Zero();

  void add(const CornerEquation& corner, double weight) {
    const Eigen::Matrix<double, kShared, 2> shared_weight = weight * corner.by_shared.transpose();
    const Eigen::Matrix<double, kOwn, 2> own_weight = weight * corner.by_own.transpose();
    shared.noalias() += shared_weight * corner.by_shared;
    mixed.noalias() += shared_weight * corner.by_own;
    own.noalias() += own_weight * corner.by_own;
    shared_gradient.noalias() -= shared_weight * corner.residual;
    own_gradient.noalias() -= own_weight * corner.residual;
  }
};

class ReadoutFitter {
 public:
  ReadoutFitter(const MarkerMap& map, const MountedCamera& camera, const MotionModelConfig& config,
                const ReadoutFit& start, bool is_held, std::vector<MovingFrame>* frames)
      : map_(map),
        camera_(camera),
        config_(config),
        is_held_(is_held),
        fit_(start),
        frames_(*frames) {}

  ReadoutFit run() {
    constexpr int kMaxRounds = 20;
    constexpr double kSettled = 1e-3;  // deviations
    bool is_settled = false;
    for (int round = 0; round < kMaxRounds && !is_settled; ++round) {
      is_settled = step() < kSettled;
    }
    return fit_;
  }

 private:
  std::vector<CornerEquation> equationsOf(const MovingFrame& frame) const {
    constexpr double kStep = 0.1 * kReadoutUnit;
    const auto at = [&](double readout) {
      return cameraInFrame(camera_, frame, fit_.camera_error, readout);
    };
    const MountedCamera now = at(fit_.row_readout_time);
    const MountedCamera slower = at(fit_.row_readout_time + kStep);
    const MountedCamera faster = at(fit_.row_readout_time - kStep);
    const Eigen::Isometry3d map_from_base = frame.map_from_base.toIsometry();
    std::vector<CornerEquation> equations;
    for (const MarkerObservation& observation : frame.seen.observations) {
      const auto corners = map_.markers[observation.map_entry].corners();
      for (std::size_t k = 0; k < corners.size(); ++k) {
        FrameJacobian by_frame;
        const auto pixel = now.pixelFromMap(map_from_base, corners[k], &by_frame);
        const auto later = slower.pixelFromMap(map_from_base, corners[k]);
        const auto sooner = faster.pixelFromMap(map_from_base, corners[k]);
        if (!pixel || !later || !sooner) continue;
        CornerEquation equation;
        equation.residual = *pixel - observation.corners[k];
        equation.by_shared << by_frame.middleCols<kCameraModes>(6),
            (*later - *sooner) / (2.0 * kStep) * kReadoutUnit;
        if (is_held_) equation.by_shared.rightCols<1>().setZero();
        equation.by_own << by_frame.leftCols<6>(), by_frame.rightCols<3>();
        equations.push_back(equation);
      }
    }
    return equations;
  }

  /// Noise in pixels along each axis, by the median: outliers hardly change it.
  static double noiseOf(const std::vector<std::vector<CornerEquation>>& frames) {
    constexpr double kMedianOfNormal = 0.6745;
    constexpr double kLeast = 1e-3;
    std::vector<double> sizes;
    for (const auto& equations : frames) {
      for (const CornerEquation& equation : equations) {
        sizes.push_back(std::abs(equation.residual.x()));
        sizes.push_back(std::abs(equation.residual.y()));
      }
    }
    return std::max(kLeast, medianOf(std::move(sizes)) / kMedianOfNormal);
  }

  FrameNormals normalsOf(const MovingFrame& frame, const std::vector<CornerEquation>& equations,
                         double noise) const {
    constexpr double kRobust = 4.0;  // deviations
    FrameNormals normals;
    for (const CornerEquation& equation : equations) {
      const double square = equation.residual.squaredNorm() / (noise * noise);
      normals.add(equation, 1.0 / (noise * noise) / (1.0 + square / (kRobust * kRobust)));
    }
    const FloorConfig& floor = config_.floor;
    const PosePrior lean =
        PosePrior::standing(Pose{}, floor.height_deviation, floor.lean_deviation);
    normals.own.topLeftCorner<6, 6>() += lean.information;
    normals.own_gradient.head<6>() -= lean.information * lean.errorOf(frame.map_from_base);
    normals.own.bottomRightCorner<3, 3>() += Eigen::Matrix3d::Identity();
    normals.own_gradient.tail<3>() -= frame.motion_error;
    return normals;
  }

  /// The priors of the shared unknowns.
  FrameNormals sharedPriors() const {
    constexpr double kWeight = (kReadoutUnit / kLargestReadout) * (kReadoutUnit / kLargestReadout);
    FrameNormals priors;
    priors.shared.setIdentity();
    priors.shared(kCameraModes, kCameraModes) = kWeight;
    priors.shared_gradient << -fit_.camera_error.head<kCameraModes>(),
        -kWeight * fit_.row_readout_time / kReadoutUnit;
    if (is_held_) priors.shared_gradient(kCameraModes) = 0.0;
    return priors;
  }

  /// A Gauss-Newton step with the frames' own unknowns eliminated. Returns the change of the shared
  /// unknowns, in deviations.
  double step() {
    std::vector<std::vector<CornerEquation>> equations;
    for (const MovingFrame& frame : frames_) equations.push_back(equationsOf(frame));
    const double noise = noiseOf(equations);

    std::vector<FrameNormals> normals;
    FrameNormals sum = sharedPriors();
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      normals.push_back(normalsOf(frames_[i], equations[i], noise));
      const FrameNormals& frame = normals.back();
      const Eigen::LDLT<OwnMatrix> own(frame.own);
      sum.shared += frame.shared - frame.mixed * own.solve(frame.mixed.transpose());
      sum.shared_gradient += frame.shared_gradient - frame.mixed * own.solve(frame.own_gradient);
    }
    const SharedMatrix covariance = sum.shared.ldlt().solve(SharedMatrix::Identity());
    const SharedVector change = covariance * sum.shared_gradient;
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      changeFrame(normals[i], change, covariance, &frames_[i]);
    }
    fit_.camera_error.head<kCameraModes>() += change.head<kCameraModes>();
    if (!is_held_) {
      fit_.row_readout_time += kReadoutUnit * change(kCameraModes);
      fit_.deviation = kReadoutUnit * std::sqrt(covariance(kCameraModes, kCameraModes));
    }
    return std::sqrt(change.dot(sum.shared * change));
  }

  static void changeFrame(const FrameNormals& normals, const SharedVector& shared_change,
                          const SharedMatrix& shared_covariance, MovingFrame* frame) {
    const OwnMatrix own = normals.own.ldlt().solve(OwnMatrix::Identity());
    const OwnVector change =
        own * (normals.own_gradient - normals.mixed.transpose() * shared_change);
    frame->map_from_base = moved(frame->map_from_base, change.head<6>());
    frame->motion_error += change.tail<3>();
    const Eigen::Matrix<double, 3, kShared> by_shared =
        own.topRows<3>() * normals.mixed.transpose();
    frame->covariance =
        own.topLeftCorner<3, 3>() + by_shared * shared_covariance * by_shared.transpose();
  }

  const MarkerMap& map_;
  const MountedCamera& camera_;
  const MotionModelConfig& config_;
  bool is_held_;
  ReadoutFit fit_;
  std::vector<MovingFrame>& frames_;
};

}  // namespace

ReadoutFit fitReadout(const MarkerMap& map, const MountedCamera& camera,
                      const MotionModelConfig& config, const ReadoutFit& start, bool is_held,
                      std::vector<MovingFrame>* frames) {
  return ReadoutFitter(map, camera, config, start, is_held, frames).run();
}

}  // namespace omnitag
