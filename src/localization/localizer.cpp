#include "omnitag/localization/localizer.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <utility>

#include "frame_search.h"
#include "frame_tracker.h"
#include "glance_search.h"
#include "measured_pose.h"
#include "omnitag/common/angle.h"
#include "omnitag/common/error.h"
#include "omnitag/common/format.h"
#include "omnitag/common/stopwatch.h"
#include "omnitag/localization/displacement.h"
#include "omnitag/localization/reprojection.h"
#include "patrol.h"
#include "pose_confirmation.h"

namespace omnitag {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Standard deviations by which the pose of the markers alone may be off the prediction: robots
/// accelerate and slip more than the motion model says, but not that much.
constexpr double kMaxDeviations = 6.0;

/// Markers that may be nearly where they were though the robot was carried toward them or away.
constexpr int kFew = 2;

/// m and rad, standard deviation by which a robot that sways seems to move, whatever its odometry
/// says.
constexpr double kSway = 2e-3;

/// s until a pose that stands on few markers is doubted again, which costs a look all around.
constexpr double kDoubtPeriod = 0.25;

/// s until a rejected marker is measured again, which takes a millisecond or two.
constexpr double kMeasuringPeriod = 1.0;

std::set<std::string> familiesOf(const MarkerMap& map) {
  std::set<std::string> families;
  for (const Marker& marker : map.markers) families.insert(marker.family);
  // Of unknown markers.
  if (!map.default_family.empty()) families.insert(map.default_family);
  return families;
}

/// Two markers without a prediction have no third to contradict them where something shades or
/// covers one of them: a pose to start from is to be modest.
PoseEstimate modest(const PoseEstimate& pose, const FrameResult& result) {
  constexpr double kDoubt = 2.0;
  const double rise = result.acceptedMarkers() <= kFew ? kDoubt : 1.0;
  return {pose.pose, rise * rise * pose.covariance, rise * rise * pose.shared};
}

std::string describe(const cv::Mat& image) {
  return std::to_string(image.cols) + " x " + std::to_string(image.rows) + " pixels of type " +
         cv::typeToString(image.type());
}

std::string howFarOff(const Pose& found, const Pose& expected) {
  const PoseVector off = difference(found, expected);
  return format("found %.2f m and %.1f degrees off where it was expected", off.head<2>().norm(),
                degrees(std::abs(off[2])));
}

}  // namespace

Localizer::Localizer(std::shared_ptr<const CameraModel> camera, MarkerMap map,
                     const LocalizerConfig& config)
    : camera_(std::move(camera)),
      map_(std::move(map)),
      index_(map_),
      config_(config),
      reader_(camera_, kWorkingDistance, config.detector, familiesOf(map_), config.threads),
      glance_reader_(camera_, config.detector, reader_.detector(), config.threads),
      patterns_(map_),
      motion_(config.motion),
      memory_(config.attention),
      evidence_(config_.evidence, map_, memory_, config_.estimation.reprojection,
                config_.estimation.max_misfit),
      patrol_(std::make_unique<Patrol>()),
      blur_(config.estimation.blur * config.estimation.blur) {}

TrackingTools Localizer::trackingTools() {
  return {map_,      index_,  config_,   reader_, glance_reader_,         patterns_,
          standing_, memory_, evidence_, start_,  disagreement_.excess(), readable_};
}

Localizer::~Localizer() = default;

void Localizer::setMap(MarkerMap map) {
  patterns_.add(map);
  map_ = std::move(map);
  index_ = MarkerIndex(map_);
}

void Localizer::seek(std::vector<Marker> markers) { patrol_->seek(std::move(markers)); }

void Localizer::setPose(const PoseEstimate& map_from_base,
                        const std::optional<Pose>& odom_from_base) {
  given_pose_ = {map_from_base, odom_from_base};
}

