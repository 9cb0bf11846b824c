#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "omnitag/photometry/marker_patch.h"
#include "omnitag/photometry/pixel_noise.h"

namespace omnitag {

/// The light on a marker: black, and the coefficients of the contrast, a polynomial of the second
/// degree over the marker, as lamps nearby and soft shadows have it.
constexpr int kLightTerms = 7;
using Light = Eigen::Matrix<double, kLightTerms, 1>;

/// What a marker's pixels say about the pose once the light on it is fitted: grey = black +
/// white * contrast(position). Pixels that are too bright or too dark for the image to tell how
/// bright they are have no say.
struct LitPatch {
  Light light = Light::Zero();
  /// How the light that fits best changes with the pose.
  Eigen::Matrix<double, kLightTerms, 3> light_by_pose =
      Eigen::Matrix<double, kLightTerms, 3>::Zero();
  /// Of the pose (x, y, yaw), if the pixels err independently, as their noise says.
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  /// The information times what the pose is to change by.
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();

  /// The light that fits best once the pose changes so.
  Light lightAfter(const Eigen::Vector3d& change) const { return light + light_by_pose * change; }
};

/// Fits the light in the sense of weighted least squares and linearises what remains by the pose.
/// Pixels are weighed by how well the light explains them that the fit starts from, once the pose
/// changes as expected; without it, that is one in which all of them count alike. Nothing where
/// there are too few pixels or hardly any contrast.
std::optional<LitPatch> fitLight(const std::vector<MarkerPixel>& pixels, const PixelNoise& noise,
                                 const std::optional<Light>& start = std::nullopt,
                                 const Eigen::Vector3d& expected_change = Eigen::Vector3d::Zero());

/// A pixel's difference from the pattern in some light, once the pose changes so.
PixelResidual residualOf(const MarkerPixel& pixel, const Light& light,
                         const Eigen::Vector3d& change);

/// Covariance of the gradient as the residuals themselves show it that are left once the pose
/// changes so, pixel by pixel, whatever their noise was taken for (Huber and White): pixels at
/// edges err more than others, and some more than most.
Eigen::Matrix3d gradientCovariance(const std::vector<MarkerPixel>& pixels, const LitPatch& patch,
                                   const PixelNoise& noise, const Eigen::Vector3d& change);

}  // namespace omnitag
