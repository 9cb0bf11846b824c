#include "frame_limit.h"

#include <Eigen/LU>
#include <cmath>
#include <cstdlib>

#include "marker/marker_prediction.h"
#include "marker/tag_pattern.h"
#include "measurement/marker_misplacement.h"
#include "omnitag/common/error.h"
#include "pixel_information.h"

namespace omnitag {
namespace {

double numberFrom(const std::string& text, double least) {
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !(number >= least)) {
    throw InputError("NOISE SAMPLES: expected two numbers, found " + text);
  }
  return number;
}

}  // namespace

Rendering renderingFrom(const std::string& noise, const std::string& samples) {
  return {numberFrom(noise, 0.0), static_cast<int>(numberFrom(samples, 1.0))};
}

Informations markersInSight(const cv::Mat& image, const MountedCamera& camera, const MarkerMap& map,
                            const Pose& truth, const Rendering& rendering,
                            const std::set<std::size_t>& used) {
  constexpr double kMinCorrelation = 0.95;
  constexpr std::size_t kFewestPixels = 50;
  const double noise = std::sqrt(rendering.noise * rendering.noise + 1.0 / 12.0);
  Informations in_sight;
  for (const PredictedMarker& visible : predictMarkers(map, camera, {truth}, {})) {
    const Marker& marker = map.markers[visible.map_entry];
    const TagPattern pattern(marker);
    const auto pixels = patternPixels(image, camera, truth, marker, pattern, rendering.samples);
    if (pixels.size() < kFewestPixels) continue;
    const Light light = fitLight(pixels, noise);
    const bool is_seen = light.correlation >= kMinCorrelation || used.count(visible.map_entry) > 0;
    if (!is_seen) continue;
    in_sight[visible.map_entry] = {
        pixelInformation(pixels, light.contrast, noise, 0.0),
        pixelInformation(pixels, light.contrast, noise, samplingVariance(pixels))};
  }
  return in_sight;
}

FrameMatrix leastCovariance(const Informations& in_sight, const MarkerMap& map, const Pose& truth,
                            const PosePrior& prior) {
  FrameEquations sum;
  for (const auto& [entry, information] : in_sight) {
    const Marker& marker = map.markers[entry];
    const Misplacement misplacement{marker.deviation, marker.orientation_deviation};
    sum.add(withMisplacement(information.sampled, seenFrom(truth, marker, misplacement)), 1.0);
  }
  return withPriors(sum, prior, truth, ImagingError::Zero()).information.inverse();
}

}  // namespace omnitag
