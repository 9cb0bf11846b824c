#include "measurement/frame_equations.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

#include "common/symmetric_matrix.h"

namespace omnitag {
namespace {

/// Share of the markers' random variance that an unmoved robot's next image repeats.
constexpr double kRepeated = 0.25;

using PoseRows = Eigen::Matrix<double, 6, kFrameUnknowns>;
using ByPose = Eigen::Matrix<double, kFrameUnknowns, 6>;

/// (1 - L) C (1 - L)^T, where L is `lost` in the columns of the pose.
FrameMatrix withoutLost(const FrameMatrix& covariance, const ByPose& lost) {
  const ByPose by_pose = covariance.leftCols<6>();
  const FrameMatrix crossed = lost.lazyProduct(by_pose.transpose());
  const ByPose lost_part = lost.lazyProduct(PoseMatrix(by_pose.topRows<6>()));
  return covariance - crossed - crossed.transpose() +
         FrameMatrix(lost_part.lazyProduct(lost.transpose()));
}

}  // namespace

void FrameEquations::add(const FrameEquations& other, double weight) {
  information += weight * other.information;
  gradient += weight * other.gradient;
  by_chance += weight * weight * other.by_chance;
  by_shared += weight * weight * other.by_shared;
}

FrameEquations withMisplacement(const FrameEquations& marker, const PoseMatrix& misplacement) {
  // (information^-1 + misplacement)^-1, even if the information is singular. The products are lazy,
  // since Eigen would otherwise treat these matrices as large.
  const ByPose by_pose = marker.information.leftCols<6>();
  const PoseMatrix information = by_pose.topRows<6>();
  const PoseMatrix factor =
      PoseMatrix::Identity() + PoseMatrix(information.lazyProduct(misplacement));
  const PoseMatrix loss = misplacement.lazyProduct(PoseMatrix(factor.inverse()));
  const ByPose lost = by_pose.lazyProduct(loss);
  FrameEquations equations;
  equations.information = marker.information;
  equations.information -= lost.lazyProduct(by_pose.transpose());
  equations.gradient = marker.gradient;
  equations.gradient -= lost.lazyProduct(marker.gradient.head<6>());
  equations.by_chance = withoutLost(marker.by_chance, lost);
  const ByPose shared = by_pose - ByPose(lost.lazyProduct(information));
  equations.by_shared = ByPose(shared.lazyProduct(misplacement)).lazyProduct(shared.transpose());
  if (!marker.by_shared.isZero(0.0)) equations.by_shared += withoutLost(marker.by_shared, lost);
  return equations;
}

FrameEquations withPriors(const FrameEquations& markers, const PosePrior& prior, const Pose& pose,
                          const ImagingError& error) {
  FrameEquations all = markers;
  all.information.topLeftCorner<6, 6>() += prior.information;
  all.gradient.head<6>() -= prior.information * prior.errorOf(pose);
  all.information.diagonal().tail<kImagingUnknowns>().array() += 1.0;
  all.gradient.tail<kImagingUnknowns>() -= error;
  return all;
}

int possibleErrors(const ImagingError& error) {
  return static_cast<int>((error.array() != 0.0).count());
}

double chiSquareOf(const FrameEquations& marker, const PoseMatrix& scale,
                   const FrameVector& change) {
  const PoseVector gradient = (marker.gradient - marker.information * change).head<6>();
  return mahalanobisSquare(gradient, scale);
}

double chiSquareOf(const FrameEquations& marker, const FrameVector& change) {
  return chiSquareOf(marker, (marker.by_chance + marker.by_shared).topLeftCorner<6, 6>(), change);
}

std::optional<FrameVector> solutionOf(const FrameEquations& equations) {
  const Eigen::LLT<FrameMatrix> factors(equations.information);
  if (factors.info() != Eigen::Success) return std::nullopt;
  const FrameVector change = factors.solve(equations.gradient);
  return change.allFinite() ? std::optional(change) : std::nullopt;
}

PoseEstimate estimateOf(const FrameEquations& markers, const PosePrior& prior, const Pose& pose,
                        double excess) {
  FrameMatrix information = markers.information;
  information.topLeftCorner<6, 6>() += prior.information;
  information.diagonal().tail<kImagingUnknowns>().array() += 1.0;
  const PoseRows gain = inverseOf(information).topRows<6>();
  const auto through = [](const auto& rows, const auto& covariance) -> PoseMatrix {
    return rows * covariance * rows.transpose();
  };
  const Eigen::Matrix<double, 6, 6> prior_gain = gain.leftCols<6>() * prior.information;
  FrameMatrix image_shared = markers.by_shared + kRepeated * markers.by_chance;
  image_shared.diagonal().segment<kCameraModes>(6).array() += 1.0;
  // The motion differs from image to image.
  FrameMatrix image_chance = (1.0 - kRepeated) * markers.by_chance;
  image_chance.diagonal().tail<kImagingUnknowns - kCameraModes>().array() += 1.0;
  const PoseMatrix of_prior = through(prior_gain, prior.shared);
  const PoseMatrix of_image = excess * through(gain, image_shared);
  // The weights that minimise the trace.
  const double a = std::sqrt(of_prior.trace());
  const double b = std::sqrt(of_image.trace());
  PoseEstimate estimate;
  estimate.pose = pose;
  const bool have_both = a > 0.0 && b > 0.0;
  estimate.shared = have_both ? PoseMatrix((1.0 + b / a) * of_prior + (1.0 + a / b) * of_image)
                              : PoseMatrix(of_prior + of_image);
  const PoseMatrix prior_chance =
      gain.leftCols<6>() * prior.information * gain.leftCols<6>().transpose() - of_prior;
  estimate.covariance = excess * through(gain, image_chance) + prior_chance + estimate.shared;
  estimate.covariance = 0.5 * (estimate.covariance + estimate.covariance.transpose()).eval();
  estimate.shared = 0.5 * (estimate.shared + estimate.shared.transpose()).eval();
  return estimate;
}

}  // namespace omnitag
