#include "adjustment/camera_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "adjustment/bundle_costs.h"
#include "adjustment/calibration_checks.h"
#include "adjustment/calibration_data.h"
#include "adjustment/calibration_report.h"
#include "adjustment/outliers.h"
#include "adjustment/pose_from_bearings.h"
#include "adjustment/pose_from_corners.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

constexpr std::size_t kMinFrames = 10;

/// The misfit of a marker's corners (RMS), relative to the noise, beyond which the marker counts
/// less and less.
const double kWidthOfNoise = std::sqrt(0.25 * kExpectedOfMarker);

}  // namespace

CameraFit::CameraFit(const CameraTemplate& guess, const MarkerMap& map,
                     const std::vector<FrameReadings>& frames, const CalibrationConfig& config,
                     const CalibrationProgress& progress)
    : config_(config), progress_(progress) {
  const Eigen::Isometry3d& mounting = frames.front().base_from_camera;
  bundle.model = std::make_shared<CalibrationModel>(guess, LeaningMounting(mounting));
  bundle.values = bundle.model->guess();
  bundle.constraints = config.constraints;
  for (const std::string& name : config.fixed) {
    if (!model().indexOf(name)) {
      throw InputError("fixed parameters: expected some of " + namesOf(model()) + ", found '" +
                       name + "'");
    }
  }
  for (std::size_t i = 0; i < map.markers.size(); ++i) {
    const Marker& marker = map.markers[i];
    bundle.landmarks.push_back(
        {marker, config.priors.empty() ? PlacePrior::surveyed(marker) : config.priors[i], true});
  }

  CalibrationData data = selectObservations(map, frames, !config.is_rough);
  remarks = std::move(data.remarks);
  const MountedCamera camera = model().mounted(bundle.values);
  // A camera whose axis is horizontal sees the markers of all walls in a band across its image.
  if (!config.is_rough && (config.is_free || isUpright(mounting))) {
    checkCoverage(data.frames, camera.model().imagePlane(), config.is_free);
  }
  for (const CalibrationFrame& frame : data.frames) {
    const auto pose =
        config.is_free ? poseFromCorners(map, camera, frame) : poseFromBearings(map, camera, frame);
    if (!pose) continue;
    for (const MarkerObservation& observation : frame.observations) {
      bundle.observations.push_back(
          {bundle.frames.size(), observation.map_entry, stacked(observation.corners)});
    }
    bundle.frames.push_back({mounting, *pose, false, frame.stamp});
  }
  if (bundle.frames.size() < kMinFrames) {
    throw InputError(
        (config.is_free ? "corners" : "bearings to the markers") +
        std::string(" agree with the map in ") + std::to_string(bundle.frames.size()) + " of " +
        std::to_string(data.frames.size()) + " images only, expected at least " +
        std::to_string(kMinFrames) +
        ": look at the map or the board, at lens.cx and lens.cy (the centre of the image's circle) "
        "and at which way the optical axis points");
  }
  std::vector<Pose> poses;
  for (const Bundle::Frame& frame : bundle.frames) poses.push_back(frame.map_from_base);
  if (config.is_free) {
    checkViews(poses);
  } else {
    checkMotion(poses);
  }
}

bool CameraFit::isFixed(const std::string& name) const {
  const auto index = model().indexOf(name);
  const bool is_gauge = config_.is_free && index && model().isOfMounting(*index);
  return is_gauge || config_.fixed.count(name) > 0;
}

const std::string& CameraFit::nameOf(Eigen::Index index) const {
  return model().parameters()[static_cast<std::size_t>(index)].name;
}

CameraFit::Indices CameraFit::indicesOf(std::initializer_list<const char*> names) const {
  Indices indices;
  for (const char* name : names) {
    const auto index = model().indexOf(name);
    if (index && !isFixed(name)) indices.push_back(*index);
  }
  return indices;
}

double CameraFit::medianResidual() const {
  std::vector<double> lengths;
  for (const CornerResidual& corner : cornerResiduals(bundle)) lengths.push_back(lengthOf(corner));
  return medianOf(std::move(lengths));
}

double CameraFit::rms() const { return summarize(cornerResiduals(bundle)).rms; }

double CameraFit::leastNoise() const { return config_.robust_width / kWidthOfNoise; }

BundleConfig CameraFit::configOf(const Indices& free, Moving moving) const {
  BundleConfig config;
  config.free = free;
  config.adjusts_poses = moving != Moving::kCamera;
  config.adjusts_markers = moving == Moving::kAll;
  config.is_free = config_.is_free;
  if (!config_.is_free && moving == Moving::kAll) {
    // Height and lean each have a part from the mounting and one from the floor.
    config.height_deviation = std::sqrt(2.0) * config_.floor.height_deviation;
    config.lean_deviation = std::sqrt(2.0) * config_.floor.lean_deviation;
  }
  config.noise = noise_ > 0.0 ? noise_ : leastNoise();
  config.max_iterations = 200;
  return config;
}

void CameraFit::adjust(const std::string& step, const Indices& free, Moving moving) {
  constexpr double kWide = 3.0;     // median residuals
  constexpr double kWidest = 60.0;  // pixels
  constexpr int kMaxRounds = 5;
  BundleConfig config = configOf(free, moving);
  double last_width = std::numeric_limits<double>::infinity();
  for (int round = 0; round < kMaxRounds; ++round) {
    const double width =
        std::max(config_.robust_width, std::min(kWide * medianResidual(), kWidest));
    // Another round with a hardly narrower width would change nothing.
    constexpr double kHardly = 0.9;
    if (width > kHardly * last_width) break;
    last_width = width;
    config.noise = width / kWidthOfNoise;
    omnitag::adjust(&bundle, config, [&](int iteration, double) {
      if (progress_) progress_(step, iteration);
    });
  }
}

void CameraFit::settle(const Indices& free) {
  // With residuals of zero, all other terms would have no weight.
  constexpr double kLeast = 1e-3;  // pixels
  noise_ = std::max(information(free).noise, kLeast);
  omnitag::adjust(&bundle, configOf(free, Moving::kAll));
}

CameraInformation CameraFit::cameraInformation(const Indices& free) const {
  const BundleInformation all = information(free);
  return {all.camera, all.common_error_gradient, 0.0};
}

BundleInformation CameraFit::information(const Indices& free) const {
  BundleConfig config = configOf(free, Moving::kAll);
  Undetermined undetermined;
  const auto told = omnitag::information(bundle, config, &undetermined);
  if (!told) {
    throw InputError("the images do not tell " + undetermined.direction +
                     (config_.is_free
                          ? ": hold the board in other places of the image, near and tilted"
                          : ": drive past all markers, and see that some are in sight together"));
  }
  if (noise_ > 0.0) return *told;
  // At the noise that the residuals show.
  constexpr double kLeast = 1e-4;  // pixels
  config.noise = std::max(told->noise, kLeast);
  const auto again = omnitag::information(bundle, config, &undetermined);
  return again ? *again : *told;
}

void CameraFit::leaveOutOutliers() {
  leaveOutFrames(&bundle, &remarks);
  if (bundle.frames.size() < kMinFrames) {
    throw InputError(
        "no camera explains the images: look at the map or the board, and at the guess's model");
  }
  leaveOutMarkers(&bundle, &remarks);
}

}  // namespace omnitag
