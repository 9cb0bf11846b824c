#pragma once

#include <optional>

#include "omnitag/camera/mounted_camera.h"
#include "omnitag/common/pose.h"
#include "omnitag/measurement/pose_prior.h"

namespace omnitag {

/// What markers say about a frame's unknowns, linearised: normal equations of least squares, and by
/// what their right side errs.
struct FrameEquations {
  FrameMatrix information = FrameMatrix::Zero();
  /// The information times the change that the markers ask for.
  FrameVector gradient = FrameVector::Zero();
  /// Covariance of the gradient's error: what is random in each image, and what all images
  /// share.
  FrameMatrix by_chance = FrameMatrix::Zero();
  FrameMatrix by_shared = FrameMatrix::Zero();

  void add(const FrameEquations& other, double weight);
};

/// The equations of a marker (`markers` of one, its shared part not looked at) that hangs elsewhere
/// than the map says, as by misplacementOf(): marginalised, so that it tells that much less, and
/// what it errs by is shared.
FrameEquations withMisplacement(const FrameEquations& marker, const PoseMatrix& misplacement);

/// The equations with what is known beforehand: the prior of the pose, and that each part of the
/// imaging error is one of standard deviation 1 about zero. At a pose, and at the error that is
/// assumed there.
FrameEquations withPriors(const FrameEquations& markers, const PosePrior& prior, const Pose& pose,
                          const ImagingError& error);

/// How many parts of the imaging error there are at all: the others are zero, since the camera is
/// exact, or did not move.
int possibleErrors(const ImagingError& error);

/// How badly a marker disagrees about a change of the unknowns, as chi-square with as many degrees
/// of freedom as a pose has: whatever is wrong with one marker, it seems to hang elsewhere.
/// `scale`: the covariance that what it asks for should have; without, that of what it errs by.
double chiSquareOf(const FrameEquations& marker, const PoseMatrix& scale,
                   const FrameVector& change);
double chiSquareOf(const FrameEquations& marker, const FrameVector& change);

/// The change that solves equations with their priors; nothing where they leave something open.
std::optional<FrameVector> solutionOf(const FrameEquations& equations);

/// The pose with its covariance, once the unknowns have changed as the equations ask for: of
/// markers, without priors. `excess`: how many times larger than they say the markers' and the
/// camera's variances turned out to be.
///
/// An estimate errs by chance, by what this image shares with those before, and by what the prior
/// does. The prior's own shared part may err just as the image's or against it; the covariance
/// holds for either (split covariance intersection, Julier and Uhlmann 2001). A quarter of what
/// chance gives the markers counts as shared, since the pixels of an unmoved robot repeat their
/// errors: however many images are averaged, half of the deviation of one remains.
PoseEstimate estimateOf(const FrameEquations& markers, const PosePrior& prior, const Pose& pose,
                        double excess);

}  // namespace omnitag
