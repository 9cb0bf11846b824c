#include "photometry/blur_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>

namespace omnitag {
namespace {

/// Half of the second derivative of the share of white along `way` on the drawing (modules), times
/// its square: the change due to blurring along it by this variance. Nothing if that reaches off
/// the drawing.
std::optional<double> rise(const TagPattern& pattern, const TagPattern::Window& window,
                           const Eigen::Vector2d& position, double white,
                           const Eigen::Vector2d& way) {
  const Eigen::Vector2d reach = window.core() + way.cwiseAbs();
  const double width = pattern.width();
  if ((position - reach).minCoeff() < 0.0 || (position + reach).maxCoeff() > width) {
    return std::nullopt;
  }
  return 0.5 * (pattern.averageOver(position + way, window).share +
                pattern.averageOver(position - way, window).share) -
         white;
}

/// Derivative of a pixel's share of white with respect to each part of the blur.
class BlurSlopes {
 public:
  BlurSlopes(const TagPattern& pattern, const MountedCamera& camera)
      : pattern_(pattern), camera_(camera) {}

  std::optional<BlurVector> at(const MarkerPixel& pixel, const Facet& facet) const {
    constexpr double kStep = 0.7;  // pixels
    const Eigen::Vector2d position =
        pattern_.width() * (pixel.position + Eigen::Vector2d(0.5, 0.5));
    const auto riseAlong = [&](const Eigen::Vector2d& way) {
      return rise(pattern_, facet.window, position, pixel.white, way);
    };
    const auto along_u = riseAlong(kStep * facet.by_pixel.col(0));
    const auto along_v = riseAlong(kStep * facet.by_pixel.col(1));
    if (!along_u || !along_v) return std::nullopt;
    const double by_variance = (*along_u + *along_v) / (kStep * kStep);
    const Eigen::Vector2d center = camera_.model().imagePlane().principalPoint();
    const Eigen::Vector2d from_center = Eigen::Vector2d(pixel.column, pixel.row) - center;
    const double radius = from_center.norm() / camera_.model().rimPixels();
    BlurVector slopes(by_variance, by_variance * radius * radius, 0.0);
    if (camera_.knowsExposure()) return slopes;

    // A turn sweeps each pixel evenly along a line.
    const Eigen::Vector2d sweep = facet.by_frame.col(2);
    const double pixels = (facet.by_pixel.inverse() * sweep).norm();
    const double angle = kStep / pixels;
    const auto along_sweep = riseAlong(angle * sweep);
    if (!along_sweep) return std::nullopt;
    constexpr double kVarianceOfSweep = 1.0 / 12.0;
    slopes[2] = kVarianceOfSweep * *along_sweep / (angle * angle);
    return slopes;
  }

 private:
  const TagPattern& pattern_;
  const MountedCamera& camera_;
};

}  // namespace

BlurEquations blurEquationsOf(const MarkerPixels& pixels, const LitPatch& patch,
                              const TagPattern& pattern, const MountedCamera& camera,
                              const PixelNoise& noise, const FrameVector& change,
                              std::size_t at_most) {
  // The light is eliminated: black and contrast.
  constexpr int kLight = 2;
  using Unknowns = Eigen::Matrix<double, kLight + 3, 1>;
  using Information = Eigen::Matrix<double, kLight + 3, kLight + 3>;
  Information information = Information::Zero();
  Unknowns gradient = Unknowns::Zero();
  const BlurSlopes slopes(pattern, camera);
  const Light light = patch.lightAfter(change);
  const std::vector<Eigen::Vector2d> changes = patch.positionChanges(pixels, change);
  const std::size_t every = 1 + pixels.pixels.size() / at_most;
  for (std::size_t i = 0; i < pixels.pixels.size(); i += every) {
    const MarkerPixel& pixel = pixels.pixels[i];
    const auto number = static_cast<std::size_t>(pixel.facet);
    const PixelResidual residual = residualOf(pixel, light, changes[number]);
    if (isSaturated(pixel.grey, pixel.grey - residual.grey)) continue;
    const auto by_blur = slopes.at(pixel, pixels.facets()[number]);
    if (!by_blur) continue;
    Unknowns row;
    row << 1.0, pixel.white, contrastAt(pixel.position, light) * *by_blur;
    const double weight = weightOf(residual, noise);
    information += weight * row * row.transpose();
    gradient += weight * residual.grey * row;
  }
  const Eigen::LDLT<Eigen::Matrix2d> of_light(
      Eigen::Matrix2d(information.topLeftCorner<kLight, kLight>()));
  BlurEquations equations;
  if (of_light.info() != Eigen::Success || !(of_light.vectorD().minCoeff() > 1e-9)) {
    return equations;
  }
  const Eigen::Matrix<double, kLight, 3> mixed = information.topRightCorner<kLight, 3>();
  equations.information =
      information.bottomRightCorner<3, 3>() - mixed.transpose() * of_light.solve(mixed);
  equations.gradient =
      gradient.tail<3>() - mixed.transpose() * of_light.solve(gradient.head<kLight>());
  return equations;
}

}  // namespace omnitag
