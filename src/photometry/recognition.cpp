#include "omnitag/photometry/recognition.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "omnitag/marker/marker_reader.h"
#include "omnitag/photometry/marker_patch.h"
#include "pattern_alignment.h"
#include "pattern_comparison.h"

namespace omnitag {
namespace {

/// A pixel's share of white in the marker as it should image.
struct Sample {
  int column;
  int row;
  double white;
};

/// How many pixels of a marker are looked at, about, by the width of a module in pixels. More would
/// only make it slower; but of wide modules, few pixels see an edge, and what may be stretched has
/// twice as many unknowns.
std::size_t pixelsFor(double module, bool may_be_stretched) {
  constexpr double kFewest = 150.0;
  constexpr double kPerWidth = 33.0;
  constexpr double kMost = 500.0;
  const double pixels = std::clamp(kPerWidth * module, kFewest, kMost);
  return static_cast<std::size_t>(may_be_stretched ? 1.5 * pixels : pixels);
}

/// Pixels; however small the marker, it is worth to look for it so far around. Where it may be
/// farther away, it may also image larger, turned or slanted.
constexpr double kLeastMargin = 3.0;

/// Pixels, the width of a module where it is predicted.
double moduleOf(const PredictedMarker& predicted, const TagPattern& pattern) {
  return meanEdge(predicted.corners) / pattern.widthBetweenCorners();
}

/// Pixels over which the pattern varies: a module, made wider by the lens.
double blurredModuleOf(const PredictedMarker& predicted, const TagPattern& pattern,
                       const MountedCamera& camera) {
  return std::hypot(moduleOf(predicted, pattern),
                    2.0 * std::sqrt(camera.lensVariance(predicted.center)));
}

/// Of as many of a marker's pixels as tell, about, where it is.
std::vector<Sample> samplesOf(const std::vector<Footprint>& footprints, const TagPattern& pattern) {
  constexpr std::size_t kEnough = 100;
  const std::size_t every = std::max<std::size_t>(1, footprints.size() / kEnough);
  std::vector<Sample> samples;
  samples.reserve(footprints.size() / every + 1);
  for (std::size_t i = 0; i < footprints.size(); i += every) {
    const Footprint& footprint = footprints[i];
    const double white = pattern.average(footprint.position, footprint.facet->window.size()).share;
    samples.push_back({footprint.column, footprint.row, white});
  }
  return samples;
}

/// Where a marker may be, relative to where it is predicted.
class SearchArea {
 public:
  SearchArea(const PredictedMarker& predicted, const CameraModel& camera)
      : radial_((predicted.center - camera.imagePlane().principalPoint()).stableNormalized()),
        tangential_margin_(predicted.tangential_margin),
        radial_margin_(predicted.radial_margin) {}

  /// Whether it may be so many pixels away, give or take some.
  bool contains(const Eigen::Vector2d& displacement, double tolerance) const {
    const double tangential = radial_.x() * displacement.y() - radial_.y() * displacement.x();
    return std::abs(tangential) <= tangential_margin_ + tolerance &&
           std::abs(radial_.dot(displacement)) <= radial_margin_ + tolerance;
  }

  /// A grid of whole pixels that leaves none of it farther than a step away.
  std::vector<Eigen::Vector2i> places(int step) const {
    const double reach = std::hypot(tangential_margin_, radial_margin_);
    const int steps = static_cast<int>(std::ceil(reach / step));
    std::vector<Eigen::Vector2i> places;
    for (int row = -steps; row <= steps; ++row) {
      for (int column = -steps; column <= steps; ++column) {
        const Eigen::Vector2i place(column * step, row * step);
        if (contains(place.cast<double>(), 0.5 * step)) places.push_back(place);
      }
    }
    return places;
  }

