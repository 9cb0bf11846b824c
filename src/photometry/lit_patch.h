#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "camera/mounted_camera.h"
#include "omnitag/camera/camera_uncertainty.h"
#include "photometry/marker_patch.h"
#include "photometry/pixel_noise.h"

namespace omnitag {

/// The light on a marker: black, and the coefficients of the contrast, a polynomial of the second
/// degree over the marker, as with lamps nearby and soft shadows.
constexpr int kLightTerms = 7;
using Light = Eigen::Matrix<double, kLightTerms, 1>;

/// How the camera distorts the image of a marker: coefficients of displacementByShape(), of
/// standard deviation 1 about zero.
using Shape = Eigen::Matrix<double, kShapeTerms, 1>;

/// Equations of a marker's pixels for a frame's unknowns, with the light on it fitted: grey = black
/// + white * contrast(position). Pixels that may be clipped do not count. The marker's shape, if it
/// is uncertain, is marginalised.
struct LitPatch {
  Light light = Light::Zero();
  /// The change of the shape that the pixels were taken with.
  Shape shape_change = Shape::Zero();
  CameraUncertainty uncertainty;
  /// How the light and the shape that fit best change with the unknowns.
  Eigen::Matrix<double, kLightTerms, kFrameUnknowns> light_by_frame =
      Eigen::Matrix<double, kLightTerms, kFrameUnknowns>::Zero();
  Eigen::Matrix<double, kShapeTerms, kFrameUnknowns> shape_by_frame =
      Eigen::Matrix<double, kShapeTerms, kFrameUnknowns>::Zero();
  /// Of the unknowns, if the pixels err independently with the assumed noise.
  FrameMatrix information = FrameMatrix::Zero();
  /// The information times the change of the unknowns that fits best.
  FrameVector gradient = FrameVector::Zero();
  /// Covariance of the gradient's error due to the shape, which all images share.
  FrameMatrix by_shape = FrameMatrix::Zero();

  /// The light, and the change of the shape, that fit best after this change of the unknowns.
  Light lightAfter(const FrameVector& change) const { return light + light_by_frame * change; }
  Shape shapeChangeAfter(const FrameVector& change) const {
    return shape_change + shape_by_frame * change;
  }

  /// The change of the position on the drawing (modules), for each facet, with that shape.
  std::vector<Eigen::Vector2d> positionChanges(const MarkerPixels& pixels,
                                               const FrameVector& change) const;
};

/// What is expected of a marker's pixels: it determines the residuals that they are weighted by.
struct ExpectedPixels {
  /// If unknown, one is fitted with equal weights.
  std::optional<Light> light;
  FrameVector change = FrameVector::Zero();
  Shape shape_change = Shape::Zero();
};

/// The changes of the position on the drawing due to a shape; none if it is zero, as for an exact
/// camera.
FacetChanges changesByShape(const std::vector<Facet>& facets, const Shape& shape,
                            const CameraUncertainty& uncertainty);

/// Fits the light by weighted least squares and linearises the remaining residuals in the unknowns.
/// `uncertainty`: of the camera; `shape`: that the pixels were taken with, zero for an exact
/// camera. Nothing if there are too few pixels or hardly any contrast.
std::optional<LitPatch> fitLight(const MarkerPixels& pixels, const PixelNoise& noise,
                                 const CameraUncertainty& uncertainty, const Shape& shape,
                                 const ExpectedPixels& expected);

/// Grey levels between black and white in some light, at a MarkerPixel's position.
double contrastAt(const Eigen::Vector2d& position, const Light& light);

/// A pixel's difference from the pattern in this light, after the position on the drawing that it
/// sees has changed by `position_change` (modules).
PixelResidual residualOf(const MarkerPixel& pixel, const Light& light,
                         const Eigen::Vector2d& position_change);

/// Covariance of the gradient, estimated pixel by pixel from the residuals that remain after this
/// change of the unknowns, whatever noise was assumed (Huber and White): pixels at edges err more
/// than others, and some more than most.
FrameMatrix gradientCovariance(const MarkerPixels& pixels, const LitPatch& patch,
                               const PixelNoise& noise, const FrameVector& change);

}  // namespace omnitag
