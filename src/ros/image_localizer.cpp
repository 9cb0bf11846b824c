#include "ros/image_localizer.h"

#include <algorithm>
#include <limits>

#include "common/stopwatch.h"
#include "omnitag/marker/marker_map_file.h"

namespace omnitag {
namespace {

/// None if mapping is off.
std::optional<MarkerMapper> makeMapper(const LocalizerParameters& parameters,
                                       const CameraModels& cameras, const MarkerMap& map) {
  if (!parameters.mapping) return std::nullopt;
  try {
    return MarkerMapper(cameras, map, parameters.mapper);
  } catch (const InputError& error) {
    throw InputError(parameters.map_file + ": " + error.what());
  }
}

}  // namespace

ImageLocalizer::ImageLocalizer(const LocalizerParameters& parameters,
                               const std::vector<DescribedCamera>& cameras)
    : parameters_(parameters),
      map_(loadMarkerMap(parameters.map_file)),
      timeline_(parameters.restart_time_jump) {
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    cameras_.push_back(cameras[i].model);
    assemblers_.emplace_back(cameras[i].origin, cameras[i].model->imageSize(), parameters.frames,
                             parameters.cameras[i].shutter.value_or(parameters.localizer.shutter));
  }
  ignore();
  if (parameters_.frames.map.empty()) parameters_.frames.map = map_.frame_id;
  mapper_ = makeMapper(parameters_, cameras_, map_);
  if (parameters_.refine_map)
    refinement_.emplace(cameras_.size(), map_, parameters_.localizer.motion);
  start();
}

void ImageLocalizer::checkMap(const LocalizerParameters& parameters) {
  // A mapper needs its camera only when an image comes.
  makeMapper(parameters, {}, loadMarkerMap(parameters.map_file));
}

void ImageLocalizer::ignore() {
  try {
    ignored_ = omnitag::ignoredMarkers(parameters_.ignore_markers, map_);
  } catch (const InputError& error) {
    throw InputError("ignore_markers: " + parameters_.map_file + ": " + error.what());
  }
  for (const Marker& marker : map_.markers) {
    const bool is_ignored =
        std::any_of(ignored_.begin(), ignored_.end(),
                    [&marker](const MarkerSelection& each) { return each.matches(marker); });
    if (is_ignored) ignored_markers_.push_back(marker);
  }
  map_ = withoutMarkers(map_, ignored_);
}

void ImageLocalizer::exchange(Successor successor) {
  parameters_.localizer = successor.config;
  for (std::size_t i = 0; i < assemblers_.size(); ++i) {
    if (!parameters_.cameras[i].shutter) assemblers_[i].setShutter(successor.config.shutter);
  }
  if (successor.has_other_map) {
    map_ = std::move(successor.map);
    ignored_ = std::move(successor.ignored);
    ignored_markers_ = std::move(successor.ignored_markers);
    advisors_.assign(cameras_.size(), {});
    if (refinement_) refinement_->setMap(map_);
    if (mapper_) mapper_->setOwn(ownMap());
  }
  if (learnsMap()) successor.localizer->setMap(map());
  successor.localizer->continueFrom(*localizer_);
  localizer_ = std::move(successor.localizer);
}

void ImageLocalizer::start() {
  localizer_ = std::make_unique<Localizer>(localizerCameras(parameters_.cameras, cameras_), map(),
                                           parameters_.localizer);
  advisors_.assign(cameras_.size(), {});
  last_times_.assign(cameras_.size(), -std::numeric_limits<double>::infinity());
  if (parameters_.initial_pose) localizer_->setPose(*parameters_.initial_pose);
}

