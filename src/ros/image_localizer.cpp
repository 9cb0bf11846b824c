#include "omnitag/ros/image_localizer.h"

#include "omnitag/common/stopwatch.h"
#include "omnitag/marker/marker_map_file.h"

namespace omnitag {
namespace {

/// None where mapping is off.
std::optional<MarkerMapper> makeMapper(const LocalizerParameters& parameters,
                                       const std::shared_ptr<const CameraModel>& camera,
                                       const MarkerMap& map) {
  if (!parameters.mapping) return std::nullopt;
  try {
    return MarkerMapper(camera, map, parameters.mapper);
  } catch (const InputError& error) {
    throw InputError(parameters.map_file + ": " + error.what());
  }
}

}  // namespace

ImageLocalizer::ImageLocalizer(const LocalizerParameters& parameters, const DescribedCamera& camera)
    : parameters_(parameters),
      camera_(camera.model),
      map_(loadMarkerMap(parameters.map_file)),
      assembler_(camera.origin, camera_->imageSize(), parameters.frames,
                 parameters.localizer.shutter),
      timeline_(parameters.restart_time_jump) {
  if (parameters_.frames.map.empty()) parameters_.frames.map = map_.frame_id;
  mapper_ = makeMapper(parameters_, camera_, map_);
  start();
}

void ImageLocalizer::checkMap(const LocalizerParameters& parameters) {
  // A mapper asks for its camera when an image comes.
  makeMapper(parameters, nullptr, loadMarkerMap(parameters.map_file));
}

void ImageLocalizer::start() {
  localizer_ = std::make_unique<Localizer>(camera_, map(), parameters_.localizer);
  advisor_ = {};
  if (parameters_.initial_pose) localizer_->setPose(*parameters_.initial_pose);
}

std::optional<LocalizedImage> ImageLocalizer::localize(const cv_bridge::CvImageConstPtr& image,
                                                       const tf2::BufferCore& transforms,
                                                       bool wants_views) {
  LocalizedImage localized;
  const ros::Time& stamp = image->header.stamp;
  const StampPlace place = timeline_.place(stamp);
  if (place.kind == StampPlace::Kind::kLate) {
    ++late_images_;
    return std::nullopt;
  }

  localized.input = assembler_.assemble(image, transforms);
  timeline_.take(stamp, place);
  localized.input.frame.stamp = place.time;
  if (place.kind == StampPlace::Kind::kClockStepped) localized.clock_step = place.step;
  if (place.kind == StampPlace::Kind::kWentBack) {
    localized.went_back = -place.step;
    start();
  }
  if (const auto request = std::exchange(request_, nullptr)) request(localizer_.get());
  localized.input.frame.wants_views = wants_views;
  localized.result = localizer_->process(localized.input.frame);
  advisor_.add(localized.result, map(), *camera_);
  localized.result.advice = advisor_.lines();
  if (mapper_) extendMap(&localized);
  return localized;
}

void ImageLocalizer::extendMap(LocalizedImage* localized) {
  Stopwatch step;
  localized->map_changed = mapper_->add(localized->input.frame, localized->result);
  if (localized->map_changed) localizer_->setMap(mapper_->map());
  localizer_->seek(mapper_->unfinished());
  const double duration = step.lap();
  localized->result.timings.solve += duration;
  localized->result.timings.total += duration;
}

std::vector<ProvisionalMarker> ImageLocalizer::provisional() const {
  return mapper_ ? mapper_->provisional() : std::vector<ProvisionalMarker>();
}

void ImageLocalizer::adopt(const std::vector<Marker>& saved) {
  if (!mapper_) return;
  mapper_->adopt(saved);
  localizer_->setMap(mapper_->map());
}

}  // namespace omnitag
