#include "lit_patch.h"

#include <Eigen/Cholesky>
#include <algorithm>

namespace omnitag {
namespace {

/// 1, and what the contrast is a sum of.
Light regressorsOf(const MarkerPixel& pixel) {
  const double x = pixel.position.x();
  const double y = pixel.position.y();
  Light regressors;
  regressors << 1.0, pixel.white * 1.0, pixel.white * x, pixel.white * y, pixel.white * x * x,
      pixel.white * x * y, pixel.white * y * y;
  return regressors;
}

double contrastAt(const Eigen::Vector2d& position, const Light& light) {
  const double x = position.x();
  const double y = position.y();
  return light[1] + light[2] * x + light[3] * y + light[4] * x * x + light[5] * x * y +
         light[6] * y * y;
}

/// Derivative of a pixel's grey level by the pose, in this light.
Eigen::RowVector3d greyByPose(const MarkerPixel& pixel, const Light& light) {
  return contrastAt(pixel.position, light) * pixel.white_by_pose;
}

bool isSaturated(const MarkerPixel& pixel, const PixelResidual& residual) {
  return omnitag::isSaturated(pixel.grey, pixel.grey - residual.grey);
}

}  // namespace

std::optional<LitPatch> fitLight(const std::vector<MarkerPixel>& pixels, const PixelNoise& noise) {
  constexpr std::size_t kFewestPixels = 24;
  if (pixels.size() < kFewestPixels) return std::nullopt;
  LitPatch patch;
  patch.residuals.assign(pixels.size(), {});
  Eigen::LDLT<Eigen::Matrix<double, kLightTerms, kLightTerms>> factors;
  // The first round weighs all pixels alike, the second knows what is off.
  constexpr int kRounds = 2;
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix<double, kLightTerms, kLightTerms> normal =
        Eigen::Matrix<double, kLightTerms, kLightTerms>::Zero();
    Light right_side = Light::Zero();
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const Light x = regressorsOf(pixels[i]);
      if (isSaturated(pixels[i], patch.residuals[i])) continue;
      const double weight = weightOf(patch.residuals[i], noise);
      normal.noalias() += weight * x * x.transpose();
      right_side += weight * pixels[i].grey * x;
    }
    factors.compute(normal);
    if (factors.info() != Eigen::Success || !(factors.vectorD().minCoeff() > 1e-9)) {
      return std::nullopt;
    }
    patch.light = factors.solve(right_side);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const double contrast = contrastAt(pixels[i].position, patch.light);
      patch.residuals[i] = {pixels[i].grey - patch.light.dot(regressorsOf(pixels[i])),
                            pixels[i].gradient, contrast * pixels[i].gradient};
    }
  }
  constexpr double kLowestContrast = 8.0;
  if (patch.light[1] < kLowestContrast) return std::nullopt;

  Eigen::Matrix<double, kLightTerms, 3> mixed = Eigen::Matrix<double, kLightTerms, 3>::Zero();
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (isSaturated(pixels[i], patch.residuals[i])) continue;
    const Eigen::RowVector3d by_pose = greyByPose(pixels[i], patch.light);
    const double weight = weightOf(patch.residuals[i], noise);
    patch.information.noalias() += weight * by_pose.transpose() * by_pose;
    patch.gradient += weight * patch.residuals[i].grey * by_pose.transpose();
    mixed.noalias() += weight * regressorsOf(pixels[i]) * by_pose;
  }
  // The light is free: what it could explain says nothing about the pose.
  patch.light_by_pose = -factors.solve(mixed);
  patch.information += mixed.transpose() * patch.light_by_pose;
  return patch;
}

Eigen::Matrix3d gradientCovariance(const std::vector<MarkerPixel>& pixels, const LitPatch& patch,
                                   const PixelNoise& noise) {
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  int count = 0;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (isSaturated(pixels[i], patch.residuals[i])) continue;
    // The light gives way to a change of the pose.
    const Eigen::RowVector3d by_pose = greyByPose(pixels[i], patch.light) +
                                       regressorsOf(pixels[i]).transpose() * patch.light_by_pose;
    const Eigen::RowVector3d gradient =
        weightOf(patch.residuals[i], noise) * patch.residuals[i].grey * by_pose;
    covariance.noalias() += gradient.transpose() * gradient;
    ++count;
  }
  // What was fitted takes its share of the residuals.
  constexpr int kFitted = kLightTerms + 3;
  return covariance * count / std::max(count - kFitted, 1);
}

}  // namespace omnitag