 private:
  Eigen::Vector2d radial_;
  double tangential_margin_;
  double radial_margin_;
};

/// Moves the marker by whole pixels and returns at which of the places its pattern correlates best
/// with the panorama, of those where all of it is in the image.
Eigen::Vector2i bestPlace(const cv::Mat& panorama, const std::vector<Sample>& samples,
                          const std::vector<Eigen::Vector2i>& places) {
  struct Pixel {
    std::ptrdiff_t index;
    float white;
  };
  std::vector<Pixel> pixels;
  pixels.reserve(samples.size());
  const auto stride = static_cast<std::ptrdiff_t>(panorama.step[0]);
  float white_sum = 0.0F;
  Eigen::Vector2i low(panorama.cols, panorama.rows);
  Eigen::Vector2i high(0, 0);
  for (const Sample& sample : samples) {
    pixels.push_back({sample.row * stride + sample.column, static_cast<float>(sample.white)});
    white_sum += pixels.back().white;
    low = low.cwiseMin(Eigen::Vector2i(sample.column, sample.row));
    high = high.cwiseMax(Eigen::Vector2i(sample.column, sample.row));
  }
  const auto count = static_cast<float>(pixels.size());
  for (Pixel& pixel : pixels) pixel.white -= white_sum / count;
  Eigen::Vector2i best = Eigen::Vector2i::Zero();
  float best_correlation = -1.0F;
  for (const Eigen::Vector2i& place : places) {
    if ((low + place).minCoeff() < 0 || high.x() + place.x() >= panorama.cols ||
        high.y() + place.y() >= panorama.rows) {
      continue;
    }
    const std::uint8_t* const moved = panorama.data + place.y() * stride + place.x();
    int sum = 0;
    int squares = 0;
    float product = 0.0F;
    for (const Pixel& pixel : pixels) {
      const int grey = moved[pixel.index];
      sum += grey;
      squares += grey * grey;
      product += static_cast<float>(grey) * pixel.white;
    }
    const float mean = static_cast<float>(sum) / count;
    const float variance = static_cast<float>(squares) - static_cast<float>(sum) * mean;
    const float correlation = variance > 0.0F ? product / std::sqrt(variance) : -1.0F;
    if (correlation > best_correlation) {
      best_correlation = correlation;
      best = place;
    }
  }
  return best;
}

Recognition recognitionOf(const PredictedMarker& predicted, const Placement& placement,
                          const PatternComparison& comparison, double false_accept_rate) {
  Recognition recognition;
  recognition.center = predicted.center + placement.displacement;
  for (std::size_t k = 0; k < predicted.corners.size(); ++k) {
    const Eigen::Vector2d& corner = predicted.corners[k];
    recognition.corners[k] = corner + placement.displacementAt(corner);
  }
  recognition.is_stretched = !placement.stretch.isZero(0.0);
  recognition.correlation = comparison.correlation();
  recognition.threshold = correlationThreshold(comparison.dimensions(), false_accept_rate);
  const bool is_alike = recognition.correlation >= recognition.threshold;
  recognition.is_accepted =
      is_alike || comparison.isLikelierThanOthers(-std::log(false_accept_rate));
  return recognition;
}

}  // namespace

RecognitionConfig readRecognitionConfig(const YamlReader& reader) {
  reader.allowOnly({"max_margin", "false_accept_rate", "min_contrast", "period"});
  RecognitionConfig config;
  reader.read("max_margin", &config.max_margin, kNonNegative);
  reader.read("false_accept_rate", &config.false_accept_rate, {1e-12, 0.1});
  reader.read("min_contrast", &config.min_contrast, kPositive);
  reader.read("period", &config.period, kPositive);
  return config;
}

double correlationThreshold(double dimensions, double rate) {
  if (dimensions <= 1.0) return 1.0;
  return std::sqrt(1.0 - std::min(1.0, std::pow(2.0 * rate, 2.0 / (dimensions - 1.0))));
}

double largestMargin(const PredictedMarker& predicted, const TagPattern& pattern,
                     const MountedCamera& camera, const RecognitionConfig& config) {
  return std::max(kLeastMargin, config.max_margin * blurredModuleOf(predicted, pattern, camera));
}

std::optional<Recognition> recognize(const cv::Mat& panorama, const Marker& marker,
                                     const TagPattern& pattern, const MountedCamera& camera,
                                     const Pose& map_from_base, const PredictedMarker& predicted,
                                     const RecognitionConfig& config) {
  const double module = moduleOf(predicted, pattern);
  const double margin = std::max(predicted.tangential_margin, predicted.radial_margin);
  if (margin > largestMargin(predicted, pattern, camera, config)) return std::nullopt;
  MarkerPatch::Choice choice;
  const bool may_be_stretched = margin > kLeastMargin;
  choice.max_considered = pixelsFor(module, may_be_stretched);
  choice.tolerance = 0.02;
  choice.facets = 3;
  const MarkerPatch patch(marker, pattern, camera, map_from_base, choice);
  const std::vector<Footprint> footprints = patch.footprints();
  constexpr std::size_t kFewestPixels = 24;
  if (footprints.size() < kFewestPixels) return std::nullopt;

  // Alignment finds its way from a quarter of a module.
  const int step = std::max(1, static_cast<int>(0.3 * blurredModuleOf(predicted, pattern, camera)));
  const SearchArea area(predicted, camera.model());
  const std::vector<Eigen::Vector2i> places = area.places(step);
  const auto recognizedFrom = [&](const Eigen::Vector2i& place) -> std::optional<Recognition> {
    Placement start;
    start.displacement = place.cast<double>();
    start.predicted_middle = predicted.center;
    const auto fit = alignPattern(panorama, footprints, pattern, start, may_be_stretched);
    if (!fit || fit->contrast < config.min_contrast) return std::nullopt;
    if (!area.contains(fit->placement.displacement, step + 1.0)) return std::nullopt;
    const auto comparison = PatternComparison::of(panorama, footprints, fit->placement, pattern);
    if (!comparison) return std::nullopt;
    const double rate = config.false_accept_rate / static_cast<double>(places.size());
    return recognitionOf(predicted, fit->placement, *comparison, rate);
  };
  // Where little displacement is to be expected, it is mostly found from where it is predicted,
  // which is one of the places.
  std::optional<Recognition> there;
  if (!may_be_stretched) there = recognizedFrom(Eigen::Vector2i::Zero());
  if (there && there->is_accepted) return there;
  const Eigen::Vector2i place = bestPlace(panorama, samplesOf(footprints, pattern), places);
  return !may_be_stretched && place.isZero() ? there : recognizedFrom(place);
}

}  // namespace omnitag
