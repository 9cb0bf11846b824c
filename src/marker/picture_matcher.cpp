#include "marker/picture_matcher.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "common/correlation_threshold.h"
#include "marker/marker_reader.h"
#include "omnitag/common/angle.h"

namespace omnitag {
namespace {

/// Cells along either side in which pictures are compared, finer ones averaged.
constexpr int kCells = 16;

/// Cells of the border around a picture, as far as its blur reaches into it.
constexpr int kAround = 3;

/// Pixels; in smaller squares, pictures hardly differ.
constexpr double kLeastInside = 6.0;

/// Grey levels.
constexpr double kLeastContrast = 4.0;

/// Pixels, standard deviations of the blur that is tried: of a pixel and its interpolation alone,
/// and more for lenses and for views that enlarge the panorama.
constexpr std::array<double, 3> kBlurs = {0.5, 0.9, 1.6};

/// Upper limit of the probability that a square with a random picture is taken for a given one.
constexpr double kRate = 1e-4;

/// A picture that correlates less at the first blur does not match at another.
constexpr double kHopeless = 0.4;

cv::Mat cellsOf(const PatternPicture& picture) {
  cv::Mat cells(picture.side, picture.side, CV_32F);
  for (int row = 0; row < picture.side; ++row) {
    for (int column = 0; column < picture.side; ++column) {
      cells.at<float>(row, column) = static_cast<float>(picture.whiteAt(column, row));
    }
  }
  const int method = picture.side > kCells ? cv::INTER_AREA : cv::INTER_NEAREST;
  cv::resize(cells, cells, {kCells, kCells}, 0.0, 0.0, method);
  cv::copyMakeBorder(cells, cells, kAround, kAround, kAround, kAround, cv::BORDER_CONSTANT, 0.0);
  return cells;
}

/// Without their mean and of length 1, row by row; zero if there is no contrast.
std::vector<float> normalized(const cv::Mat& cells) {
  cv::Mat_<float> values = cells.clone();
  values -= cv::mean(cells);
  const double norm = cv::norm(values);
  if (norm > 0.0) values /= norm;
  return {values.begin(), values.end()};
}

double correlation(const std::vector<float>& a, const std::vector<float>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

/// The inside of a square's border in cells, each the mean of the pixels that it covers. Nothing if
/// the square reaches beyond the image.
std::optional<cv::Mat> insideOf(const cv::Mat& image, const Corners<Eigen::Vector2d>& square,
                                double border) {
  std::array<cv::Point2f, 4> seen;
  for (std::size_t k = 0; k < square.size(); ++k) {
    seen[k] = {static_cast<float>(square[k].x()), static_cast<float>(square[k].y())};
    const bool is_within = square[k].minCoeff() >= 0.0 && square[k].x() <= image.cols - 1 &&
                           square[k].y() <= image.rows - 1;
    if (!is_within) return std::nullopt;
  }
  const double pixels_per_cell = (1.0 - 2.0 * border) * meanEdge(square) / kCells;
  constexpr double kMostSamples = 4.0;
  const int samples = static_cast<int>(std::clamp(std::ceil(pixels_per_cell), 1.0, kMostSamples));
  // On the warped image, whose pixels' centres are at whole numbers.
  const int side = kCells * samples;
  const auto margin = static_cast<float>(side * border / (1.0 - 2.0 * border));
  const float low = -margin - 0.5F;
  const float high = static_cast<float>(side) + margin - 0.5F;
  const std::array<cv::Point2f, 4> drawn{
      cv::Point2f{low, high}, {high, high}, {high, low}, {low, low}};
  cv::Mat inside;
  cv::warpPerspective(image, inside, cv::getPerspectiveTransform(drawn, seen), {side, side},
                      cv::INTER_LINEAR | cv::WARP_INVERSE_MAP);
  inside.convertTo(inside, CV_32F);
  cv::resize(inside, inside, {kCells, kCells}, 0.0, 0.0, cv::INTER_AREA);
  return inside;
}

/// Pixels of a square's picture per cell, across and down.
Eigen::Vector2d pixelsPerCell(const Corners<Eigen::Vector2d>& square, double border) {
  const double across = (square[1] - square[0]).norm() + (square[3] - square[2]).norm();
  const double down = (square[2] - square[1]).norm() + (square[0] - square[3]).norm();
  return 0.5 * (1.0 - 2.0 * border) / kCells * Eigen::Vector2d(across, down);
}

/// `blur`: cells, standard deviations across and down.
cv::Mat blurred(const cv::Mat& cells, const Eigen::Vector2d& blur) {
  cv::Mat result;
  cv::GaussianBlur(cells, result, {}, blur.x(), blur.y(), cv::BORDER_REPLICATE);
  return result(cv::Rect(kAround, kAround, kCells, kCells));
}

/// The independent ways in which blurred pictures vary: white noise behind this blur (cells) has
/// N^2 / (2 pi sx sy); both limits are combined as if both spectra were Gaussian.
double dimensionsBehind(const Eigen::Vector2d& blur, double dimensions) {
  const double of_blur = kCells * kCells / std::max(1.0, 2.0 * kPi * blur.prod());
  return 1.0 / (1.0 / dimensions + 1.0 / of_blur);
}

/// Logarithm of how much likelier a picture that correlates by a is than one that correlates by b.
double logRatio(double a, double b, double dimensions) {
  constexpr double kLeast = 1e-6;
  return 0.5 * dimensions * std::log((1.0 - b * b) / std::max(1.0 - a * a, kLeast));
}

int modulesFor(double border) { return static_cast<int>(std::ceil(1.0 / border)); }

/// Turned counter-clockwise by quarters.
cv::Mat turned(cv::Mat cells, std::size_t quarters) {
  for (std::size_t k = 0; k < quarters; ++k) {
    // Not in place, which would reach into the border.
    cv::Mat next;
    cv::rotate(cells, next, cv::ROTATE_90_COUNTERCLOCKWISE);
    cells = next;
  }
  return cells;
}

}  // namespace

void PictureMatcher::Ranking::add(std::size_t number, std::size_t turned, double correlated,
                                  double independent) {
  if (correlated <= best) {
    second = std::max(second, correlated);
    return;
  }
  second = std::max(second, best);
  picture = number;
  turn = turned;
  best = correlated;
  dimensions = independent;
}

bool PictureMatcher::isClear(const Ranking& ranking) {
  return ranking.best >= correlationThreshold(ranking.dimensions, kRate) &&
         logRatio(ranking.best, ranking.second, ranking.dimensions) >= -std::log(kRate);
}

PictureMatcher::PictureMatcher(
    const std::map<int, std::shared_ptr<const PatternPicture>>& pictures) {
  for (const auto& [id, picture] : pictures) {
    pictures_.push_back({id, picture->border, dimensionsOf(*picture), cellsOf(*picture)});
  }
}

int PictureMatcher::modulesPerEdge() const {
  int most = 0;
  for (const Picture& picture : pictures_) most = std::max(most, modulesFor(picture.border));
  return most;
}

std::map<double, PictureMatcher::Inside> PictureMatcher::insidesOf(
    const cv::Mat& image, const Corners<Eigen::Vector2d>& square) const {
  std::map<double, Inside> insides;
  for (const Picture& picture : pictures_) {
    if (insides.count(picture.border) > 0) continue;
    Inside inside;
    const bool is_large = (1.0 - 2.0 * picture.border) * meanEdge(square) >= kLeastInside;
    const auto cells = is_large ? insideOf(image, square, picture.border) : std::nullopt;
    if (cells) {
      cv::Scalar mean;
      cv::Scalar deviation;
      cv::meanStdDev(*cells, mean, deviation);
      inside = {deviation[0], normalized(*cells)};
    }
    insides.emplace(picture.border, std::move(inside));
  }
  return insides;
}

PictureMatcher::Ranking PictureMatcher::rankingOf(const std::map<double, Inside>& insides,
                                                  const Corners<Eigen::Vector2d>& square,
                                                  double blur) const {
  Ranking ranking;
  for (std::size_t i = 0; i < pictures_.size(); ++i) {
    const Picture& picture = pictures_[i];
    const Inside& inside = insides.at(picture.border);
    if (inside.contrast < kLeastContrast) continue;
    const Eigen::Vector2d across_down = blur * pixelsPerCell(square, picture.border).cwiseInverse();
    const double dimensions = dimensionsBehind(across_down, picture.dimensions);
    for (std::size_t turn = 0; turn < square.size(); ++turn) {
      const bool lies = turn % 2 == 1;
      const cv::Mat expected =
          turned(blurred(picture.cells, lies ? across_down.reverse() : across_down), turn);
      ranking.add(i, turn, correlation(inside.values, normalized(expected)), dimensions);
    }
    if (ranking.picture == i) ranking.contrast = inside.contrast;
  }
  return ranking;
}

std::optional<PictureMatch> PictureMatcher::match(const cv::Mat& image,
                                                  const Corners<Eigen::Vector2d>& square) const {
  const std::map<double, Inside> insides = insidesOf(image, square);
  std::optional<Ranking> likeliest;
  for (const double blur : kBlurs) {
    const Ranking ranking = rankingOf(insides, square, blur);
    if (!likeliest || ranking.best > likeliest->best) likeliest = ranking;
    if (likeliest->best < kHopeless) return std::nullopt;
  }
  if (!likeliest || !isClear(*likeliest)) return std::nullopt;
  const Picture& picture = pictures_[likeliest->picture];
  PictureMatch match{picture.id, square, likeliest->best, likeliest->contrast,
                     modulesFor(picture.border)};
  // The first corner was taken for the lower left one.
  std::rotate(match.corners.begin(),
              match.corners.begin() + static_cast<std::ptrdiff_t>(likeliest->turn),
              match.corners.end());
  return match;
}

}  // namespace omnitag
