#include "omnitag/localization/localizer.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "omnitag/common/error.h"
#include "omnitag/marker/marker_association.h"

namespace omnitag {
namespace {

/// m. The contours of horizontal lines hardly change beyond; nearer ones only bend a view a little,
/// since positions go back to the panorama through the same table.
constexpr double kWorkingDistance = 3.0;

class Stopwatch {
 public:
  /// Seconds since the start or the last call.
  double lap() {
    const Clock::time_point now = Clock::now();
    return std::chrono::duration<double>(now - std::exchange(start_, now)).count();
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

std::set<std::string> familiesOf(const MarkerMap& map) {
  std::set<std::string> families;
  for (const Marker& marker : map.markers) families.insert(marker.family);
  return families;
}

std::string describe(const cv::Mat& image) {
  return std::to_string(image.cols) + " x " + std::to_string(image.rows) + " pixels of type " +
         cv::typeToString(image.type());
}

/// A reading in the panorama; nothing where a corner is off the world that the panorama shows.
std::optional<MarkerReading> inPanorama(const TagDetection& tag, const View& view,
                                        const ViewWarper& warper) {
  MarkerReading reading{tag.family, tag.id, {}, {}};
  for (std::size_t k = 0; k < tag.corners.size(); ++k) {
    const auto corner = warper.panoramaFromView(view, tag.corners[k]);
    if (!corner) return std::nullopt;
    reading.corners[k] = *corner;
  }
  const auto center = warper.panoramaFromView(view, tag.center);
  if (!center) return std::nullopt;
  reading.center = *center;
  return reading;
}

}  // namespace

const char* toString(Mode mode) {
  switch (mode) {
    case Mode::kSearching:
      return "searching";
    case Mode::kTracking:
      return "tracking";
    case Mode::kDeadReckoning:
      return "dead_reckoning";
  }
  return "";
}

int FrameResult::acceptedMarkers() const {
  return static_cast<int>(std::count_if(detections.begin(), detections.end(),
                                        [](const MarkerDetection& d) { return d.accepted; }));
}

/// What was read in a frame, and which of the detections are observations of the map.
struct Localizer::Look {
  std::vector<MarkerObservation> observations;
  /// For each observation, its index among the frame's detections.
  std::vector<std::size_t> detections;
};

Localizer::Localizer(std::shared_ptr<const CameraModel> camera, MarkerMap map,
                     const LocalizerConfig& config)
    : camera_(std::move(camera)),
      map_(std::move(map)),
      config_(config),
      warper_(camera_, kWorkingDistance),
      detector_(config.detector, familiesOf(map_)),
      motion_(config.motion) {}

void Localizer::setPose(const PoseEstimate& map_from_base) { given_pose_ = map_from_base; }

void Localizer::setPose(const Pose2& map_from_base) {
  const double position = config_.motion.initial_position_deviation;
  const double heading = config_.motion.initial_heading_deviation;
  const Eigen::Vector3d deviations(position, position, heading);
  setPose({map_from_base, deviations.cwiseAbs2().asDiagonal()});
}

void Localizer::forgetPose() {
  given_pose_.reset();
  has_pose_ = false;
}

FrameResult Localizer::process(const Frame& frame) {
  const ImageSize& size = camera_->imageSize();
  if (frame.image.type() != CV_8UC1 || frame.image.cols != size.width ||
      frame.image.rows != size.height) {
    throw InputError("image: expected " + std::to_string(size.width) + " x " +
                     std::to_string(size.height) + " pixels of type CV_8UC1, found " +
                     describe(frame.image));
  }
  if (!std::isfinite(frame.stamp) || (last_stamp_ && frame.stamp <= *last_stamp_)) {
    throw InputError("image stamp: expected later than " +
                     std::to_string(last_stamp_.value_or(0.0)) + " s, found " +
                     std::to_string(frame.stamp) + " s");
  }
  last_stamp_ = frame.stamp;

  Stopwatch total;
  FrameResult result;
  result.stamp = frame.stamp;
  std::optional<PoseEstimate> predicted;
  if (given_pose_) {
    predicted = *std::exchange(given_pose_, std::nullopt);
    motion_.reset(*predicted, frame.stamp, frame.odom_from_base);
    has_pose_ = true;
  } else if (has_pose_) {
    predicted = motion_.predict(frame.stamp, frame.odom_from_base);
  }
  if (predicted) {
    const MountedCamera camera(camera_, frame.base_from_camera);
    Stopwatch step;
    result.predicted = predictMarkers(map_, camera, *predicted, config_.visibility);
    result.timings.predict = step.lap();
    solve(camera, *predicted, look(frame, camera, &result), &result);
  }
  result.timings.total = total.lap();
  return result;
}

Localizer::Look Localizer::look(const Frame& frame, const MountedCamera& camera,
                                FrameResult* result) const {
  Stopwatch step;
  std::vector<ViewTarget> targets;
  targets.reserve(result->predicted.size());
  for (const PredictedMarker& marker : result->predicted) {
    targets.push_back(viewTarget(marker, *camera_));
  }
  result->views = planViews(targets, warper_.table(), camera_->imagePlane().scale(),
                            camera.axisUp(), config_.view);
  result->timings.predict += step.lap();
  for (const View& view : result->views) {
    result->view_images.push_back(warper_.warp(frame.image, view));
  }
  result->timings.warp = step.lap();

  Look look;
  for (std::size_t v = 0; v < result->views.size(); ++v) {
    const View& view = result->views[v];
    for (const TagDetection& tag : detector_.detect(result->view_images[v])) {
      const std::optional<MarkerReading> reading = inPanorama(tag, view, warper_);
      if (!reading) continue;
      const Association association =
          associate(*reading, result->predicted, view.targets, map_, config_.association);
      MarkerDetection detection;
      detection.family = tag.family;
      detection.id = tag.id;
      detection.corners = reading->corners;
      detection.center = reading->center;
      detection.reason = association.reason;
      if (association.prediction) {
        detection.map_entry = result->predicted[*association.prediction].map_entry;
        look.observations.push_back({*detection.map_entry, reading->corners, reading->center});
        look.detections.push_back(result->detections.size());
      }
      result->detections.push_back(std::move(detection));
    }
  }
  result->timings.decode = step.lap();
  return look;
}

void Localizer::solve(const MountedCamera& camera, const PoseEstimate& predicted, const Look& look,
                      FrameResult* result) {
  Stopwatch step;
  const std::optional<PoseSolution> solution =
      estimatePose(map_, camera, look.observations, predicted, config_.estimation);
  if (solution) {
    motion_.correct(solution->map_from_base);
    result->mode = Mode::kTracking;
    result->map_from_base = solution->map_from_base;
  } else if (motion_.isTrustworthy()) {
    result->mode = Mode::kDeadReckoning;
    result->map_from_base = predicted;
  } else {
    has_pose_ = false;
  }

  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  for (MarkerDetection& detection : result->detections) {
    const std::optional<Ray> ray = camera.rayInBase(detection.center);
    detection.bearing = ray ? std::atan2(ray->direction.y(), ray->direction.x()) : kNaN;
    detection.range = kNaN;
    detection.residual = kNaN;
    if (!detection.map_entry || !result->map_from_base) continue;
    const Eigen::Vector3d viewpoint =
        camera.mapFromCamera(result->map_from_base->pose).translation();
    detection.range = (map_.markers[*detection.map_entry].center() - viewpoint).head<2>().norm();
  }
  for (std::size_t i = 0; i < look.observations.size(); ++i) {
    MarkerDetection& detection = result->detections[look.detections[i]];
    if (!solution) {
      detection.reason = "no pose agrees with it";
      continue;
    }
    detection.residual = solution->residuals[i];
    detection.accepted = solution->used[i];
    if (!detection.accepted) detection.reason = "disagrees with the other markers";
  }
  result->timings.solve = step.lap();
}

}  // namespace omnitag
