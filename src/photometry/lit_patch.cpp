#include "photometry/lit_patch.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>

namespace omnitag {
namespace {

/// 1, and the terms of the contrast's polynomial.
Light regressorsOf(const MarkerPixel& pixel) {
  const double x = pixel.position.x();
  const double y = pixel.position.y();
  Light regressors;
  const double white_x = pixel.white * x;
  const double white_y = pixel.white * y;
  regressors << 1.0, pixel.white, white_x, white_y, white_x * x, white_x * y, white_y * y;
  return regressors;
}

/// Derivative of a pixel's grey level with respect to the position on the drawing, in this light.
Eigen::Vector2d greyByPosition(const MarkerPixel& pixel, const Light& light) {
  return contrastAt(pixel.position, light) * pixel.white_by_position;
}

bool isSaturated(const MarkerPixel& pixel, const PixelResidual& residual) {
  return omnitag::isSaturated(pixel.grey, pixel.grey - residual.grey);
}

using LightInformation = Eigen::Matrix<double, kLightTerms, kLightTerms>;

/// Nothing if the pixels leave the light undetermined.
std::optional<Eigen::LDLT<LightInformation>> factorsOf(const LightInformation& information) {
  std::optional<Eigen::LDLT<LightInformation>> factors(information);
  const bool is_known = factors->info() == Eigen::Success && factors->vectorD().minCoeff() > 1e-9;
  return is_known ? factors : std::nullopt;
}

/// From some of the pixels, equally weighted.
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

/// A pixel's contribution to least squares in the light, the position on the drawing, and
/// the residual.
struct Terms {
  double weight = 0.0;
  int facet = 0;
  /// Derivatives of the grey level with respect to the light's coefficients, and the residual.
  Eigen::Matrix<double, kLightTerms + 1, 1> light;
  /// Derivatives with respect to the position.
  Eigen::Vector2d position;
};

Terms termsOf(const MarkerPixel& pixel, const Light& light, const PixelNoise& noise,
              const Eigen::Vector2d& expected_change) {
  const double residual = residualOf(pixel, light, Eigen::Vector2d::Zero()).grey;
  const PixelResidual expected = residualOf(pixel, light, expected_change);
  Terms terms;
  terms.weight = isSaturated(pixel, expected) ? 0.0 : weightOf(expected, noise);
  terms.facet = pixel.facet;
  terms.light << regressorsOf(pixel), residual;
  terms.position = greyByPosition(pixel, light);
  return terms;
}

/// Sums over a facet's pixels. All of them see the drawing move alike, so derivatives with respect
/// to the unknowns are worked out once for each facet.
template <int kTerms>
struct FacetSums {
  Eigen::Matrix<double, kTerms, 2> mixed = Eigen::Matrix<double, kTerms, 2>::Zero();
  Eigen::Matrix2d of_position = Eigen::Matrix2d::Zero();
};

/// Derivatives of the position on the drawing with respect to the shape.
Eigen::Matrix<double, 2, kShapeTerms> byShape(const Facet& facet,
                                              const CameraUncertainty& uncertainty) {
  return facet.by_pixel * displacementByShape(uncertainty, 2.0 * facet.middle);
}

std::vector<Eigen::Vector2d> changesOf(const MarkerPixels& pixels, const FrameVector& change,
                                       const Shape& shape_change,
                                       const CameraUncertainty& uncertainty) {
  std::vector<Eigen::Vector2d> changes = pixels.positionChanges(change);
  const FacetChanges by_shape = changesByShape(pixels.facets(), shape_change, uncertainty);
  for (std::size_t f = 0; f < by_shape.size(); ++f) changes[f] += by_shape[f];
  return changes;
}

/// Sums over a patch's pixels.
struct PixelSums {
  Eigen::Matrix<double, kLightTerms + 1, kLightTerms + 1> of_light =
      Eigen::Matrix<double, kLightTerms + 1, kLightTerms + 1>::Zero();
  std::vector<FacetSums<kLightTerms + 1>> facets;
};

/// Equations for unknowns, with the light eliminated: residuals that it could explain do not affect
/// the unknowns.
template <int kUnknowns>
struct Unlit {
  Light light;
  Eigen::Matrix<double, kLightTerms, kUnknowns> light_by_unknowns;
  Eigen::Matrix<double, kUnknowns, kUnknowns> information;
  Eigen::Matrix<double, kUnknowns, 1> gradient;
};

/// `jacobianOf`: gives a facet's derivatives of the position on the drawing by the unknowns.
template <int kUnknowns, typename JacobianOf>
Unlit<kUnknowns> withoutLight(const PixelSums& sums, const Eigen::LDLT<LightInformation>& factors,
                              const JacobianOf& jacobianOf) {
  using Jacobian = Eigen::Matrix<double, 2, kUnknowns>;
  Unlit<kUnknowns> unlit;
  unlit.information.setZero();
  Eigen::Matrix<double, kLightTerms + 1, kUnknowns> mixed;
  mixed.setZero();
  for (std::size_t f = 0; f < sums.facets.size(); ++f) {
    const Jacobian jacobian = jacobianOf(f);
    const Jacobian of_position = sums.facets[f].of_position.lazyProduct(jacobian);
    mixed += sums.facets[f].mixed.lazyProduct(jacobian);
    unlit.information += jacobian.transpose().lazyProduct(of_position);
  }
  const auto light_and_unknowns = mixed.template topRows<kLightTerms>();
  const auto light_and_residual = sums.of_light.template topRightCorner<kLightTerms, 1>();
  unlit.light = factors.solve(light_and_residual);
  unlit.light_by_unknowns = -factors.solve(light_and_unknowns);
  unlit.information += light_and_unknowns.transpose() * unlit.light_by_unknowns;
  unlit.gradient = mixed.template bottomRows<1>().transpose() +
                   unlit.light_by_unknowns.transpose() * light_and_residual;
  return unlit;
}

LitPatch withExactShape(const Unlit<kFrameUnknowns>& unlit) {
  LitPatch patch;
  patch.light = unlit.light;
  patch.light_by_frame = unlit.light_by_unknowns;
  patch.information = unlit.information;
  patch.gradient = unlit.gradient;
  return patch;
}

/// The shape, the last of the unknowns, is marginalised. `shape`: what it is now.
LitPatch withoutShape(const Unlit<kFrameUnknowns + kShapeTerms>& unlit, const Shape& shape) {
  using ShapeMatrix = Eigen::Matrix<double, kShapeTerms, kShapeTerms>;
  const ShapeMatrix of_shape =
      unlit.information.bottomRightCorner<kShapeTerms, kShapeTerms>() + ShapeMatrix::Identity();
  const Eigen::LLT<ShapeMatrix> factors(of_shape);
  const auto shape_and_frame = unlit.information.bottomLeftCorner<kShapeTerms, kFrameUnknowns>();
  const auto light_by_shape = unlit.light_by_unknowns.rightCols<kShapeTerms>();
  const Shape gradient = unlit.gradient.tail<kShapeTerms>() - shape;
  LitPatch patch;
  patch.shape_change = factors.solve(gradient);
  patch.shape_by_frame = -factors.solve(shape_and_frame);
  patch.light = unlit.light + light_by_shape * patch.shape_change;
  patch.light_by_frame =
      unlit.light_by_unknowns.leftCols<kFrameUnknowns>() + light_by_shape * patch.shape_by_frame;
  patch.information = unlit.information.topLeftCorner<kFrameUnknowns, kFrameUnknowns>() +
                      shape_and_frame.transpose() * patch.shape_by_frame;
  patch.gradient =
      unlit.gradient.head<kFrameUnknowns>() + patch.shape_by_frame.transpose() * gradient;
  patch.by_shape = patch.shape_by_frame.transpose() * patch.shape_by_frame;
  return patch;
}

}  // namespace

double contrastAt(const Eigen::Vector2d& position, const Light& light) {
  const double x = position.x();
  const double y = position.y();
  return light[1] + light[2] * x + light[3] * y + light[4] * x * x + light[5] * x * y +
         light[6] * y * y;
}

std::vector<Eigen::Vector2d> LitPatch::positionChanges(const MarkerPixels& pixels,
                                                       const FrameVector& change) const {
  return changesOf(pixels, change, shapeChangeAfter(change), uncertainty);
}

FacetChanges changesByShape(const std::vector<Facet>& facets, const Shape& shape,
                            const CameraUncertainty& uncertainty) {
  if (shape.isZero(0.0)) return {};
  FacetChanges changes;
  changes.reserve(facets.size());
  for (const Facet& facet : facets) changes.emplace_back(byShape(facet, uncertainty) * shape);
  return changes;
}

std::optional<LitPatch> fitLight(const MarkerPixels& pixels, const PixelNoise& noise,
                                 const CameraUncertainty& uncertainty, const Shape& shape,
                                 const ExpectedPixels& expected) {
  constexpr std::size_t kFewestPixels = 24;
  const std::vector<MarkerPixel>& all = pixels.pixels;
  if (all.size() < kFewestPixels) return std::nullopt;
  const std::optional<Light> rough = expected.light ? expected.light : roughLight(all);
  if (!rough) return std::nullopt;

  PixelSums sums;
  sums.facets.resize(pixels.facets().size());
  const std::vector<Eigen::Vector2d> changes =
      changesOf(pixels, expected.change, expected.shape_change, uncertainty);
  // Reading a vector as a whole right after writing it element by element would take most of the
  // time: many are written before the first is read.
  std::array<Terms, 64> terms;
  for (std::size_t first = 0; first < all.size(); first += terms.size()) {
    const std::size_t count = std::min(terms.size(), all.size() - first);
    for (std::size_t i = 0; i < count; ++i) {
      const MarkerPixel& pixel = all[first + i];
      terms[i] = termsOf(pixel, *rough, noise, changes[static_cast<std::size_t>(pixel.facet)]);
    }
    for (std::size_t i = 0; i < count; ++i) {
      const Eigen::Matrix<double, kLightTerms + 1, 1> light = terms[i].weight * terms[i].light;
      FacetSums<kLightTerms + 1>& facet = sums.facets[static_cast<std::size_t>(terms[i].facet)];
      sums.of_light.noalias() += light * terms[i].light.transpose();
      facet.mixed.noalias() += light * terms[i].position.transpose();
      facet.of_position.noalias() +=
          terms[i].weight * terms[i].position * terms[i].position.transpose();
    }
  }
  const auto factors = factorsOf(sums.of_light.topLeftCorner<kLightTerms, kLightTerms>());
  if (!factors) return std::nullopt;
  constexpr double kLowestContrast = 8.0;
  const auto byFrame = [&](std::size_t f) { return pixels.facets()[f].by_frame; };
  const auto byFrameAndShape = [&](std::size_t f) {
    Eigen::Matrix<double, 2, kFrameUnknowns + kShapeTerms> both;
    both << byFrame(f), byShape(pixels.facets()[f], uncertainty);
    return both;
  };
  LitPatch patch =
      uncertainty.isNone()
          ? withExactShape(withoutLight<kFrameUnknowns>(sums, *factors, byFrame))
          : withoutShape(
                withoutLight<kFrameUnknowns + kShapeTerms>(sums, *factors, byFrameAndShape), shape);
  patch.uncertainty = uncertainty;
  patch.light += *rough;
  if (patch.light[1] < kLowestContrast) return std::nullopt;
  return patch;
}

PixelResidual residualOf(const MarkerPixel& pixel, const Light& light,
                         const Eigen::Vector2d& position_change) {
  const double contrast = contrastAt(pixel.position, light);
  const double white = pixel.white + pixel.white_by_position.dot(position_change);
  return {pixel.grey - light[0] - white * contrast, pixel.gradient, contrast * pixel.gradient};
}

FrameMatrix gradientCovariance(const MarkerPixels& pixels, const LitPatch& patch,
                               const PixelNoise& noise, const FrameVector& change) {
  const Light light = patch.lightAfter(change);
  const std::vector<Eigen::Vector2d> changes = patch.positionChanges(pixels, change);
  LightInformation of_light = LightInformation::Zero();
  std::vector<FacetSums<kLightTerms>> facets(pixels.facets().size());
  int count = 0;
  for (const MarkerPixel& pixel : pixels.pixels) {
    const auto number = static_cast<std::size_t>(pixel.facet);
    const PixelResidual residual = residualOf(pixel, light, changes[number]);
    if (isSaturated(pixel, residual)) continue;
    const double error = weightOf(residual, noise) * residual.grey;
    const Light regressors = error * regressorsOf(pixel);
    const Eigen::Vector2d by_position = error * greyByPosition(pixel, light);
    of_light.noalias() += regressors * regressors.transpose();
    facets[number].mixed.noalias() += regressors * by_position.transpose();
    facets[number].of_position.noalias() += by_position * by_position.transpose();
    ++count;
  }
  // The light and the shape adapt to a change of the unknowns.
  const auto& light_by_frame = patch.light_by_frame;
  FrameMatrix covariance = light_by_frame.transpose() * of_light * light_by_frame;
  Eigen::Matrix<double, kLightTerms, kFrameUnknowns> mixed;
  mixed.setZero();
  for (std::size_t f = 0; f < facets.size(); ++f) {
    FrameJacobian by_frame = pixels.facets()[f].by_frame;
    if (!patch.uncertainty.isNone()) {
      by_frame += byShape(pixels.facets()[f], patch.uncertainty) * patch.shape_by_frame;
    }
    const FrameJacobian of_position = facets[f].of_position.lazyProduct(by_frame);
    mixed += facets[f].mixed.lazyProduct(by_frame);
    covariance += by_frame.transpose().lazyProduct(of_position);
  }
  const FrameMatrix crossed = light_by_frame.transpose().lazyProduct(mixed);
  covariance += crossed + crossed.transpose();
  // Fitting reduces the residuals by the degrees of freedom that it uses.
  constexpr int kFitted = kLightTerms + 6;
  return covariance * count / std::max(count - kFitted, 1);
}

}  // namespace omnitag
