#pragma once

#include <optional>

#include "camera/mounted_camera.h"
#include "measurement/pose_prior.h"
#include "omnitag/common/pose.h"

namespace omnitag {

/// What markers say about a frame's unknowns, linearised: the normal equations of least squares,
/// with the error of their right-hand side.
struct FrameEquations {
  FrameMatrix information = FrameMatrix::Zero();
  /// The information times the change of the unknowns that the markers ask for.
  FrameVector gradient = FrameVector::Zero();
  /// Covariance of the gradient's error: the part that is random in each image, and the part that
  /// all images share.
  FrameMatrix by_chance = FrameMatrix::Zero();
  FrameMatrix by_shared = FrameMatrix::Zero();

  void add(const FrameEquations& other, double weight);
};

/// The equations of one marker that may hang elsewhere than the map says (misplacementOf()): the
/// misplacement is marginalised, which reduces the information, and its error is shared by all
/// images.
FrameEquations withMisplacement(const FrameEquations& marker, const PoseMatrix& misplacement);

/// The equations plus the priors at a pose and an imaging error: that of the pose, and for each
/// part of the imaging error a standard deviation of 1 about zero.
FrameEquations withPriors(const FrameEquations& markers, const PosePrior& prior, const Pose& pose,
                          const ImagingError& error);

/// How many parts of the imaging error are possible at all. The others are zero because the camera
/// is exact or did not move.
int possibleErrors(const ImagingError& error);

/// How badly a marker disagrees with a change of the unknowns, as chi-square with the six degrees
/// of freedom of a pose: whatever is wrong with a single marker, it seems to be misplaced. `scale`:
/// the covariance that the gradient should have; by default, that of the gradient's error.
double chiSquareOf(const FrameEquations& marker, const PoseMatrix& scale,
                   const FrameVector& change);
double chiSquareOf(const FrameEquations& marker, const FrameVector& change);

/// The change that solves the equations, priors included; nothing if they leave it undetermined.
std::optional<FrameVector> solutionOf(const FrameEquations& equations);

/// The pose with its covariance, after the unknowns have changed as the equations ask. `markers`:
/// without priors. `excess`: the factor by which the variances of markers and camera exceed what is
/// expected.
///
/// An estimate has random errors, errors that this image shares with earlier ones, and errors of
/// the prior. The prior's own shared part may err in the image's direction or against it; the
/// covariance holds for either (split covariance intersection, Julier and Uhlmann 2001). A quarter
/// of the markers' random variance counts as shared, since the pixels of an unmoved robot repeat
/// their errors: however many images are averaged, half of the deviation of one remains.
PoseEstimate estimateOf(const FrameEquations& markers, const PosePrior& prior, const Pose& pose,
                        double excess);

}  // namespace omnitag
