#include "localization/advice.h"

#include <algorithm>
#include <cmath>

#include "common/format.h"
#include "marker/marker_reader.h"

namespace omnitag {
namespace {

/// Limits beyond which something is wrong: of mean squared residuals relative to the expected ones,
/// and of a camera mode in standard deviations.
constexpr double kLargeExcess = 2.5;
constexpr double kLargeError = 2.0;

/// m, RMS over the accepted markers.
double misplacementIn(const FrameResult& result, const MarkerMap& map) {
  double squares = 0.0;
  int count = 0;
  for (const MarkerDetection& detection : result.detections) {
    if (!detection.accepted) continue;
    const double metres_per_pixel =
        map.markers[*detection.map_entry].size / std::max(1.0, meanEdge(detection.corners));
    squares += std::pow(metres_per_pixel * detection.residual, 2);
    ++count;
  }
  return count > 0 ? std::sqrt(squares / count) : 0.0;
}

}  // namespace

void Advisor::add(const FrameResult& result, const MarkerMap& map, const CameraModel& camera) {
  exposure_ = result.exposure;
  lag_ = result.image_lag;
  if (result.acceptedMarkers() < 2 || !result.map_from_base) return;
  excess_.add(result.excess);
  misplacement_.add(misplacementIn(result, map));
  blur_.add(result.blur.largestDeviation());
  // All modes except the principal point's, which shifts the whole image equally.
  constexpr int kPrincipalPoint = 2;
  const auto modes = result.imaging_error.segment<kCameraModes - kPrincipalPoint>(kPrincipalPoint);
  const CameraUncertainty& uncertainty = camera.uncertainty();
  const Eigen::Vector4d pixels(uncertainty.scale, uncertainty.tilt, uncertainty.tilt,
                               uncertainty.rim);
  rim_error_.add(modes.cwiseProduct(pixels).norm());
  rim_deviations_.add(modes.cwiseAbs().maxCoeff());
}

std::vector<std::string> Advisor::lines() const {
  std::vector<std::string> lines;
  if (exposure_ != ImageExposure::kGood) {
    lines.push_back(format("the images are %s: set the camera's exposure", toString(exposure_)));
  }
  constexpr double kLargeBlur = 1.5;  // pixels
  const bool is_blurred = blur_.value() > kLargeBlur;
  if (is_blurred) {
    lines.push_back(format("the images are blurred by %.1f pixels: focus the lens", blur_.value()));
  }
  if (lag_) {
    lines.push_back(
        format("images are %.0f ms later than their stamps when turning: set "
               "image_time_offset, or row_readout_time where the shutter is a rolling "
               "one",
               1e3 * *lag_));
  }
  if (rim_deviations_.value() > kLargeError) {
    lines.push_back(format("residuals grow toward the rim, to %.1f pixels: run calibrate_camera",
                           rim_error_.value()));
  } else if (excess_.value() > kLargeExcess && !is_blurred) {
    // Blurred markers disagree wherever they hang.
    lines.push_back(
        format("markers disagree by %.1f cm, %.1f times more than the map says: raise "
               "its deviation or refine it with build_map",
               1e2 * misplacement_.value(), std::sqrt(excess_.value())));
  }
  return lines;
}

}  // namespace omnitag
