#include "adjustment/corner_alignment.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "adjustment/light_grid.h"
#include "photometry/marker_patch.h"
#include "photometry/pixel_noise.h"

namespace omnitag {
namespace {

/// Largest number of pixels at edges that are used.
constexpr std::size_t kMaxPixels = 2500;

/// Index of a corner's shift among the unknowns.
constexpr Eigen::Index shiftOf(Eigen::Index corner) { return 2 * corner; }

/// The corners' shifts, then the light.
constexpr Eigen::Index kUnknowns = 8 + kGridLightTerms;
using Unknowns = Eigen::Matrix<double, kUnknowns, 1>;
using Normal = Eigen::Matrix<double, kUnknowns, kUnknowns>;

GridLight lightOf(const Unknowns& unknowns) { return unknowns.tail<kGridLightTerms>(); }

/// A pixel compared with the pattern at the present unknowns.
struct Sample {
  double grey = 0.0;
  PixelResidual residual;
  Unknowns by_unknowns = Unknowns::Zero();
};

/// How much each corner's shift moves a position between the corners (modules of the drawing).
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
  const GridLight light = lightOf(unknowns);
  for (const Footprint& footprint : footprints) {
    const Eigen::Vector4d share = shares(footprint.position, pattern);
    Eigen::Vector2d shift = Eigen::Vector2d::Zero();
    for (Eigen::Index k = 0; k < 4; ++k) shift += share(k) * unknowns.segment<2>(shiftOf(k));
    const Eigen::Vector2d position = footprint.position - footprint.facet->by_pixel * shift;
    if (position.minCoeff() < 0.0 || position.maxCoeff() > width) continue;
    const TagPattern::White white = pattern.averageOver(position, footprint.facet->window);
    const Eigen::Vector2d place = position / width - Eigen::Vector2d(0.5, 0.5);
    const GridLight by_light = greyByLight(white.share, place);
    const Eigen::RowVector2d white_by_shift =
        -white.by_position.transpose() * footprint.facet->by_pixel;
    const Eigen::RowVector2d by_shift = contrastAt(place, light) * white_by_shift;
    Sample sample;
    sample.grey = panorama.at<std::uint8_t>(footprint.row, footprint.column);
    sample.residual = {sample.grey - light.dot(by_light), white_by_shift.norm(), by_shift.norm()};
    for (Eigen::Index k = 0; k < 4; ++k) {
      sample.by_unknowns.segment<2>(shiftOf(k)) = share(k) * by_shift.transpose();
    }
    sample.by_unknowns.tail<kGridLightTerms>() = by_light;
    samples.push_back(sample);
  }
  return samples;
}

void dropSaturated(std::vector<Sample>* samples) {
  const auto is_saturated = [](const Sample& sample) {
    return isSaturated(sample.grey, sample.grey - sample.residual.grey);
  };
  samples->erase(std::remove_if(samples->begin(), samples->end(), is_saturated), samples->end());
}

PixelNoise noiseOf(const std::vector<Sample>& samples) {
  constexpr double kLeastFlat = 1.0;  // grey levels, which are rounded
  std::vector<PixelResidual> residuals;
  residuals.reserve(samples.size());
  for (const Sample& sample : samples) residuals.push_back(sample.residual);
  return noiseOf(std::move(residuals), kLeastFlat);
}

/// Normal equations, with the prior that contrasts bend by about `bend` grey levels from node to
/// node.
Normal normalOf(const std::vector<Sample>& samples, const PixelNoise& noise, const GridLight& light,
                double bend, Unknowns* right_side) {
  Normal normal = Normal::Zero();
  right_side->setZero();
  normal.bottomRightCorner<kGridLightTerms, kGridLightTerms>() = roughness() / (bend * bend);
  right_side->tail<kGridLightTerms>() = -roughness() * light / (bend * bend);
  for (const Sample& sample : samples) {
    const double weight = weightOf(sample.residual, noise);
    normal.noalias() += weight * sample.by_unknowns * sample.by_unknowns.transpose();
    *right_side += weight * sample.residual.grey * sample.by_unknowns;
  }
  return normal;
}

/// The light that fits best while the pattern is at its projection; saturated pixels count, too.
Unknowns fitLight(const std::vector<Footprint>& footprints, const cv::Mat& panorama,
                  const TagPattern& pattern) {
  const std::vector<Sample> samples = samplesAt(Unknowns::Zero(), footprints, panorama, pattern);
  constexpr PixelNoise kAllAlike{1e3, 0.0};
  constexpr double kBend = 1e3;
  Unknowns right_side;
  const Normal normal = normalOf(samples, kAllAlike, GridLight::Zero(), kBend, &right_side);
  Unknowns unknowns = Unknowns::Zero();
  unknowns.tail<kGridLightTerms>() =
      normal.bottomRightCorner<kGridLightTerms, kGridLightTerms>().ldlt().solve(
          right_side.tail<kGridLightTerms>());
  return unknowns;
}

}  // namespace

