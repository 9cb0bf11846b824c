#include "measurement/pose_prior.h"

#include <algorithm>

#include "common/least_deviation.h"
#include "common/symmetric_matrix.h"

namespace omnitag {
namespace {}  // namespace

PosePrior PosePrior::about(const PoseEstimate& estimate) {
  PosePrior prior;
  prior.pose = estimate.pose;
  PoseMatrix covariance = estimate.covariance;
  covariance.diagonal() = covariance.diagonal().cwiseMax(kLeastDeviation * kLeastDeviation).eval();
  prior.information = inverseOf(covariance);
  prior.shared = estimate.shared;
  prior.knows_place = true;
  return prior;
}

PosePrior PosePrior::standing(const Pose& lean, double height_deviation, double lean_deviation) {
  const auto informationOf = [](double deviation) {
    return 1.0 / (deviation * deviation + kLeastDeviation * kLeastDeviation);
  };
  PosePrior prior;
  prior.pose = leaningAs(lean, {});
  prior.information.diagonal().tail<3>() << informationOf(height_deviation),
      informationOf(lean_deviation), informationOf(lean_deviation);
  return prior;
}

PosePrior PosePrior::upright() { return standing({}, 0.0, 0.0); }

PosePrior PosePrior::withPlace(const Pose& place, const Eigen::Matrix3d& place_information) const {
  PosePrior prior = *this;
  prior.pose = leaningAs(pose, place);
  prior.information.topLeftCorner<3, 3>() = place_information;
  prior.knows_place = true;
  return prior;
}

PosePrior PosePrior::pushed(const PoseVector& deviations) const {
  PoseEstimate estimate{pose, covariance(), shared};
  estimate.covariance.diagonal() += deviations.cwiseAbs2();
  return about(estimate);
}

PoseMatrix PosePrior::covariance() const { return inverseOf(information); }

PosePrior PosePrior::withoutPlace() const {
  if (!knows_place) return *this;
  PosePrior prior;
  prior.pose = pose;
  // Marginalises x, y and yaw.
  prior.information.bottomRightCorner<3, 3>() = inverseOf(covariance().bottomRightCorner<3, 3>());
  return prior;
}

bool PosePrior::knowsStanding() const { return !information.bottomRightCorner<3, 3>().isZero(0.0); }

PoseVector PosePrior::errorOf(const Pose& other) const {
  return difference(other, knows_place ? pose : leaningAs(pose, other));
}

}  // namespace omnitag