void Localizer::setPose(const Pose& map_from_base, const std::optional<Pose>& odom_from_base) {
  const double position = config_.motion.initial_position_deviation;
  const double heading = config_.motion.initial_heading_deviation;
  const Eigen::Vector3d deviations(position, position, heading);
  setPose(floorEstimate(map_from_base, deviations.cwiseAbs2().asDiagonal()), odom_from_base);
}

void Localizer::forgetPose() {
  given_pose_.reset();
  has_pose_ = false;
  memory_.clear();
}

FrameResult Localizer::process(const Frame& frame) {
  check(frame);
  last_stamp_ = frame.stamp;

  Stopwatch total;
  FrameResult result;
  result.stamp = frame.stamp;
  result.is_on_floor = config_.motion.isOnFloor();
  memory_.startFrame(frame.stamp);
  standing_ = motion_.standing(frame.odom_from_base);
  const std::optional<PoseEstimate> predicted = predict(frame);
  const MountedCamera camera = cameraOf(frame, predicted.has_value());
  readable_ = ReadableImage(frame.image, blurToRead());
  const bool is_refuted = predicted && !track(frame, camera, *predicted, &result);
  if (!result.map_from_base) {
    search(frame, camera, predicted, is_refuted, &result);
    learnBlur(frame, camera, &result);
  }
  measure(camera, &result);
  remember(camera, result);
  if (result.is_open) withhold(&result);
  if (frame.wants_measured) {
    Stopwatch step;
    result.measured = measuredPose(trackingTools(), frame, camera, result);
    result.timings.solve += step.lap();
  }
  was_tracked_ = result.acceptedMarkers() > 0 && result.map_from_base.has_value();
  if (was_tracked_) seen_stamp_ = frame.stamp;
  result.exposure = exposureOf(frame.image);
  result.image_lag = image_lag_.lag();
  result.timings.total = total.lap();
  return result;
}

void Localizer::check(const Frame& frame) const {
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
}

std::optional<PoseEstimate> Localizer::predict(const Frame& frame) {
  if (given_pose_) {
    const GivenPose given = *std::exchange(given_pose_, std::nullopt);
    motion_.resetToGiven(given.map_from_base, frame.stamp,
                         given.odom_from_base ? given.odom_from_base : frame.odom_from_base);
    has_pose_ = true;
    memory_.forgetPlaces();
    start_ = PosePrior::about(given.map_from_base);
    return motion_.predict(frame.stamp, frame.odom_from_base);
  }
  if (!has_pose_) return std::nullopt;
  const PoseEstimate predicted = motion_.predict(frame.stamp, frame.odom_from_base);
  has_pose_ = motion_.isTrustworthy();
  return has_pose_ ? std::optional(predicted) : std::nullopt;
}

void Localizer::learnBlur(const Frame& frame, const MountedCamera& camera, FrameResult* result) {
  const std::vector<std::size_t> entries = acceptedEntries(*result);
  if (!result->map_from_base || entries.empty()) return;
  MountedCamera blurred = camera;
  constexpr int kRounds = 3;
  for (int round = 0; round < kRounds; ++round) {
    const auto aligned =
        alignWithPixels(trackingTools(), frame.image, blurred, entries, result->map_from_base->pose,
                        PosePrior::about(*result->map_from_base));
    if (!aligned) return;
    const ImageBlur blur = blur_.after(aligned->blur, blurred.blur());
    if (round == kRounds - 1) blur_.take(aligned->blur, blurred.blur());
    blurred = camera.withBlur(blur);
  }
  result->blur = blur_.blur();
}

double Localizer::blurToRead() {
  lost_frames_ = was_tracked_ ? 0 : lost_frames_ + 1;
  // Nothing tells a robot that is lost how blurred its images are.
  constexpr double kSupposed = 1.6;  // pixels
  const double known = blur_.blur().largestDeviation();
  const bool is_tried = lost_frames_ > 0 && lost_frames_ % 2 == 0;
  return is_tried ? std::max(kSupposed, known) : known;
}

