#pragma once

#include <cv_bridge/cv_bridge.h>
#include <tf2/buffer_core.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "omnitag/localization/advice.h"
#include "omnitag/localization/localizer.h"
#include "omnitag/ros/camera_info.h"
#include "omnitag/ros/frame_assembler.h"
#include "omnitag/ros/localizer_settings.h"
#include "omnitag/ros/parameters.h"
#include "omnitag/ros/stamp_timeline.h"

namespace omnitag {

/// What an image's result is to hold beside its pose; see Frame.
struct WantedExtras {
  bool views = false;
  bool measured = false;
};

/// An image and what it gave.
struct LocalizedImage {
  AssembledFrame input;
  FrameResult result;
  /// s by which stamps went back before this image, so that the localizer started afresh; 0: they
  /// did not.
  double went_back = 0.0;
  /// s by which the clock was set before this image, negative for back; the pose was kept.
  double clock_step = 0.0;
  /// Whether the map has changed with this image: markers were added, or moved that mapping had
  /// added.
  bool map_changed = false;
};

/// Localizes in a stream of images, whether they come from a topic or a bag: the same images and
/// transforms give the same poses. Not safe to use from two threads at once.
class ImageLocalizer {
 public:
  /// Loads the map. Throws InputError where that or a parameter is wrong.
  ImageLocalizer(const LocalizerParameters& parameters, const DescribedCamera& camera);

  /// Throws what the constructor throws of the map, before the camera is known.
  static void checkMap(const LocalizerParameters& parameters);

  /// Nothing for an image that is not newer than the one before; it is counted as late. Throws what
  /// FrameAssembler throws, and keeps its state then.
  ///
  /// Where stamps alone step back by more than `restart_time_jump`, as when a bag loops, the
  /// localizer starts afresh: with the initial pose of the parameters, or searching. What it has
  /// mapped stays.
  std::optional<LocalizedImage> localize(const cv_bridge::CvImageConstPtr& image,
                                         const tf2::BufferCore& transforms,
                                         const WantedExtras& wanted = {});

  /// The clock that stamps the images, as far as is known, was set by this (s): the pose is kept
  /// where the stamps follow it.
  void clockStepped(double seconds) { timeline_.clockStepped(seconds); }

  /// Does something to the localizer before the next image is localized, after it has started
  /// afresh where that image makes it: sets a pose, or forgets it. What was asked for before gives
  /// way.
  void beforeNextImage(std::function<void(Localizer*)> request) { request_ = std::move(request); }

  /// Goes on with another localizer, made of another map or of other settings. Not while an image
  /// is worked on.
  void exchange(Successor successor);

  /// The map file's markers but for those that are ignored and, behind them, what mapping has
  /// added.
  const MarkerMap& map() const { return mapper_ ? mapper_->map() : map_; }
  const std::vector<Marker>& ignoredMarkers() const { return ignored_markers_; }
  bool isMapping() const { return mapper_.has_value(); }
  /// What mapping knows of markers that the map file does not have.
  std::vector<ProvisionalMarker> provisional() const;
  const std::shared_ptr<const CameraModel>& camera() const { return camera_; }
  const FrameAssembler& assembler() const { return assembler_; }
  /// With the map's frame filled in.
  const FrameNames& frames() const { return parameters_.frames; }
  std::uint64_t lateImages() const { return late_images_; }

 private:
  void start();
  void ignore();
  bool isIgnored(const std::string& family, int id) const;
  void nameIgnored(FrameResult* result) const;
  void extendMap(LocalizedImage* localized);

  LocalizerParameters parameters_;
  std::shared_ptr<const CameraModel> camera_;
  MarkerMap map_;
  std::vector<MarkerSelection> ignored_;
  std::vector<Marker> ignored_markers_;
  FrameAssembler assembler_;
  std::optional<MarkerMapper> mapper_;
  Advisor advisor_;
  std::unique_ptr<Localizer> localizer_;
  std::function<void(Localizer*)> request_;
  StampTimeline timeline_;
  std::uint64_t late_images_ = 0;
};

}  // namespace omnitag