std::optional<LocalizedImage> ImageLocalizer::localize(const cv_bridge::CvImageConstPtr& image,
                                                       const tf2::BufferCore& transforms,
                                                       const WantedExtras& wanted,
                                                       std::size_t camera) {
  LocalizedImage localized;
  const ros::Time& stamp = image->header.stamp;
  const std::optional<StampPlace> place = placeOf(stamp, camera);
  if (!place) {
    ++late_images_;
    return std::nullopt;
  }

  localized.input = assemblers_[camera].assemble(image, transforms);
  localized.camera_name = parameters_.cameras[camera].name;
  localized.is_newest = place->kind != StampPlace::Kind::kLate;
  if (localized.is_newest) timeline_.take(stamp, *place);
  localized.input.frame.camera = camera;
  localized.input.frame.stamp = place->time;
  if (place->kind == StampPlace::Kind::kClockStepped) localized.clock_step = place->step;
  if (place->kind == StampPlace::Kind::kWentBack) {
    localized.went_back = -place->step;
    start();
  }
  last_times_[camera] = place->time;
  if (const auto request = std::exchange(request_, nullptr)) request(localizer_.get());
  localized.input.frame.wants_views = wanted.views;
  localized.input.frame.wants_measured = wanted.measured;
  localized.result = localizer_->process(localized.input.frame);
  if (!ignored_.empty()) nameIgnored(&localized.result);
  advisors_[camera].add(localized.result, map(), *cameras_[camera]);
  localized.result.advice = advisors_[camera].lines();
  if (learnsMap()) learnMap(&localized);
  return localized;
}

std::optional<StampPlace> ImageLocalizer::placeOf(const ros::Time& stamp,
                                                  std::size_t camera) const {
  if (cameras_.size() > 1) {
    // Another camera's image may have overtaken it, or have the same stamp.
    const std::optional<double> behind = timeline_.behind(stamp);
    const bool is_overtaken = behind && *behind >= 0.0 && *behind < Localizer::kMaxOvertaken;
    const double time = is_overtaken ? timeline_.lastTime() - *behind : 0.0;
    if (is_overtaken && time > last_times_[camera]) {
      return StampPlace{StampPlace::Kind::kLate, time, -*behind};
    }
  }
  const StampPlace place = timeline_.place(stamp);
  return place.kind == StampPlace::Kind::kLate ? std::nullopt : std::optional(place);
}

bool ImageLocalizer::isIgnored(const std::string& family, int id) const {
  return std::any_of(ignored_.begin(), ignored_.end(),
                     [&](const MarkerSelection& each) { return each.matches(family, id); }) ||
         std::any_of(ignored_markers_.begin(), ignored_markers_.end(),
                     [&](const Marker& each) { return each.family == family && each.id == id; });
}

void ImageLocalizer::nameIgnored(FrameResult* result) const {
  for (MarkerDetection& detection : result->detections) {
    const bool is_ignored = !detection.map_entry && isIgnored(detection.family, detection.id) &&
                            entriesOf(map(), detection.family, detection.id).empty();
    if (is_ignored) detection.reason = "ignored";
  }
  auto& explored = result->explored;
  explored.erase(std::remove_if(explored.begin(), explored.end(),
                                [this](const MarkerReading& reading) {
                                  return isIgnored(reading.family, reading.id);
                                }),
                 explored.end());
}

void ImageLocalizer::learnMap(LocalizedImage* localized) {
  Stopwatch step;
  const Frame& frame = localized->input.frame;
  const bool is_refined = refinement_ && refinement_->add(frame, localized->result);
  if (is_refined && mapper_) mapper_->setOwn(ownMap());
  const bool is_extended = mapper_ && mapper_->add(frame, localized->result);
  localized->map_changed = is_refined || is_extended;
  if (localized->map_changed) localizer_->setMap(map());
  if (mapper_) localizer_->seek(mapper_->unfinished());
  const double duration = step.lap();
  localized->result.timings.solve += duration;
  localized->result.timings.total += duration;
}

const MarkerMap& ImageLocalizer::map() const { return mapper_ ? mapper_->map() : ownMap(); }

const MarkerMap& ImageLocalizer::ownMap() const { return refinement_ ? refinement_->map() : map_; }

std::vector<RefinedMarker> ImageLocalizer::refined() const {
  return refinement_ ? refinement_->refined() : std::vector<RefinedMarker>();
}

std::vector<ProvisionalMarker> ImageLocalizer::provisional() const {
  return mapper_ ? mapper_->provisional() : std::vector<ProvisionalMarker>();
}

}  // namespace omnitag