std::optional<AlignedCorners> alignCorners(const cv::Mat& panorama, const Marker& marker,
                                           const TagPattern& pattern, const MountedCamera& camera,
                                           const Pose& map_from_base) {
  const auto projection = projectMarker(marker, camera, map_from_base);
  if (!projection) return std::nullopt;
  MarkerPatch::Choice choice;
  choice.max_at_edges = kMaxPixels;
  choice.max_on_even_ground = kMaxPixels / 4;
  const MarkerPatch patch(marker, pattern, camera, map_from_base, choice);
  const std::vector<Footprint> footprints = patch.footprints();
  constexpr std::size_t kFewestPixels = 60;
  if (footprints.size() < kFewestPixels) return std::nullopt;
  Unknowns unknowns = fitLight(footprints, panorama, pattern);

  constexpr int kSteps = 6;
  constexpr double kMaxShift = 1.5;     // pixels
  constexpr double kLowContrast = 8.0;  // grey levels
  constexpr double kBadFit = 0.2;       // of the contrast, the noise on even ground
  constexpr double kBend = 0.25;        // of the contrast, from node to node
  PixelNoise noise;
  Normal normal;
  for (int step = 0; step < kSteps; ++step) {
    const GridLight light = lightOf(unknowns);
    if (!(meanContrast(light) > kLowContrast)) return std::nullopt;
    auto samples = samplesAt(unknowns, footprints, panorama, pattern);
    dropSaturated(&samples);
    if (samples.size() < kFewestPixels) return std::nullopt;
    noise = noiseOf(samples);
    Unknowns right_side;
    normal = normalOf(samples, noise, light, kBend * meanContrast(light), &right_side);
    const Eigen::LDLT<Normal> factors(normal);
    if (factors.info() != Eigen::Success || !(factors.vectorD().minCoeff() > 0.0)) {
      return std::nullopt;
    }
    unknowns += factors.solve(right_side);
    if (!unknowns.allFinite() || unknowns.head<8>().cwiseAbs().maxCoeff() > kMaxShift) {
      return std::nullopt;
    }
  }
  const double contrast = meanContrast(lightOf(unknowns));
  if (contrast < kLowContrast || noise.flat > kBadFit * contrast) return std::nullopt;

  AlignedCorners aligned;
  aligned.pixels = projection->pixels + unknowns.head<8>();
  aligned.covariance = normal.inverse().topLeftCorner<8, 8>();
  // Errors that the pixels' noise does not include: the pattern was projected from the given pose,
  // the edges of shadows are sharper than the grid, and no camera is known exactly.
  constexpr double kOfShift = 0.04;
  constexpr double kOfShadow = 0.005;        // pixels, for contrasts that bend by the mean contrast
  constexpr double kLeastDeviation = 0.002;  // pixels
  const GridLight light = lightOf(unknowns);
  const double by_shift = kOfShift * std::sqrt(unknowns.head<8>().squaredNorm() / 4.0);
  const double by_shadow = kOfShadow * std::sqrt(light.dot(roughness() * light)) / contrast;
  aligned.covariance.diagonal().array() +=
      by_shift * by_shift + by_shadow * by_shadow + kLeastDeviation * kLeastDeviation;
  return aligned;
}

}  // namespace omnitag
