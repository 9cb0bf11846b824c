#include "photometry/recognition.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "common/correlation_threshold.h"
#include "common/yaml_reader.h"
#include "marker/marker_reader.h"
#include "photometry/marker_patch.h"
#include "photometry/pattern_alignment.h"
#include "photometry/pattern_comparison.h"

namespace omnitag {
namespace {

/// A pixel's share of white in the marker as it should image.
struct Sample {
  int column;
  int row;
  double white;
};

/// About how many pixels of a marker are considered, by the width of its features in pixels. More
/// would only be slower; but few pixels of wide modules see an edge, and a marker that may be
/// stretched has twice as many unknowns.
std::size_t pixelsFor(double feature, bool may_be_stretched) {
  constexpr double kFewest = 150.0;
  constexpr double kPerWidth = 33.0;
  constexpr double kMost = 500.0;
  const double pixels = std::clamp(kPerWidth * feature, kFewest, kMost);
  return static_cast<std::size_t>(may_be_stretched ? 1.5 * pixels : pixels);
}

/// Pictures have few independent parts, so that at the rate for codes a plain one would have to be
/// free of noise. Within a black border at the predicted place, anything else is rare in itself.
/// `false_accept_study` measures how often one picture is taken for another.
constexpr double kPictureRate = 100.0;  // relative to the rate for codes
constexpr double kHighestRate = 1e-2;

/// Pixels: even for the smallest marker, searching this far around is worthwhile. A marker that may
/// be farther away may also image larger, turned or slanted.
constexpr double kLeastMargin = 3.0;

/// Width of the pattern's features where it is predicted, in pixels.
double featureOf(const PredictedMarker& predicted, const TagPattern& pattern) {
  return pattern.featureWidth() * meanEdge(predicted.corners) / pattern.widthBetweenCorners();
}

/// Pixels over which the pattern varies: a feature, widened by the lens's blur.
double blurredFeatureOf(const PredictedMarker& predicted, const TagPattern& pattern,
                        const MountedCamera& camera) {
  return std::hypot(featureOf(predicted, pattern),
                    2.0 * std::sqrt(camera.lensVariance(predicted.center)));
}

/// Samples of about as many of a marker's pixels as are needed to locate it.
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

/// A place of a marker: turned about the principal point (rad), which displaces it along the
/// tangent, and then displaced by whole pixels.
struct Place {
  double turn = 0.0;
  Eigen::Vector2i offset = Eigen::Vector2i::Zero();
};

/// Where a marker may be, relative to its prediction: around the principal point, as when the robot
/// turns, and along the radius.
class SearchArea {
 public:
  SearchArea(const PredictedMarker& predicted, const CameraModel& camera)
      : from_axis_(predicted.center - camera.imagePlane().principalPoint()),
        middle_(predicted.center),
        tangential_margin_(predicted.tangential_margin),
        radial_margin_(predicted.radial_margin) {}

  /// Whether a displacement leaves the marker within the area, give or take some pixels.
  bool contains(const Eigen::Vector2d& displacement, double tolerance) const {
    const Eigen::Vector2d radial = from_axis_.stableNormalized();
    Eigen::Vector2d off(radial.dot(displacement),
                        radial.x() * displacement.y() - radial.y() * displacement.x());
    if (isFarFromAxis()) {
      const double radius = from_axis_.norm();
      const double turn = std::atan2(off.y(), radius + off.x());
      off = {(from_axis_ + displacement).norm() - radius, radius * turn};
    }
    return std::abs(off.y()) <= tangential_margin_ + tolerance &&
           std::abs(off.x()) <= radial_margin_ + tolerance;
  }

