#include "omnitag/localization/localizer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <utility>

#include "common/stopwatch.h"
#include "localization/belief.h"
#include "localization/camera_state.h"
#include "localization/displacement.h"
#include "localization/frame_search.h"
#include "localization/frame_steps.h"
#include "localization/localizer_impl.h"
#include "localization/measured_pose.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// s: time until a rejected marker is measured again, which takes a millisecond or two.
constexpr double kMeasuringPeriod = 1.0;

std::string describe(const cv::Mat& image) {
  return std::to_string(image.cols) + " x " + std::to_string(image.rows) + " pixels of type " +
         cv::typeToString(image.type());
}

}  // namespace

Localizer::Impl::Impl(std::vector<LocalizerCamera> cameras, MarkerMap map,
                      const LocalizerConfig& config)
    : map_(std::move(map)),
      index_(map_),
      config_(config),
      patterns_(map_),
      evidence_(config_.evidence, map_, config_.estimation.reprojection),
      hypotheses_{{MotionModel(config.motion), MarkerMemory(config.attention)}} {
  hypotheses_.front().is_lost = true;
  for (LocalizerCamera& camera : cameras) {
    cameras_.push_back(std::make_unique<CameraState>(
        std::move(camera.model), camera.shutter.value_or(config_.shutter), map_, config_));
  }
}

const CameraModel& Localizer::Impl::camera(std::size_t index) const {
  return *cameras_[index]->model;
}

TrackingTools Localizer::Impl::trackingTools(const Frame& frame, const Hypothesis& hypothesis) {
  CameraState& camera = stateOf(frame);
  return {map_,
          index_,
          config_,
          camera.reader,
          camera.glance_reader,
          patterns_,
          standing_,
          hypothesis.memory,
          camera.knowledge.disagreement.excess(),
          camera.readable};
}

void Localizer::Impl::setMap(MarkerMap map) {
  patterns_.add(map);
  map_ = std::move(map);
  index_ = MarkerIndex(map_);
}

void Localizer::Impl::seek(const std::vector<Marker>& markers) {
  for (const auto& camera : cameras_) camera->patrol.seek(markers);
}

void Localizer::Impl::setPose(const PoseEstimate& map_from_base,
                              const std::optional<Pose>& odom_from_base) {
  given_pose_ = {map_from_base, odom_from_base};
}

void Localizer::Impl::setPose(const Pose& map_from_base,
                              const std::optional<Pose>& odom_from_base) {
  const double position = config_.motion.initial_position_deviation;
  const double heading = config_.motion.initial_heading_deviation;
  const Eigen::Vector3d deviations(position, position, heading);
  setPose(floorEstimate(map_from_base, deviations.cwiseAbs2().asDiagonal()), odom_from_base);
}

void Localizer::Impl::forgetPose() {
  given_pose_.reset();
  hypotheses_.resize(1, hypotheses_.front());
  hypotheses_.front().is_lost = true;
  hypotheses_.front().memory.clear();
}

FrameResult Localizer::Impl::process(const Frame& frame) {
  check(frame);
  Stopwatch total;
  for (Hypothesis& hypothesis : hypotheses_) hypothesis.memory.lookThrough(frame.camera);
  const std::vector<PoseEstimate> predicted = predict(frame);
  const MountedCamera camera = cameraOf(frame);
  CameraState& state = stateOf(frame);
  state.readable = ReadableImage(frame.image, blurToRead(&state));

  std::vector<Branch> branches;
  if (isLost()) {
    branches = lookFor(frame, camera, {hypotheses_.front(), emptyResult(frame, config_)},
                       std::nullopt, false);
  } else {
    branches = track(frame, camera, predicted);
  }
  branches = judged(std::move(branches), camera, evidence_);
  FrameResult result = reported(branches, map_, config_.evidence);
  hypotheses_.clear();
  for (Branch& branch : branches) hypotheses_.push_back(std::move(branch.hypothesis));

  learnFrom(frame, camera, branches.front().is_of_search, &result);
  state.knowledge.last_stamp = frame.stamp;
  last_stamp_ = std::max(frame.stamp, last_stamp_.value_or(frame.stamp));
  measure(camera, &result);
  result.camera = std::make_shared<const MountedCamera>(camera);
  if (frame.wants_measured && !result.is_open) {
    Stopwatch step;
    result.measured =
        measuredPose(trackingTools(frame, hypotheses_.front()), frame, camera, result);
    result.timings.solve += step.lap();
  }
  result.timings.total = total.lap();
  return result;
}