MountedCamera Localizer::cameraOf(const Frame& frame, bool has_prediction) const {
  MountedCamera camera = MountedCamera(camera_, frame.base_from_camera).withBlur(blur_.blur());
  if (config_.shutter.isInstant()) return camera;
  if (frame.velocity) return camera.withMotion(config_.shutter, motion_.motionBy(*frame.velocity));
  return camera.withMotion(config_.shutter,
                           has_prediction ? motion_.motion() : motion_.unknownMotion());
}

bool Localizer::track(const Frame& frame, const MountedCamera& camera,
                      const PoseEstimate& predicted, FrameResult* result) {
  Stopwatch step;
  result->predicted = predictMarkers(map_, index_, camera, predicted, config_.visibility);
  result->timings.predict += step.lap();
  const std::optional<PoseEstimate> pose = followMarkers(frame, camera, predicted, result);
  if (result->is_open) {
    // Either pose would only seem to be confirmed from then on.
    result->map_from_base = predicted;
    return true;
  }
  // Where most of what is read contradicts, the prediction itself is in doubt.
  if (!pose || contradictions(*result, map_) > result->acceptedMarkers()) return true;
  if (!markersAgree(camera, predicted, pose->pose, *result)) return false;
  if (isElsewhere(frame, camera, *pose, result)) return false;
  const PoseEstimate corrected = withLag(frame, predicted, *pose);
  motion_.correct(corrected);
  disagreement_.add(result->disagreement);
  result->mode = Mode::kTracking;
  result->map_from_base = corrected;
  patrol_->look(trackingTools(), frame, camera, pose->pose, result);
  return true;
}

std::optional<PoseEstimate> Localizer::followMarkers(const Frame& frame,
                                                     const MountedCamera& camera,
                                                     const PoseEstimate& predicted,
                                                     FrameResult* result) {
  const TrackingTools tools = trackingTools();
  const FrameResult before = *result;
  MountedCamera blurred = camera;
  std::optional<PoseEstimate> pose;
  // Markers that are blurred otherwise than expected are looked for again.
  constexpr int kRounds = 4;
  for (int round = 0; round < kRounds; ++round) {
    pose = FrameTracker(tools, frame, blurred, predicted, true, result).track();
    if (!result->blur_equations) break;
    const ImageBlur blur = blur_.after(*result->blur_equations, blurred.blur());
    if (areAlike(blur, blurred.blur(), camera_->rimPixels())) break;
    if (round == kRounds - 1) break;
    const Timings timings = result->timings;
    *result = before;
    result->timings = timings;
    blurred = camera.withBlur(blur);
  }
  if (result->blur_equations) blur_.take(*result->blur_equations, blurred.blur());
  result->blur = blur_.blur();
  return pose;
}

PoseEstimate Localizer::withLag(const Frame& frame, const PoseEstimate& predicted,
                                const PoseEstimate& pose) {
  PoseEstimate lagging = pose;
  if (!frame.velocity || !frame.odom_from_base) return lagging;
  const double innovation = difference(pose.pose, predicted.pose)[2];
  image_lag_.add(innovation, *frame.velocity, was_tracked_);
  if (const std::optional<double> lag = image_lag_.lag()) {
    const PoseMatrix covariance = covarianceOfLag(*lag, *frame.velocity);
    lagging.covariance += covariance;
    lagging.shared += covariance;
  }
  return lagging;
}

