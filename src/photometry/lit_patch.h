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

/// What a marker's pixels say about a frame's unknowns once the light on it is fitted: grey =
/// black + white * contrast(position). Pixels that are too bright or too dark for the image to tell
/// how bright they are have no say.
struct LitPatch {
  Light light = Light::Zero();
  /// How the light that fits best changes with the unknowns.
  Eigen::Matrix<double, kLightTerms, kFrameUnknowns> light_by_frame =
      Eigen::Matrix<double, kLightTerms, kFrameUnknowns>::Zero();
  /// Of the unknowns, if the pixels err independently, as their noise says.
  FrameMatrix information = FrameMatrix::Zero();
  /// The information times what the unknowns are to change by.
  FrameVector gradient = FrameVector::Zero();

  /// The light that fits best once the unknowns change so.
  Light lightAfter(const FrameVector& change) const { return light + light_by_frame * change; }
};

/// Fits the light in the sense of weighted least squares and linearises what remains by the
/// unknowns. Pixels are weighed by how well the light explains them that the fit starts from, once
/// the unknowns change as expected; without it, that is one in which all of them count alike.
/// Nothing where there are too few pixels or hardly any contrast.
std::optional<LitPatch> fitLight(const MarkerPixels& pixels, const PixelNoise& noise,
                                 const std::optional<Light>& start = std::nullopt,
                                 const FrameVector& expected_change = FrameVector::Zero());

/// Grey levels between black and white in some light, at a MarkerPixel's position.
double contrastAt(const Eigen::Vector2d& position, const Light& light);

/// A pixel's difference from the pattern in some light, once the position on the drawing that it
/// sees changes so (modules).
PixelResidual residualOf(const MarkerPixel& pixel, const Light& light,
                         const Eigen::Vector2d& position_change);

/// Covariance of the gradient as the residuals themselves show it that are left once the unknowns
/// change so, pixel by pixel, whatever their noise was taken for (Huber and White): pixels at edges
/// err more than others, and some more than most.
FrameMatrix gradientCovariance(const MarkerPixels& pixels, const LitPatch& patch,
                               const PixelNoise& noise, const FrameVector& change);

}  // namespace omnitag