  /// A grid of places, at most about a step (pixels) apart, that covers the area and includes the
  /// prediction; places with the same turn follow one another.
  std::vector<Place> places(int step) const {
    std::vector<Place> places;
    if (!isFarFromAxis()) {
      const int steps = stepsFor(std::hypot(tangential_margin_, radial_margin_), step);
      for (int row = -steps; row <= steps; ++row) {
        for (int column = -steps; column <= steps; ++column) {
          const Eigen::Vector2i offset(column * step, row * step);
          if (contains(offset.cast<double>(), 0.5 * step)) places.push_back({0.0, offset});
        }
      }
      return places;
    }
    const int turns = stepsFor(tangential_margin_, step);
    const int steps = stepsFor(radial_margin_, step);
    for (int i = -turns; i <= turns; ++i) {
      const double turn = i * step / from_axis_.norm();
      const Eigen::Vector2d radial = Eigen::Rotation2Dd(turn) * from_axis_.normalized();
      for (int k = -steps; k <= steps; ++k) {
        places.push_back({turn, (k * step * radial).array().round().matrix().cast<int>()});
      }
    }
    return places;
  }

  /// The place at which a pixel of the predicted marker images after a turn.
  Eigen::Vector2d turned(const Eigen::Vector2d& pixel, double turn) const {
    return middle_ - from_axis_ + Eigen::Rotation2Dd(turn) * (pixel - middle_ + from_axis_);
  }

  Placement placementAt(const Place& place) const {
    Placement placement;
    placement.predicted_middle = middle_;
    placement.displacement = turned(middle_, place.turn) + place.offset.cast<double>() - middle_;
    placement.stretch =
        Eigen::Rotation2Dd(place.turn).toRotationMatrix() - Eigen::Matrix2d::Identity();
    return placement;
  }

 private:
  static int stepsFor(double reach, int step) {
    return static_cast<int>(std::ceil((reach - 0.5 * step) / step));
  }

  /// Whether the marker is so far from the axis that tangential displacements are nearly turns.
  bool isFarFromAxis() const { return from_axis_.norm() > 2.0 * tangential_margin_; }

  Eigen::Vector2d from_axis_;
  Eigen::Vector2d middle_;
  double tangential_margin_;
  double radial_margin_;
};

/// Samples, indexed from the first pixel of a panorama, with their mean subtracted.
class PlacedSamples {
 public:
  PlacedSamples(const std::vector<Sample>& samples, const SearchArea& area, double turn,
                std::ptrdiff_t stride) {
    pixels_.reserve(samples.size());
    float sum = 0.0F;
    for (const Sample& sample : samples) {
      const Eigen::Vector2i pixel = area.turned(Eigen::Vector2d(sample.column, sample.row), turn)
                                        .array()
                                        .round()
                                        .matrix()
                                        .cast<int>();
      pixels_.push_back({pixel.y() * stride + pixel.x(), static_cast<float>(sample.white)});
      sum += pixels_.back().white;
      low_ = low_.cwiseMin(pixel);
      high_ = high_.cwiseMax(pixel);
    }
    const auto count = static_cast<float>(pixels_.size());
    for (Pixel& pixel : pixels_) pixel.white -= sum / count;
  }

  /// Their correlation with the panorama, up to a factor common to all places; -1 if a sample is
  /// off the image.
  float correlationAt(const cv::Mat& panorama, const Eigen::Vector2i& offset) const {
    if ((low_ + offset).minCoeff() < 0 || high_.x() + offset.x() >= panorama.cols ||
        high_.y() + offset.y() >= panorama.rows) {
      return -1.0F;
    }
    const std::uint8_t* const moved = panorama.ptr<std::uint8_t>(0) +
                                      offset.y() * static_cast<std::ptrdiff_t>(panorama.step[0]) +
                                      offset.x();
    int sum = 0;
    int squares = 0;
    float product = 0.0F;
    for (const Pixel& pixel : pixels_) {
      const int grey = moved[pixel.index];
      sum += grey;
      squares += grey * grey;
      product += static_cast<float>(grey) * pixel.white;
    }
    const float mean = static_cast<float>(sum) / static_cast<float>(pixels_.size());
    const float variance = static_cast<float>(squares) - static_cast<float>(sum) * mean;
    return variance > 0.0F ? product / std::sqrt(variance) : -1.0F;
  }

