#include "lit_patch.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>

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

using LightInformation = Eigen::Matrix<double, kLightTerms, kLightTerms>;

/// Nothing where the pixels leave some of the light open.
std::optional<Eigen::LDLT<LightInformation>> factorsOf(const LightInformation& information) {
  std::optional<Eigen::LDLT<LightInformation>> factors(information);
  const bool is_known = factors->info() == Eigen::Success && factors->vectorD().minCoeff() > 1e-9;
  return is_known ? factors : std::nullopt;
}

/// From some of the pixels, all alike.
std::optional<Light> roughLight(const std::vector<MarkerPixel>& pixels) {
  constexpr std::size_t kEnough = 200;
  const std::size_t every = std::max<std::size_t>(1, pixels.size() / kEnough);
  LightInformation information = LightInformation::Zero();
  Light gradient = Light::Zero();
  for (std::size_t i = 0; i < pixels.size(); i += every) {
    if (omnitag::isSaturated(pixels[i].grey, pixels[i].grey)) continue;
    const Light regressors = regressorsOf(pixels[i]);
    information.noalias() += regressors * regressors.transpose();
    gradient += pixels[i].grey * regressors;
  }
  const auto factors = factorsOf(information);
  return factors ? std::optional<Light>(factors->solve(gradient)) : std::nullopt;
}

/// A pixel's part in least squares in the light, the pose, and the residual.
struct Terms {
  double weight = 0.0;
  /// What the grey level is a sum of in some light, and the residual.
  Eigen::Matrix<double, kLightTerms + 1, 1> light;
  /// The derivatives by the pose, and the residual.
  Eigen::Vector4d change;
};

Terms termsOf(const MarkerPixel& pixel, const Light& light, const PixelNoise& noise,
              const Eigen::Vector3d& expected_change) {
  const double residual = residualOf(pixel, light, Eigen::Vector3d::Zero()).grey;
  const PixelResidual expected = residualOf(pixel, light, expected_change);
  Terms terms;
  terms.weight = isSaturated(pixel, expected) ? 0.0 : weightOf(expected, noise);
  terms.light << regressorsOf(pixel), residual;
  terms.change << greyByPose(pixel, light).transpose(), residual;
  return terms;
}

}  // namespace

std::optional<LitPatch> fitLight(const std::vector<MarkerPixel>& pixels, const PixelNoise& noise,
                                 const std::optional<Light>& start,
                                 const Eigen::Vector3d& expected_change) {
  constexpr std::size_t kFewestPixels = 24;
  if (pixels.size() < kFewestPixels) return std::nullopt;
  const std::optional<Light> rough = start ? start : roughLight(pixels);
  if (!rough) return std::nullopt;

  Eigen::Matrix<double, kLightTerms + 1, kLightTerms + 1> of_light;
  Eigen::Matrix<double, kLightTerms + 1, 4> mixed;
  Eigen::Matrix4d of_change;
  of_light.setZero();
  mixed.setZero();
  of_change.setZero();
  // To write a vector number by number and read it at once as a whole would take most of the time:
  // many are written before the first is read.
  std::array<Terms, 64> terms;
  for (std::size_t first = 0; first < pixels.size(); first += terms.size()) {
    const std::size_t count = std::min(terms.size(), pixels.size() - first);
    for (std::size_t i = 0; i < count; ++i)
      terms[i] = termsOf(pixels[first + i], *rough, noise, expected_change);
    for (std::size_t i = 0; i < count; ++i) {
      const Eigen::Matrix<double, kLightTerms + 1, 1> light = terms[i].weight * terms[i].light;
      const Eigen::Vector4d change = terms[i].weight * terms[i].change;
      of_light.noalias() += light * terms[i].light.transpose();
      mixed.noalias() += light * terms[i].change.transpose();
      of_change.noalias() += change * terms[i].change.transpose();
    }
  }
  const auto light_and_pose = mixed.topLeftCorner<kLightTerms, 3>();
  const auto light_and_residual = of_light.topRightCorner<kLightTerms, 1>();
  const auto factors = factorsOf(of_light.topLeftCorner<kLightTerms, kLightTerms>());
  if (!factors) return std::nullopt;

  LitPatch patch;
  patch.light = *rough + factors->solve(light_and_residual);
  constexpr double kLowestContrast = 8.0;
  if (patch.light[1] < kLowestContrast) return std::nullopt;
  // The light is free: what it could explain says nothing about the pose.
  patch.light_by_pose = -factors->solve(light_and_pose);
  patch.information =
      of_change.topLeftCorner<3, 3>() + light_and_pose.transpose() * patch.light_by_pose;
  patch.gradient =
      of_change.topRightCorner<3, 1>() + patch.light_by_pose.transpose() * light_and_residual;
  return patch;
}

PixelResidual residualOf(const MarkerPixel& pixel, const Light& light,
                         const Eigen::Vector3d& change) {
  const double contrast = contrastAt(pixel.position, light);
  const double white = pixel.white + pixel.white_by_pose.dot(change);
  return {pixel.grey - light[0] - white * contrast, pixel.gradient, contrast * pixel.gradient};
}

Eigen::Matrix3d gradientCovariance(const std::vector<MarkerPixel>& pixels, const LitPatch& patch,
                                   const PixelNoise& noise, const Eigen::Vector3d& change) {
  const Light light = patch.lightAfter(change);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  int count = 0;
  for (const MarkerPixel& pixel : pixels) {
    const PixelResidual residual = residualOf(pixel, light, change);
    if (isSaturated(pixel, residual)) continue;
    // The light gives way to a change of the pose.
    const Eigen::RowVector3d by_pose =
        greyByPose(pixel, light) + regressorsOf(pixel).transpose() * patch.light_by_pose;
    const Eigen::RowVector3d gradient = weightOf(residual, noise) * residual.grey * by_pose;
    covariance.noalias() += gradient.transpose() * gradient;
    ++count;
  }
  // What was fitted takes its share of the residuals.
  constexpr int kFitted = kLightTerms + 3;
  return covariance * count / std::max(count - kFitted, 1);
}

}  // namespace omnitag
