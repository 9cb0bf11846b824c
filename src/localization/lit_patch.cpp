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
  const double white_x = pixel.white * x;
  const double white_y = pixel.white * y;
  regressors << 1.0, pixel.white, white_x, white_y, white_x * x, white_x * y, white_y * y;
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
  constexpr std::size_t kEnough = 200;
  if (pixels.size() < kFewestPixels) return std::nullopt;
  LitPatch patch;
  patch.residuals.assign(pixels.size(), {});
  Eigen::LDLT<Eigen::Matrix<double, kLightTerms, kLightTerms>> factors;
  // The first round weighs all pixels alike, and some will do; the second knows what is off.
  constexpr int kRounds = 2;
  for (int round = 0; round < kRounds; ++round) {
    const std::size_t every = round == 0 ? std::max<std::size_t>(1, pixels.size() / kEnough) : 1;
    // The last column and row are what the regressors have in common with the grey level.
    Eigen::Matrix<double, kLightTerms + 1, kLightTerms + 1> sums;
    sums.setZero();
    for (std::size_t i = 0; i < pixels.size(); i += every) {
      if (isSaturated(pixels[i], patch.residuals[i])) continue;
      Eigen::Matrix<double, kLightTerms + 1, 1> x;
      x << regressorsOf(pixels[i]), pixels[i].grey;
      const Eigen::Matrix<double, kLightTerms + 1, 1> weighted =
          weightOf(patch.residuals[i], noise) * x;
      sums.noalias() += weighted * x.transpose();
    }
    factors.compute(sums.topLeftCorner<kLightTerms, kLightTerms>());
    if (factors.info() != Eigen::Success || !(factors.vectorD().minCoeff() > 1e-9)) {
      return std::nullopt;
    }
    patch.light = factors.solve(sums.topRightCorner<kLightTerms, 1>());
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const double contrast = contrastAt(pixels[i].position, patch.light);
      patch.residuals[i] = {pixels[i].grey - patch.light[0] - pixels[i].white * contrast,
                            pixels[i].gradient, contrast * pixels[i].gradient};
    }
  }
  constexpr double kLowestContrast = 8.0;
  if (patch.light[1] < kLowestContrast) return std::nullopt;

  // The rows: what the regressors, a zero, the derivatives by the pose and the residual have in
  // common with the latter four.
  Eigen::Matrix<double, kLightTerms + 5, 4> sums;
  sums.setZero();
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (isSaturated(pixels[i], patch.residuals[i])) continue;
    Eigen::Matrix<double, kLightTerms + 5, 1> x;
    x << regressorsOf(pixels[i]), 0.0, greyByPose(pixels[i], patch.light).transpose(),
        patch.residuals[i].grey;
    const Eigen::Vector4d weighted = weightOf(patch.residuals[i], noise) * x.tail<4>();
    sums.noalias() += x * weighted.transpose();
  }
  patch.information = sums.block<3, 3>(kLightTerms + 1, 0);
  patch.gradient = sums.block<3, 1>(kLightTerms + 1, 3);
  const auto mixed = sums.topLeftCorner<kLightTerms, 3>();
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
