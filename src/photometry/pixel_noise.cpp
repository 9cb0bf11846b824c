#include "photometry/pixel_noise.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace omnitag {
namespace {

/// The variance of samples with these squares, from their median.
double varianceOf(std::vector<double> squares) {
  constexpr double kMedianOfChiSquare = 0.455;  // with one degree of freedom
  const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
  std::nth_element(squares.begin(), middle, squares.end());
  return *middle / kMedianOfChiSquare;
}

}  // namespace

PixelNoise noiseOf(std::vector<PixelResidual> residuals, double least_flat) {
  constexpr double kFlat = 0.05;  // share of white per pixel
  constexpr double kEdge = 0.25;
  constexpr std::ptrdiff_t kFewest = 30;
  constexpr PixelNoise kTypical;
  const auto below = [](double gradient) {
    return [gradient](const PixelResidual& residual) { return residual.gradient < gradient; };
  };
  // Small markers have hardly any even ground: the most even pixels must do.
  const auto count = static_cast<std::ptrdiff_t>(residuals.size());
  const std::ptrdiff_t fewest = std::min(kFewest, (count + 4) / 5);
  auto flat_end = std::partition(residuals.begin(), residuals.end(), below(kFlat));
  if (flat_end - residuals.begin() < fewest) {
    flat_end = residuals.begin() + fewest;
    std::nth_element(
        residuals.begin(), flat_end - 1, residuals.end(),
        [](const PixelResidual& a, const PixelResidual& b) { return a.gradient < b.gradient; });
  }
  std::vector<double> flat_squares;
  std::for_each(residuals.begin(), flat_end,
                [&](const PixelResidual& r) { flat_squares.push_back(r.grey * r.grey); });
  PixelNoise noise;
  noise.flat = std::max(std::sqrt(varianceOf(std::move(flat_squares))), least_flat);

  const auto edge_begin = std::partition(residuals.begin(), residuals.end(), below(kEdge));
  noise.edge = kTypical.edge;
  if (residuals.end() - edge_begin < kFewest) return noise;
  std::vector<double> edge_squares;
  double gradient_square = 0.0;
  std::for_each(edge_begin, residuals.end(), [&](const PixelResidual& r) {
    edge_squares.push_back(r.grey * r.grey);
    gradient_square += r.grey_gradient * r.grey_gradient;
  });
  gradient_square /= static_cast<double>(edge_squares.size());
  const double edge_variance = varianceOf(std::move(edge_squares)) - noise.flat * noise.flat;
  noise.edge = std::sqrt(std::max(0.0, edge_variance) / gradient_square);
  return noise;
}

}  // namespace omnitag
