#include "lit_patch.h"

#include <Eigen/Cholesky>
#include <algorithm>

namespace omnitag {
namespace {

/// What a pixel's grey level is a sum of in some light, and the grey level itself last.
using Column = Eigen::Matrix<double, kLightTerms + 1, 1>;

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
  // To write a vector number by number and read it at once as a whole would take most of the time.
  std::vector<Column> columns(pixels.size());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    columns[i] << regressorsOf(pixels[i]), pixels[i].grey;
  }
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
      const Column weighted = weightOf(patch.residuals[i], noise) * columns[i];
      sums.noalias() += weighted * columns[i].transpose();
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

  // The derivatives by the pose, and the residual.
  std::vector<Eigen::Vector4d> changes(pixels.size());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    changes[i] << greyByPose(pixels[i], patch.light).transpose(), patch.residuals[i].grey;
  }
  // What they have in common with each other, and the regressors with them.
  Eigen::Matrix4d among_changes = Eigen::Matrix4d::Zero();
  Eigen::Matrix<double, kLightTerms + 1, 4> mixed;
  mixed.setZero();
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (isSaturated(pixels[i], patch.residuals[i])) continue;
    const Eigen::Vector4d weighted = weightOf(patch.residuals[i], noise) * changes[i];
    among_changes.noalias() += changes[i] * weighted.transpose();
    mixed.noalias() += columns[i] * weighted.transpose();
  }
  patch.information = among_changes.topLeftCorner<3, 3>();
  patch.gradient = among_changes.topRightCorner<3, 1>();
  const auto light_and_pose = mixed.topLeftCorner<kLightTerms, 3>();
  // The light is free: what it could explain says nothing about the pose.
  patch.light_by_pose = -factors.solve(light_and_pose);
  patch.information += light_and_pose.transpose() * patch.light_by_pose;
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
