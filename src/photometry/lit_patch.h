#pragma once

#include <Eigen/Core>
#include <optional>

#include "omnitag/camera/mounted_camera.h"
#include "omnitag/photometry/marker_patch.h"
#include "omnitag/photometry/pixel_noise.h"

namespace omnitag {

/// The light on a marker: black, and the coefficients of the contrast, a polynomial of the second
/// degree over the marker, as with lamps nearby and soft shadows.
constexpr int kLightTerms = 7;
using Light = Eigen::Matrix<double, kLightTerms, 1>;

/// Equations of a marker's pixels for a frame's unknowns, with the light on it fitted: grey = black
/// + white * contrast(position). Pixels that may be clipped do not count.
struct LitPatch {
  Light light = Light::Zero();
  /// How the light that fits best changes with the unknowns.
  Eigen::Matrix<double, kLightTerms, kFrameUnknowns> light_by_frame =
      Eigen::Matrix<double, kLightTerms, kFrameUnknowns>::Zero();
  /// Of the unknowns, if the pixels err independently with the assumed noise.
  FrameMatrix information = FrameMatrix::Zero();
  /// The information times the change of the unknowns that fits best.
  FrameVector gradient = FrameVector::Zero();

  /// The light that fits best after this change of the unknowns.
  Light lightAfter(const FrameVector& change) const { return light + light_by_frame * change; }
};

/// Fits the light by weighted least squares and linearises the remaining residuals by the unknowns.
/// Pixels are weighted by how well the light `start` explains them after the expected change of the
/// unknowns; without `start`, by a light fitted with equal weights. Nothing if there are too few
/// pixels or hardly any contrast.
std::optional<LitPatch> fitLight(const MarkerPixels& pixels, const PixelNoise& noise,
                                 const std::optional<Light>& start = std::nullopt,
                                 const FrameVector& expected_change = FrameVector::Zero());

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