bool Localizer::markersAgree(const MountedCamera& camera, const PoseEstimate& predicted,
                             const Pose& solution, const FrameResult& result) const {
  std::vector<MarkerObservation> observations;
  double worst = 0.0;
  for (const MarkerDetection& detection : result.detections) {
    if (!detection.accepted) continue;
    observations.push_back({*detection.map_entry, detection.corners, detection.center});
    worst = std::max(worst, detection.deviations);
  }
  // One or two that the robot was carried toward or away from are nearly where they were.
  if (result.acceptedMarkers() <= kFew && worst > config_.relocalization.max_misfit_of_one) {
    return false;
  }
  if (observations.size() == 1) return true;
  const ReprojectionConfig& reprojection = config_.estimation.reprojection;
  const auto fit = refineFromAfar(map_, camera, observations, solution, standing_, reprojection);
  if (!fit) return true;
  const PoseVector apart = difference(fit->map_from_base.pose, predicted.pose);
  const PoseMatrix covariance =
      predicted.covariance + fit->map_from_base.covariance + kSway * kSway * PoseMatrix::Identity();
  return apart.dot(covariance.ldlt().solve(apart)) <= kMaxDeviations * kMaxDeviations;
}

bool Localizer::isElsewhere(const Frame& frame, const MountedCamera& camera,
                            const PoseEstimate& tracked, FrameResult* result) {
  const auto lost =
      std::count_if(result->missed.begin(), result->missed.end(),
                    [this](std::size_t entry) { return memory_.wasSeenSince(entry, seen_stamp_); });
  const bool is_weak = result->acceptedMarkers() <= kFew && lost > 0;
  if (!is_weak || frame.stamp < next_doubt_) return false;
  next_doubt_ = frame.stamp + kDoubtPeriod;
  FrameResult around;
  around.timings = result->timings;
  const std::vector<MarkerReading> readings = lookAround(trackingTools(), camera, &around);
  Stopwatch step;
  const Relocalization found =
      relocalize(map_, camera, readings, standing_, config_.estimation, config_.relocalization);
  result->timings = around.timings;
  result->timings.solve += step.lap();
  result->explored = std::move(around.explored);
  const auto explained = std::count_if(found.entries.begin(), found.entries.end(),
                                       [](const auto& entry) { return entry.has_value(); });
  return found.map_from_base && explained >= 2 && !agree(*found.map_from_base, tracked);
}

void Localizer::search(const Frame& frame, const MountedCamera& camera,
                       const std::optional<PoseEstimate>& predicted, bool is_refuted,
                       FrameResult* result) {
  const std::vector<std::size_t> missed = result->missed;
  const auto accept = [&](const PoseEstimate& seen) {
    result->missed = missed;
    const bool is_expected = predicted && agree(*predicted, seen);
    const PoseEstimate pose = is_expected ? seen : modest(seen, *result);
    decide(pose, frame, camera, predicted, is_expected, result);
  };
  if (const auto seen = glance(trackingTools(), frame, camera, result)) {
    return accept(*seen);
  }
  const std::vector<MarkerReading> readings = lookAround(trackingTools(), camera, result);
  Stopwatch step;
  const Relocalization found =
      relocalize(map_, camera, readings, standing_, config_.estimation, config_.relocalization);
  result->timings.solve += step.lap();
  if (!found.map_from_base && config_.estimation.kind == EstimatorKind::kPhotometric) {
    if (const auto seen = confirmAround(readings, frame, camera, result)) return accept(*seen);
  }
  step.lap();
  const std::vector<std::size_t> explaining =
      addDetections(trackingTools(), readings, found, result);

  // A single marker may hang elsewhere than the map says: it does not overrule a prediction that
  // markers confirmed a moment ago.
  const bool is_expected =
      predicted && found.map_from_base && agree(*predicted, *found.map_from_base);
  const bool overrules = !predicted || is_expected || explaining.size() >= 2 ||
                         motion_.uncorrectedTime() > config_.motion.max_dead_reckoning_time;
  if (found.map_from_base && overrules) {
    const PosePrior prior = is_expected ? PosePrior::about(*predicted) : standing_;
    // A single marker may hang elsewhere than the map says, which its pixels cannot tell either.
    const bool is_sure = is_expected || explaining.size() >= 2;
    PoseEstimate pose = *found.map_from_base;
    if (is_sure) {
      const auto aligned =
          alignWithPixels(trackingTools(), frame.image, camera, explaining, pose.pose, prior);
      // Where the two contradict each other, something covers a marker or the map is not exact
      // enough to align pixels with: corners bear more.
      const bool fits = aligned && agree(aligned->map_from_base, pose);
      pose = fits ? aligned->map_from_base : standingOnCorners(pose, explaining.size(), config_);
      result->imaging_error = fits ? aligned->imaging_error : found.imaging_error;
      result->timings.solve += step.lap();
      pose = withUndecoded(trackingTools(), frame, camera, pose, explaining, prior, result);
      step.lap();
      if (!is_expected) pose = modest(pose, *result);
    }
    result->missed = missed;
    decide(pose, frame, camera, predicted, is_expected, result);
  } else if (predicted) {
    carryOn(*predicted, is_refuted, result);
  } else {
    result->remark = found.reason;
  }
  setResiduals(trackingTools(), camera, result);
  result->timings.solve += step.lap();
}

