#include "omnitag/mapping/corner_alignment.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "omnitag/localization/marker_patch.h"
#include "omnitag/localization/photometric_refinement.h"

namespace omnitag {
namespace {

/// Pixels at edges that are used, at most.
constexpr std::size_t kMaxPixels = 2500;

/// Where the shift of a corner is among the unknowns.
constexpr Eigen::Index shiftOf(Eigen::Index corner) { return 2 * corner; }

/// The corners' shifts, then black, contrast and the contrast's two slopes.
using Unknowns = Eigen::Matrix<double, 12, 1>;
using Normal = Eigen::Matrix<double, 12, 12>;

/// A pixel against the pattern at the present unknowns.
struct Sample {
  double residual = 0.0;
  /// Grey levels per pixel.
  double gradient = 0.0;
  Unknowns by_unknowns = Unknowns::Zero();
};

/// How much each corner's shift moves a place between them; `position` in modules of the drawing.
Eigen::Vector4d shares(const Eigen::Vector2d& position, const TagPattern& pattern) {
  const double half = 0.5 * pattern.width();
  const double reach = 0.5 * pattern.widthBetweenCorners();
  const double x = (position.x() - half) / reach;
  const double y = (half - position.y()) / reach;
  return 0.25 * Eigen::Vector4d((1.0 - x) * (1.0 - y), (1.0 + x) * (1.0 - y), (1.0 + x) * (1.0 + y),
                                (1.0 - x) * (1.0 + y));
}

std::vector<Sample> samplesAt(const Unknowns& unknowns, const std::vector<Footprint>& footprints,
                              const cv::Mat& panorama, const TagPattern& pattern) {
  std::vector<Sample> samples;
  samples.reserve(footprints.size());
  const double width = pattern.width();
  for (const Footprint& footprint : footprints) {
    const Eigen::Vector4d share = shares(footprint.position, pattern);
    Eigen::Vector2d shift = Eigen::Vector2d::Zero();
    for (Eigen::Index k = 0; k < 4; ++k) shift += share(k) * unknowns.segment<2>(shiftOf(k));
    const Eigen::Vector2d position = footprint.position - footprint.facet->by_pixel * shift;
    if (position.minCoeff() < 0.0 || position.maxCoeff() > width) continue;
    const TagPattern::White white = pattern.averageOver(position, footprint.facet->window);
    const Eigen::Vector2d place = position / width - Eigen::Vector2d(0.5, 0.5);
    const double contrast = unknowns(9) + unknowns.tail<2>().dot(place);
    const Eigen::RowVector2d by_shift =
        -contrast * white.by_position.transpose() * footprint.facet->by_pixel;
    Sample sample;
    sample.residual = panorama.at<std::uint8_t>(footprint.row, footprint.column) -
                      (unknowns(8) + white.share * contrast);
    sample.gradient = by_shift.norm();
    for (Eigen::Index k = 0; k < 4; ++k) {
      sample.by_unknowns.segment<2>(shiftOf(k)) = share(k) * by_shift.transpose();
    }
    sample.by_unknowns.tail<4>() << 1.0, white.share, white.share * place.x(),
        white.share * place.y();
    samples.push_back(sample);
  }
  return samples;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Standard deviations of grey levels on even ground, and of the places of edges, in pixels.
struct Noise {
  double flat = 10.0;
  double edge = 0.1;
};

Noise noiseOf(const std::vector<Sample>& samples) {
  constexpr double kToDeviation = 1.4826;  // from the median of absolute values
  constexpr double kLeastFlat = 1.0;       // grey levels, which are rounded
  constexpr double kLeastEdge = 0.01;
  std::vector<double> gradients;
  gradients.reserve(samples.size());
  for (const Sample& sample : samples) gradients.push_back(sample.gradient);
  const double middle = median(gradients);
  std::vector<double> flat;
  std::vector<double> steep;
  for (const Sample& sample : samples) {
    (sample.gradient > middle ? steep : flat).push_back(std::abs(sample.residual));
  }
  Noise noise;
  noise.flat = std::max(kLeastFlat, kToDeviation * median(flat));
  if (steep.empty()) return noise;
  const double at_edges = kToDeviation * median(steep);
  double square = 0.0;
  for (const Sample& sample : samples) {
    if (sample.gradient > middle) square += sample.gradient * sample.gradient;
  }
  square /= static_cast<double>(steep.size());
  noise.edge = std::max(
      kLeastEdge, std::sqrt(std::max(0.0, at_edges * at_edges - noise.flat * noise.flat) / square));
  return noise;
}

/// 1 / variance, and less for what is off by more than chance.
double weightOf(const Sample& sample, const Noise& noise) {
  constexpr double kOutlier = 3.0;
  const double variance =
      noise.flat * noise.flat + noise.edge * noise.edge * sample.gradient * sample.gradient;
  const double ratio = sample.residual * sample.residual / (kOutlier * kOutlier * variance);
  return 1.0 / (variance * std::max(1.0, ratio));
}

Normal normalOf(const std::vector<Sample>& samples, const Noise& noise, Unknowns* right_side) {
  Normal normal = Normal::Zero();
  right_side->setZero();
  for (const Sample& sample : samples) {
    const double weight = weightOf(sample, noise);
    normal.noalias() += weight * sample.by_unknowns * sample.by_unknowns.transpose();
    *right_side += weight * sample.residual * sample.by_unknowns;
  }
  return normal;
}

/// The light at which the pattern fits best where it is.
std::optional<Unknowns> fitLight(const std::vector<Footprint>& footprints, const cv::Mat& panorama,
                                 const TagPattern& pattern) {
  const std::vector<Sample> samples = samplesAt(Unknowns::Zero(), footprints, panorama, pattern);
  Unknowns right_side;
  const Normal normal = normalOf(samples, {1e3, 0.0}, &right_side);
  const Eigen::LDLT<Eigen::Matrix4d> factors(normal.bottomRightCorner<4, 4>());
  if (!(factors.vectorD().minCoeff() > 0.0)) return std::nullopt;
  Unknowns unknowns = Unknowns::Zero();
  unknowns.tail<4>() = factors.solve(right_side.tail<4>());
  return unknowns;
}

}  // namespace

std::optional<AlignedCorners> alignCorners(const cv::Mat& panorama, const Marker& marker,
                                           const TagPattern& pattern, const MountedCamera& camera,
                                           const Pose2& map_from_base, double blur) {
  const auto projection = projectMarker(marker, camera, map_from_base);
  if (!projection) return std::nullopt;
  MarkerPatch::Choice choice;
  choice.max_at_edges = kMaxPixels;
  choice.max_on_even_ground = kMaxPixels / 4;
  const MarkerPatch patch(marker, pattern, camera, map_from_base, blur, choice);
  const std::vector<Footprint> footprints = patch.footprints(map_from_base);
  constexpr std::size_t kFewestPixels = 60;
  if (footprints.size() < kFewestPixels) return std::nullopt;
  std::optional<Unknowns> unknowns = fitLight(footprints, panorama, pattern);
  if (!unknowns) return std::nullopt;

  constexpr int kSteps = 6;
  constexpr double kMaxShift = 1.5;     // pixels
  constexpr double kLowContrast = 8.0;  // grey levels
  constexpr double kBadFit = 0.2;       // of the contrast, the noise on even ground
  Noise noise{1e3, 0.0};
  Normal normal;
  for (int step = 0; step < kSteps; ++step) {
    const auto samples = samplesAt(*unknowns, footprints, panorama, pattern);
    if (samples.size() < kFewestPixels) return std::nullopt;
    noise = noiseOf(samples);
    Unknowns right_side;
    normal = normalOf(samples, noise, &right_side);
    const Eigen::LDLT<Normal> factors(normal);
    if (factors.info() != Eigen::Success || !(factors.vectorD().minCoeff() > 0.0)) {
      return std::nullopt;
    }
    *unknowns += factors.solve(right_side);
    if (!unknowns->allFinite() || unknowns->head<8>().cwiseAbs().maxCoeff() > kMaxShift) {
      return std::nullopt;
    }
  }
  if ((*unknowns)(9) < kLowContrast || noise.flat > kBadFit * (*unknowns)(9)) return std::nullopt;

  AlignedCorners aligned;
  aligned.pixels = projection->pixels + unknowns->head<8>();
  aligned.covariance = normal.inverse().topLeftCorner<8, 8>();
  // What a renderer, a lens or a print does to all edges alike makes a marker larger or smaller.
  constexpr double kCornerDeviation = 0.02;  // pixels
  aligned.covariance.diagonal().array() += kCornerDeviation * kCornerDeviation;
  const double together = PhotometricConfig{}.alignment_deviation;
  for (int row = 0; row < 8; ++row) {
    for (int column = row % 2; column < 8; column += 2) {
      aligned.covariance(row, column) += together * together;
    }
  }
  return aligned;
}

}  // namespace omnitag
