#include "omnitag/localization/localizer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <utility>

#include "belief.h"
#include "frame_search.h"
#include "frame_steps.h"
#include "measured_pose.h"
#include "omnitag/common/error.h"
#include "omnitag/common/stopwatch.h"
#include "omnitag/localization/displacement.h"
#include "patrol.h"

namespace omnitag {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// s until a rejected marker is measured again, which takes a millisecond or two.
constexpr double kMeasuringPeriod = 1.0;

std::string describe(const cv::Mat& image) {
  return std::to_string(image.cols) + " x " + std::to_string(image.rows) + " pixels of type " +
         cv::typeToString(image.type());
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
      evidence_(config_.evidence, map_, config_.estimation.reprojection),
      hypotheses_{{MotionModel(config.motion), MarkerMemory(config.attention)}},
      patrol_(std::make_unique<Patrol>()),
      blur_(config.estimation.blur * config.estimation.blur) {
  hypotheses_.front().is_lost = true;
}

Localizer::~Localizer() = default;

TrackingTools Localizer::trackingTools(const Hypothesis& hypothesis) {
  return {map_,
          index_,
          config_,
          reader_,
          glance_reader_,
          patterns_,
          standing_,
          hypothesis.memory,
          disagreement_.excess(),
          readable_};
}

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
  hypotheses_.resize(1, hypotheses_.front());
  hypotheses_.front().is_lost = true;
  hypotheses_.front().memory.clear();
}

FrameResult Localizer::process(const Frame& frame) {
  check(frame);
  Stopwatch total;
  last_stamp_ = frame.stamp;
  const std::vector<PoseEstimate> predicted = predict(frame);
  const MountedCamera camera = cameraOf(frame);
  readable_ = ReadableImage(frame.image, blurToRead());

  std::vector<Account> accounts;
  if (isLost()) {
    accounts = lookFor(frame, camera, {hypotheses_.front(), emptyResult(frame, config_)},
                       std::nullopt, false);
  } else {
    accounts = track(frame, camera, predicted);
  }
  accounts = judged(std::move(accounts), camera, evidence_);
  FrameResult result = reported(accounts, map_, config_.evidence);
  hypotheses_.clear();
  for (Account& account : accounts) hypotheses_.push_back(std::move(account.hypothesis));

  learnFrom(frame, camera, accounts.front().is_of_search, &result);
  measure(camera, &result);
  if (frame.wants_measured && !result.is_open) {
    Stopwatch step;
    result.measured = measuredPose(trackingTools(hypotheses_.front()), frame, camera, result);
    result.timings.solve += step.lap();
  }
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

std::vector<PoseEstimate> Localizer::predict(const Frame& frame) {
  standing_ = hypotheses_.front().motion.standing(frame.odom_from_base);
  if (given_pose_) {
    const GivenPose given = *std::exchange(given_pose_, std::nullopt);
    Hypothesis& hypothesis = hypotheses_.front();
    hypothesis.motion.resetToGiven(
        given.map_from_base, frame.stamp,
        given.odom_from_base ? given.odom_from_base : frame.odom_from_base);
    hypothesis.memory.forgetPlaces();
    hypothesis.is_lost = false;
    const PoseEstimate predicted = hypothesis.motion.predict(frame.stamp, frame.odom_from_base);
    hypothesis.restart(PosePrior::about(predicted));
    hypotheses_.resize(1, hypotheses_.front());
    return {predicted};
  }
  std::vector<PoseEstimate> predicted;
  for (Hypothesis& hypothesis : hypotheses_) {
    predicted.push_back(hypothesis.motion.predict(frame.stamp, frame.odom_from_base));
    // Until markers confirm it, a pose from outside is as uncertain as its prediction has become.
    const bool is_unmet = hypothesis.start && hypothesis.memory.countInPlace() == 0;
    if (is_unmet) hypothesis.start = PosePrior::about(predicted.back());
    hypothesis.is_lost = hypothesis.is_lost || !hypothesis.motion.isTrustworthy();
  }
  // For a lost robot, keep what was last known of the world.
  if (isLost()) hypotheses_.resize(1, hypotheses_.front());
  return predicted;
}

bool Localizer::isLost() const {
  return std::all_of(hypotheses_.begin(), hypotheses_.end(),
                     [](const Hypothesis& hypothesis) { return hypothesis.is_lost; });
}

MountedCamera Localizer::cameraOf(const Frame& frame) const {
  MountedCamera camera = MountedCamera(camera_, frame.base_from_camera).withBlur(blur_.blur());
  if (config_.shutter.isInstant()) return camera;
  const MotionModel& motion = hypotheses_.front().motion;
  if (frame.velocity) return camera.withMotion(config_.shutter, motion.motionBy(*frame.velocity));
  return camera.withMotion(config_.shutter, !isLost() ? motion.motion() : motion.unknownMotion());
}

void Localizer::learnFrom(const Frame& frame, const MountedCamera& camera, bool was_searched,
                          FrameResult* result) {
  was_tracked_ = result->acceptedMarkers() > 0 && result->map_from_base.has_value();
  result->exposure = exposureOf(frame.image);
  result->image_lag = image_lag_.lag();
  if (was_searched) learnBlur(frame, camera, result);
  if (!was_tracked_ || result->is_open) return;
  if (result->disagreement.freedom > 0.0) disagreement_.add(result->disagreement);
  if (was_searched) return;
  patrol_->look(trackingTools(hypotheses_.front()), frame, camera, result->map_from_base->pose,
                result);
}

void Localizer::learnBlur(const Frame& frame, const MountedCamera& camera, FrameResult* result) {
  const std::vector<std::size_t> entries = acceptedEntries(*result);
  if (!result->map_from_base || entries.empty()) return;
  MountedCamera blurred = camera;
  constexpr int kRounds = 3;
  for (int round = 0; round < kRounds; ++round) {
    const auto aligned =
        alignWithPixels(trackingTools(hypotheses_.front()), frame.image, blurred, entries,
                        result->map_from_base->pose, PosePrior::about(*result->map_from_base));
    if (!aligned) return;
    const ImageBlur blur = blur_.after(aligned->blur, blurred.blur());
    if (round == kRounds - 1) blur_.take(aligned->blur, blurred.blur());
    blurred = camera.withBlur(blur);
  }
  result->blur = blur_.blur();
}

double Localizer::blurToRead() {
  lost_frames_ = was_tracked_ ? 0 : lost_frames_ + 1;
  // While lost, nothing shows how blurred the images are.
  constexpr double kSupposed = 1.6;  // pixels
  const double known = blur_.blur().largestDeviation();
  const bool is_tried = lost_frames_ > 0 && lost_frames_ % 2 == 0;
  return is_tried ? std::max(kSupposed, known) : known;
}

void Localizer::measure(const MountedCamera& camera, FrameResult* result) {
  const bool is_measured = result->acceptedMarkers() > 0;
  for (MarkerDetection& detection : result->detections) {
    const std::optional<Ray> ray = camera.rayInBase(detection.center);
    detection.bearing = ray ? std::atan2(ray->direction.y(), ray->direction.x()) : kNaN;
    if (ray) {
      detection.sight = camera.baseFromCamera().linear().transpose() * ray->direction.normalized();
    }
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