void Localizer::Impl::check(const Frame& frame) const {
  if (frame.camera >= cameras_.size()) {
    throw InputError("camera: expected one of " + std::to_string(cameras_.size()) +
                     ", counted from 0, found " + std::to_string(frame.camera));
  }
  const CameraState& camera = *cameras_[frame.camera];
  const ImageSize& size = camera.model->imageSize();
  if (frame.image.type() != CV_8UC1 || frame.image.cols != size.width ||
      frame.image.rows != size.height) {
    throw InputError("image: expected " + std::to_string(size.width) + " x " +
                     std::to_string(size.height) + " pixels of type CV_8UC1, found " +
                     describe(frame.image));
  }
  constexpr double kEver = -std::numeric_limits<double>::infinity();
  const double earliest = std::max(camera.knowledge.last_stamp.value_or(kEver),
                                   last_stamp_.value_or(kEver) - kMaxOvertaken);
  if (!(std::isfinite(frame.stamp) && frame.stamp > earliest)) {
    throw InputError("image stamp: expected later than " + std::to_string(earliest) + " s, found " +
                     std::to_string(frame.stamp) + " s");
  }
}

std::vector<PoseEstimate> Localizer::Impl::predict(const Frame& frame) {
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
  // For a lost robot, keep what was last known of the markers.
  if (isLost()) hypotheses_.resize(1, hypotheses_.front());
  return predicted;
}

bool Localizer::Impl::isLost() const {
  return std::all_of(hypotheses_.begin(), hypotheses_.end(),
                     [](const Hypothesis& hypothesis) { return hypothesis.is_lost; });
}

bool Localizer::Impl::isSeenByAnother(const Frame& frame) const {
  constexpr double kRecent = 0.25;  // s
  return std::any_of(cameras_.begin(), cameras_.end(), [&](const auto& camera) {
    const ImageKnowledge& knowledge = camera->knowledge;
    return camera != cameras_[frame.camera] && knowledge.was_tracked &&
           std::abs(frame.stamp - *knowledge.last_stamp) < kRecent;
  });
}

MountedCamera Localizer::Impl::cameraOf(const Frame& frame) {
  const CameraState& state = stateOf(frame);
  MountedCamera camera =
      MountedCamera(state.model, frame.base_from_camera).withBlur(state.knowledge.blur.blur());
  if (state.shutter.isInstant()) return camera;
  const MotionModel& motion = hypotheses_.front().motion;
  if (frame.velocity) return camera.withMotion(state.shutter, motion.motionBy(*frame.velocity));
  return camera.withMotion(state.shutter, !isLost() ? motion.motion() : motion.unknownMotion());
}

void Localizer::Impl::learnFrom(const Frame& frame, const MountedCamera& camera, bool was_searched,
                                FrameResult* result) {
  CameraState& state = stateOf(frame);
  ImageKnowledge& knowledge = state.knowledge;
  was_tracked_ = result->acceptedMarkers() > 0 && result->map_from_base.has_value();
  knowledge.was_tracked = was_tracked_;
  result->exposure = exposureOf(frame.image);
  result->image_lag = image_lag_.lag();
  if (was_searched) learnBlur(frame, camera, result);
  if (!result->map_from_base || result->is_open) return;
  if (was_tracked_ && result->disagreement.freedom > 0.0)
    knowledge.disagreement.add(result->disagreement);
  // Mapping only uses images whose own markers give the pose.
  const bool is_settled = was_tracked_ || (config_.exploring_views == 0 && isSeenByAnother(frame));
  if (was_searched || !is_settled) return;
  state.patrol.look(trackingTools(frame, hypotheses_.front()), frame, camera,
                    result->map_from_base->pose, result);
}

