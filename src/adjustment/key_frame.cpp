#include "adjustment/key_frame.h"

#include <Eigen/Cholesky>
#include <array>

#include "adjustment/bundle_costs.h"
#include "adjustment/marker_projection.h"
#include "common/least_deviation.h"

namespace omnitag {
namespace {

/// Columns of a frame's unknowns: its own, which are its pose and its velocities; then the part of
/// the joint estimate that it depends on.
constexpr Eigen::Index kVelocity = 6;
constexpr Eigen::Index kVelocities = kImagingUnknowns - kCameraModes;
constexpr Eigen::Index kStanding = kVelocity + kVelocities;
constexpr Eigen::Index kMode = kStanding + kStandingNumbers;
constexpr Eigen::Index kFirstIncrement = kMode + kCameraModes;

class FrameFit {
 public:
  FrameFit(const KeyFrame& frame, const JointEstimate& joint) : frame_(frame), pose_(frame.pose) {
    const auto take = [this](Eigen::Index first, Eigen::Index count) {
      for (Eigen::Index i = 0; i < count; ++i) indices_.push_back(first + i);
    };
    take(0, kStandingNumbers);
    take(frame.first_mode, kCameraModes);
    for (const KeyFrame::Sight& sight : frame.sights) {
      if (sight.increment) take(*sight.increment, 6);
    }
    prior_ = joint.part(indices_);
    const Eigen::Index shared = prior_.mean.size();
    prior_information_ = prior_.covariance.llt().solve(Eigen::MatrixXd::Identity(shared, shared));
    values_ = Eigen::VectorXd::Zero(kStanding + shared);
    values_.tail(shared) = prior_.mean;
  }

  const std::vector<Eigen::Index>& indices() const { return indices_; }

  /// The part of the joint estimate after the frame.
  std::optional<JointEstimate> solve() {
    constexpr int kMaxSteps = 20;
    constexpr double kConverged = 1e-4;  // chi-square
    for (int step = 0; step < kMaxSteps; ++step) {
      if (!linearize()) return std::nullopt;
      const Eigen::LLT<Eigen::MatrixXd> factors(information_);
      if (factors.info() != Eigen::Success) return std::nullopt;
      const Eigen::VectorXd change = factors.solve(gradient_);
      if (!change.allFinite()) return std::nullopt;
      pose_ = moved(pose_, change.head<6>());
      values_.tail(values_.size() - kVelocity) += change.tail(change.size() - kVelocity);
      if (change.dot(gradient_) > kConverged) continue;
      const Eigen::MatrixXd covariance =
          factors.solve(Eigen::MatrixXd::Identity(change.size(), change.size()));
      const Eigen::Index shared = prior_.mean.size();
      return JointEstimate{values_.tail(shared), covariance.bottomRightCorner(shared, shared)};
    }
    return std::nullopt;
  }

 private:
  bool linearize() {
    const Eigen::Index shared = prior_.mean.size();
    information_ = Eigen::MatrixXd::Zero(values_.size(), values_.size());
    gradient_ = Eigen::VectorXd::Zero(values_.size());
    information_.bottomRightCorner(shared, shared) = prior_information_;
    gradient_.tail(shared) = prior_information_ * (prior_.mean - values_.tail(shared));
    information_.diagonal().segment<kVelocities>(kVelocity).array() += 1.0;
    gradient_.segment<kVelocities>(kVelocity) -= values_.segment<kVelocities>(kVelocity);
    if (frame_.standing_deviations) addStanding(*frame_.standing_deviations);
    Eigen::Index increment = kFirstIncrement;
    for (const KeyFrame::Sight& sight : frame_.sights) {
      if (!addSight(sight, increment)) return false;
      if (sight.increment) increment += 6;
    }
    return true;
  }

  void addStanding(const Eigen::Vector3d& deviations) {
    constexpr Eigen::Index kOwn = 3;  // z, roll and pitch in a PoseVector
    Eigen::MatrixXd by_unknowns = Eigen::MatrixXd::Zero(3, values_.size());
    by_unknowns.middleCols<3>(kOwn).setIdentity();
    by_unknowns.middleCols<3>(kStanding) = -Eigen::Matrix3d::Identity();
    const PoseVector off = difference(pose_, leaningAs(frame_.lean, pose_));
    const Eigen::Vector3d residual = values_.segment<3>(kStanding) - off.tail<3>();
    add(by_unknowns, residual, deviations.cwiseAbs2().cwiseInverse().asDiagonal().toDenseMatrix());
  }

  /// False if the camera does not see the marker.
  bool addSight(const KeyFrame::Sight& sight, Eigen::Index column) {
    ImagingError error;
    error << values_.segment<kCameraModes>(kMode), values_.segment<kVelocities>(kVelocity);
    MarkerIncrement increment = MarkerIncrement::Zero();
    if (sight.increment) increment = values_.segment<6>(column);
    const Marker marker = markerAt(sight.prior, increment.data(), sight.prior.size);
    const auto projection = projectMarker(marker, frame_.camera.withError(error), pose_);
    if (!projection) return false;
    Eigen::MatrixXd by_unknowns = Eigen::MatrixXd::Zero(8, values_.size());
    by_unknowns.leftCols<6>() = projection->by_pose;
    by_unknowns.middleCols<kVelocities>(kVelocity) = projection->by_error.rightCols<kVelocities>();
    by_unknowns.middleCols<kCameraModes>(kMode) = projection->by_error.leftCols<kCameraModes>();
    if (sight.increment) {
      by_unknowns.middleCols<3>(column) = projection->by_marker.leftCols<3>();
      by_unknowns.middleCols<3>(column + 3) =
          projection->by_marker.rightCols<3>() * leftJacobian(increment.tail<3>());
    }
    Eigen::Matrix<double, 8, 8> covariance = sight.corners.covariance;
    const double local = frame_.camera.model().uncertainty().local();
    covariance.diagonal().array() += local * local;
    const Eigen::MatrixXd information =
        covariance.llt().solve(Eigen::Matrix<double, 8, 8>::Identity());
    const CornerPixels off = sight.corners.pixels - projection->pixels;
    std::array<double, 3> loss{};  // and its derivatives, of which the first is the weight
    ExpectedLoss(kExpectedOfMarker).Evaluate(off.dot(information * off), loss.data());
    add(by_unknowns, off, loss[1] * information);
    return true;
  }

  void add(const Eigen::MatrixXd& by_unknowns, const Eigen::VectorXd& residual,
           const Eigen::MatrixXd& information) {
    const Eigen::MatrixXd weighted = information * by_unknowns;
    information_ += by_unknowns.transpose() * weighted;
    gradient_ += weighted.transpose() * residual;
  }

  const KeyFrame& frame_;
  std::vector<Eigen::Index> indices_;
  JointEstimate prior_;
  Eigen::MatrixXd prior_information_;
  Pose pose_;
  /// At the columns of the pose: nothing.
  Eigen::VectorXd values_;
  Eigen::MatrixXd information_;
  Eigen::VectorXd gradient_;
};

}  // namespace

Eigen::Vector3d standingDeviations(const FloorConfig& floor) {
  const Eigen::Vector3d deviations(floor.height_deviation, floor.lean_deviation,
                                   floor.lean_deviation);
  return deviations.cwiseMax(kLeastDeviation);
}

bool learnFrom(const KeyFrame& frame, JointEstimate* joint) {
  FrameFit fit(frame, *joint);
  const std::optional<JointEstimate> after = fit.solve();
  if (!after) return false;
  joint->update(fit.indices(), *after);
  return true;
}

}  // namespace omnitag
