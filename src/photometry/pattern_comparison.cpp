#include "photometry/pattern_comparison.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "common/symmetric_matrix.h"
#include "omnitag/common/angle.h"

namespace omnitag {
namespace {

/// Transforms vectors with these inner products to independent ones whose sums of squares are 1; if
/// they are dependent, the surplus ones become zero.
template <int Size>
Eigen::Matrix<double, Size, Size> normalizing(const Eigen::Matrix<double, Size, Size>& gram) {
  using Vector = Eigen::Matrix<double, Size, 1>;
  const auto [values, vectors] = eigenPairs(gram);
  constexpr double kSame = 1e-9;
  const double least = kSame * values.maxCoeff();
  const Vector scales = values.unaryExpr(
      [least](double value) { return value > least ? 1.0 / std::sqrt(value) : 0.0; });
  return scales.asDiagonal() * vectors.transpose();
}

}  // namespace

std::optional<PatternComparison> PatternComparison::of(const cv::Mat& panorama,
                                                       const std::vector<Footprint>& footprints,
                                                       const Placement& placement,
                                                       const TagPattern& pattern) {
  PatternComparison comparison;
  comparison.look(panorama, footprints, placement, pattern);
  constexpr std::size_t kFewest = kNuisances + 3;
  if (comparison.pixels_.size() < kFewest || !comparison.compare(pattern)) {
    return std::nullopt;
  }
  return comparison;
}

void PatternComparison::look(const cv::Mat& panorama, const std::vector<Footprint>& footprints,
                             const Placement& placement, const TagPattern& pattern) {
  constexpr std::size_t kUsualShares = 4;
  pixels_.reserve(footprints.size());
  shares_.reserve(kUsualShares * footprints.size());
  in_shares_.setZero(kNuisances, pattern.dataModules());
  visitPlaced(footprints, placement, panorama.size(), pattern.width(), 0.0,
              [&](const Eigen::Vector2d&, const Footprint& footprint) {
                const std::size_t first = shares_.size();
                const TagPattern::Window& window = footprint.facet->window;
                pattern.appendDataShares(footprint.position, window, &shares_);
                DataPixel pixel;
                double of_data = 0.0;
                for (std::size_t i = first; i < shares_.size(); ++i) {
                  const auto& [module, share] = shares_[i];
                  of_data += share;
                  pixel.expected += share * pattern.dataAt(module);
                }
                constexpr double kLeastData = 0.05;
                if (of_data < kLeastData) {
                  shares_.resize(first);
                  return;
                }
                const double white = window.isBlurred()
                                         ? pattern.averageOver(footprint.position, window).share
                                         : pattern.average(footprint.position, window.size()).share;
                const double data_white = 0.5 * (of_data + pixel.expected);
                const Eigen::Vector2d place = footprint.position / pattern.width();
                pixel.nuisances << 1.0, place.x(), place.y(), white - data_white, of_data;
                pixel.grey = panorama.ptr<std::uint8_t>(footprint.row)[footprint.column];
                window_areas_ += window.size().prod();
                pixel.shares_end = static_cast<std::ptrdiff_t>(shares_.size());
                pixels_.push_back(pixel);
              });
}

bool PatternComparison::compare(const TagPattern& pattern) {
  // The rest works on what the nuisances do not explain.
  Eigen::Matrix<double, kNuisances, kNuisances> gram;
  gram.setZero();
  for (const DataPixel& pixel : pixels_) gram += pixel.nuisances * pixel.nuisances.transpose();
  const auto independent = normalizing<kNuisances>(gram);
  Nuisances in_grey = Nuisances::Zero();
  Nuisances in_expected = Nuisances::Zero();
  double share_squares = 0.0;
  auto share = shares_.cbegin();
  for (DataPixel& pixel : pixels_) {
    pixel.nuisances = independent * pixel.nuisances;
    in_grey += pixel.grey * pixel.nuisances;
    in_expected += pixel.expected * pixel.nuisances;
    for (; share != shares_.cbegin() + pixel.shares_end; ++share) {
      in_shares_.col(share->module) += share->share * pixel.nuisances;
      share_squares += share->share * share->share;
    }
  }
  share_squares -= in_shares_.squaredNorm();

  Eigen::VectorXd along_expected = Eigen::VectorXd::Zero(in_shares_.cols());
  share = shares_.cbegin();
  for (DataPixel& pixel : pixels_) {
    pixel.grey -= in_grey.dot(pixel.nuisances);
    pixel.expected -= in_expected.dot(pixel.nuisances);
    product_ += pixel.expected * pixel.grey;
    grey_squares_ += pixel.grey * pixel.grey;
    expected_squares_ += pixel.expected * pixel.expected;
    for (; share != shares_.cbegin() + pixel.shares_end; ++share) {
      along_expected[share->module] += share->share * pixel.expected;
    }
  }
  const double norms = std::sqrt(expected_squares_ * grey_squares_);
  if (!(norms > 1e-9)) return false;
  correlation_ = product_ / norms;
  // For random signs r, the correlation with the expected ones s has the variance |G s|^2 / (s'G s
  // tr G), G = A'A; for n independent dimensions it would be 1 / n.
  dimensions_ = expected_squares_ * share_squares / along_expected.squaredNorm();
  are_modules_independent_ = std::isinf(pattern.dataDimensions());
  if (!are_modules_independent_) dimensions_ = dimensionsOfPicture(pattern);
  return true;
}

double PatternComparison::dimensionsOfPicture(const TagPattern& pattern) const {
  // The variance of a square window along either side is a twelfth of its area. White noise of the
  // area N behind a Gaussian of the variance v has N / (2 pi v) dimensions; they are combined with
  // the picture's own as if its spectrum were Gaussian, too.
  const auto pixels = static_cast<double>(pixels_.size());
  const double variance = window_areas_ / pixels / 12.0;
  const double of_pixels = std::min(pixels, pattern.dataArea() / (2.0 * kPi * variance));
  return 1.0 / (1.0 / pattern.dataDimensions() + 1.0 / of_pixels);
}

bool PatternComparison::isLikelierThanOthers(double log_ratio) const {
  if (!are_modules_independent_) return false;
  // Half of the difference between black and white; random modules would have the same.
  const double amplitude = product_ / expected_squares_;
  if (!(amplitude > 0.0)) return false;
  const Eigen::Index modules = in_shares_.cols();
  Eigen::MatrixXd gram = -in_shares_.transpose() * in_shares_;
  Eigen::VectorXd in_grey = Eigen::VectorXd::Zero(modules);
  auto begin = shares_.cbegin();
  for (const DataPixel& pixel : pixels_) {
    const auto end = shares_.cbegin() + pixel.shares_end;
    for (auto a = begin; a != end; ++a) {
      in_grey[a->module] += a->share * pixel.grey;
      for (auto b = begin; b != end; ++b) gram(a->module, b->module) += a->share * b->share;
    }
    begin = end;
  }

  // Twice the log-likelihoods at a noise variance, without the terms that both share.
  constexpr double kLeastVariance = 1.0;  // grey levels squared
  const double freedom = static_cast<double>(pixels_.size()) - kNuisances;
  const double left = grey_squares_ - amplitude * product_;
  const double own_variance = std::max(left / (freedom - 1.0), kLeastVariance);
  const double own = -left / own_variance - freedom * std::log(own_variance);
  const auto ofOthers = [&](double variance) {
    // For grey levels with the covariance amplitude^2 A A' + variance, by the inversion lemma.
    const double ratio = variance / (amplitude * amplitude);
    Eigen::MatrixXd sum = gram;
    sum.diagonal().array() += ratio;
    const Eigen::LLT<Eigen::MatrixXd> factors(sum);
    const double log_determinant = 2.0 * factors.matrixLLT().diagonal().array().log().sum() -
                                   static_cast<double>(modules) * std::log(ratio);
    return (in_grey.dot(factors.solve(in_grey)) - grey_squares_) / variance - log_determinant -
           freedom * std::log(variance);
  };
  // Random modules that explain the pixels better leave less noise.
  double best_of_others = -std::numeric_limits<double>::infinity();
  double variance = own_variance;
  while (variance >= kLeastVariance) {
    const double others = ofOthers(variance);
    if (!(own - others >= 2.0 * log_ratio)) return false;
    if (others <= best_of_others) break;
    best_of_others = others;
    variance *= 0.5;
  }
  return true;
}

}  // namespace omnitag