void Localizer::Impl::learnBlur(const Frame& frame, const MountedCamera& camera,
                                FrameResult* result) {
  const std::vector<std::size_t> entries = acceptedEntries(*result);
  if (!result->map_from_base || entries.empty()) return;
  BlurFilter& filter = stateOf(frame).knowledge.blur;
  MountedCamera blurred = camera;
  constexpr int kRounds = 3;
  for (int round = 0; round < kRounds; ++round) {
    const auto aligned =
        alignWithPixels(trackingTools(frame, hypotheses_.front()), frame.image, blurred, entries,
                        result->map_from_base->pose, PosePrior::about(*result->map_from_base));
    if (!aligned) return;
    const ImageBlur blur = filter.after(aligned->blur, blurred.blur());
    if (round == kRounds - 1) filter.take(aligned->blur, blurred.blur());
    blurred = camera.withBlur(blur);
  }
  result->blur = filter.blur();
}

double Localizer::Impl::blurToRead(CameraState* state) {
  ImageKnowledge& knowledge = state->knowledge;
  knowledge.lost_images = knowledge.was_tracked ? 0 : knowledge.lost_images + 1;
  // While lost, nothing shows how blurred the images are; every second image is tried with this
  // blur.
  constexpr double kSupposed = 1.6;  // pixels
  const double known = knowledge.blur.blur().largestDeviation();
  const bool is_tried = knowledge.lost_images > 0 && knowledge.lost_images % 2 == 0;
  return is_tried ? std::max(kSupposed, known) : known;
}

void Localizer::Impl::measure(const MountedCamera& camera, FrameResult* result) {
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

bool Localizer::Impl::isDue(const MarkerDetection& rejected, double stamp) {
  if (entriesOf(map_, rejected.family, rejected.id).empty()) return false;
  const auto [last, is_first] = measured_.try_emplace({rejected.family, rejected.id}, stamp);
  if (!is_first && stamp < last->second + kMeasuringPeriod) return false;
  last->second = stamp;
  return true;
}

Localizer::Localizer(std::vector<LocalizerCamera> cameras, MarkerMap map,
                     const LocalizerConfig& config)
    : impl_(std::make_unique<Impl>(std::move(cameras), std::move(map), config)) {}

Localizer::Localizer(std::shared_ptr<const CameraModel> camera, MarkerMap map,
                     const LocalizerConfig& config)
    : Localizer(std::vector<LocalizerCamera>{{std::move(camera)}}, std::move(map), config) {}

Localizer::~Localizer() = default;

void Localizer::setPose(const PoseEstimate& map_from_base,
                        const std::optional<Pose>& odom_from_base) {
  impl_->setPose(map_from_base, odom_from_base);
}

void Localizer::setPose(const Pose& map_from_base, const std::optional<Pose>& odom_from_base) {
  impl_->setPose(map_from_base, odom_from_base);
}

void Localizer::forgetPose() { impl_->forgetPose(); }

void Localizer::setMap(MarkerMap map) { impl_->setMap(std::move(map)); }

void Localizer::continueFrom(const Localizer& before) { impl_->continueFrom(*before.impl_); }

void Localizer::seek(const std::vector<Marker>& markers) { impl_->seek(markers); }

FrameResult Localizer::process(const Frame& frame) { return impl_->process(frame); }

const MarkerMap& Localizer::map() const { return impl_->map(); }

const CameraModel& Localizer::camera(std::size_t index) const { return impl_->camera(index); }

}  // namespace omnitag