std::optional<PoseEstimate> Localizer::confirmAround(const std::vector<MarkerReading>& readings,
                                                     const Frame& frame,
                                                     const MountedCamera& camera,
                                                     FrameResult* result) {
  const auto areTwo = [](const FrameResult& seen) { return seen.acceptedMarkers() >= 2; };
  auto seen = confirm({readings, result->views, result->view_images}, areTwo, trackingTools(),
                      frame, camera, &result->timings);
  if (!seen) return std::nullopt;
  seen->explored = std::move(result->explored);
  seen->timings = result->timings;
  *result = std::move(*seen);
  return result->map_from_base;
}

void Localizer::settle(const PoseEstimate& pose, const Frame& frame,
                       const std::optional<PoseEstimate>& predicted, bool is_expected,
                       FrameResult* result) {
  if (is_expected) {
    motion_.correct(pose);
    result->mode = Mode::kTracking;
  } else {
    motion_.reset(pose, frame.stamp, frame.odom_from_base);
    start_.reset();
    result->mode = Mode::kFound;
    if (predicted) result->remark = howFarOff(pose.pose, predicted->pose);
  }
  result->map_from_base = pose;
  has_pose_ = true;
}

void Localizer::carryOn(const PoseEstimate& predicted, bool is_refuted, FrameResult* result) const {
  rejectAccepted("contradicts the predicted pose", result);
  if (is_refuted || contradictions(*result, map_) > 0) {
    result->remark = "the markers that were read contradict the predicted pose";
    return;
  }
  result->mode = Mode::kDeadReckoning;
  result->map_from_base = predicted;
}

void Localizer::measure(const MountedCamera& camera, FrameResult* result) {
  const bool is_measured = result->acceptedMarkers() > 0;
  for (MarkerDetection& detection : result->detections) {
    const std::optional<Ray> ray = camera.rayInBase(detection.center);
    detection.bearing = ray ? std::atan2(ray->direction.y(), ray->direction.x()) : kNaN;
    detection.range = kNaN;
    if (!result->map_from_base) continue;
    const Pose& pose = result->map_from_base->pose;
    if (detection.map_entry) {
      const Eigen::Vector3d viewpoint = camera.mapFromCamera(pose).translation();
      detection.range = (map_.markers[*detection.map_entry].center() - viewpoint).head<2>().norm();
    }
    if (detection.accepted || !is_measured || !isDue(detection, result->stamp)) continue;
    const auto displaced =
        displacement(map_, camera, detection.family, detection.id,
                     {0, detection.corners, detection.center}, pose, standing_, config_.estimation);
    if (displaced) result->displaced.push_back(*displaced);
  }
}

bool Localizer::isDue(const MarkerDetection& rejected, double stamp) {
  if (entriesOf(map_, rejected.family, rejected.id).empty()) return false;
  const auto [last, is_first] = measured_.try_emplace({rejected.family, rejected.id}, stamp);
  if (!is_first && stamp < last->second + kMeasuringPeriod) return false;
  last->second = stamp;
  return true;
}

}  // namespace omnitag