 private:
  struct Pixel {
    std::ptrdiff_t index;
    float white;
  };
  std::vector<Pixel> pixels_;
  Eigen::Vector2i low_ = Eigen::Vector2i::Constant(std::numeric_limits<int>::max() / 2);
  Eigen::Vector2i high_ = Eigen::Vector2i::Constant(std::numeric_limits<int>::min() / 2);
};

/// The place where the marker's pattern correlates best with the panorama, among those entirely in
/// the image.
Place bestPlace(const cv::Mat& panorama, const std::vector<Sample>& samples, const SearchArea& area,
                const std::vector<Place>& places) {
  Place best;
  float best_correlation = -1.0F;
  std::optional<PlacedSamples> placed;
  double turn = 0.0;
  for (const Place& place : places) {
    if (!placed || place.turn != turn) {
      turn = place.turn;
      placed.emplace(samples, area, turn, static_cast<std::ptrdiff_t>(panorama.step[0]));
    }
    const float correlation = placed->correlationAt(panorama, place.offset);
    if (correlation <= best_correlation) continue;
    best_correlation = correlation;
    best = place;
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
  reader.refuseReplaced("period", "attention/period (s, of a whole look around)");
  reader.allowOnly({"max_margin", "false_accept_rate", "min_contrast"});
  RecognitionConfig config;
  reader.read("max_margin", &config.max_margin, kNonNegative);
  reader.read("false_accept_rate", &config.false_accept_rate, {1e-12, 0.1});
  reader.read("min_contrast", &config.min_contrast, kPositive);
  return config;
}

double largestMargin(const PredictedMarker& predicted, const TagPattern& pattern,
                     const MountedCamera& camera, const RecognitionConfig& config) {
  return std::max(kLeastMargin, config.max_margin * blurredFeatureOf(predicted, pattern, camera));
}

std::optional<Recognition> recognize(const cv::Mat& panorama, const Marker& marker,
                                     const TagPattern& pattern, const MountedCamera& camera,
                                     const Pose& map_from_base, const PredictedMarker& predicted,
                                     const RecognitionConfig& config) {
  const double feature = featureOf(predicted, pattern);
  const double margin = std::max(predicted.tangential_margin, predicted.radial_margin);
  if (margin > largestMargin(predicted, pattern, camera, config)) return std::nullopt;
  MarkerPatch::Choice choice;
  const bool may_be_stretched = margin > kLeastMargin;
  choice.max_considered = pixelsFor(feature, may_be_stretched);
  choice.tolerance = 0.02;
  choice.facets = 3;
  const MarkerPatch patch(marker, pattern, camera, map_from_base, choice);
  const std::vector<Footprint> footprints = patch.footprints();
  constexpr std::size_t kFewestPixels = 24;
  if (footprints.size() < kFewestPixels) return std::nullopt;

  // Alignment converges if it starts within a quarter of a feature: the nearest place of such a
  // grid is at most 0.21 of one off.
  const int step =
      std::max(1, static_cast<int>(0.3 * blurredFeatureOf(predicted, pattern, camera)));
  const SearchArea area(predicted, camera.model());
  const std::vector<Place> places = area.places(step);
  const auto recognizedFrom = [&](const Place& place) -> std::optional<Recognition> {
    Placement start = area.placementAt(place);
    if (!may_be_stretched) start.stretch.setZero();
    const auto fit = alignPattern(panorama, footprints, pattern, start, may_be_stretched);
    if (!fit || fit->contrast < config.min_contrast) return std::nullopt;
    if (!area.contains(fit->placement.displacement, step + 1.0)) return std::nullopt;
    const auto comparison = PatternComparison::of(panorama, footprints, fit->placement, pattern);
    if (!comparison) return std::nullopt;
    const double of_one = marker.picture
                              ? std::min(kPictureRate * config.false_accept_rate, kHighestRate)
                              : config.false_accept_rate;
    const double rate = of_one / static_cast<double>(places.size());
    return recognitionOf(predicted, fit->placement, *comparison, rate);
  };
  // If little displacement is expected, alignment mostly succeeds from the prediction itself, which
  // is one of the places.
  std::optional<Recognition> there;
  if (!may_be_stretched) there = recognizedFrom({});
  if (there && there->is_accepted) return there;
  const Place place = bestPlace(panorama, samplesOf(footprints, pattern), area, places);
  const bool was_tried = !may_be_stretched && place.turn == 0.0 && place.offset.isZero();
  return was_tried ? there : recognizedFrom(place);
}

}  // namespace omnitag
