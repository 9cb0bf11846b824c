#pragma once

#include <cv_bridge/cv_bridge.h>
#include <tf2/buffer_core.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "adjustment/map_refinement.h"
#include "localization/advice.h"
#include "omnitag/localization/localizer.h"
#include "ros/camera_info.h"
#include "ros/frame_assembler.h"
#include "ros/localizer_settings.h"
#include "ros/parameters.h"
#include "ros/stamp_timeline.h"

namespace omnitag {

/// What the result of an image should hold in addition to its pose; see Frame.
struct WantedExtras {
  bool views = false;
  bool measured = false;
};

/// An image and its result.
struct LocalizedImage {
  /// Name of the camera, as in CameraParameters.
  std::string camera_name;
  AssembledFrame input;
  FrameResult result;
  /// s: how far stamps went back before this image, so that the localizer started afresh; 0 if they
  /// did not.
  double went_back = 0.0;
  /// s: how far the clock was set before this image, negative if set back; the pose was kept.
  double clock_step = 0.0;
  /// Whether the image is newer than all before; with several cameras, another's may have overtaken
  /// it or have the same stamp.
  bool is_newest = true;
  /// Whether this image changed the map: markers were added, or are known better.
  bool map_changed = false;
};

/// Localizes the robot in a stream of images from a topic or a bag: the same images and transforms
/// give the same poses. Not safe to use from two threads at once.
class ImageLocalizer {
 public:
  /// Loads the map. `cameras`: those of the parameters, in their order. Throws InputError if the
  /// map or a parameter is wrong.
  ImageLocalizer(const LocalizerParameters& parameters,
                 const std::vector<DescribedCamera>& cameras);

  /// To be used before the camera is known: throws what the constructor throws about the map file.
  /// Does not check `ignore_markers`.
  static void checkMap(const LocalizerParameters& parameters);

  /// Nothing for an image that is not newer than the camera's previous one, or more than
  /// Localizer::kMaxOvertaken older than another camera's; it is counted as late. `camera`: its
  /// index. If FrameAssembler throws, its exception passes through and the state is kept.
  ///
  /// If stamps alone step back by more than `restart_time_jump`, as when a bag loops, the localizer
  /// starts afresh: at the initial pose of the parameters, or searching. Mapped markers stay.
  std::optional<LocalizedImage> localize(const cv_bridge::CvImageConstPtr& image,
                                         const tf2::BufferCore& transforms,
                                         const WantedExtras& wanted = {}, std::size_t camera = 0);

  /// The clock that presumably stamps the images was set by this many s. The pose is kept if the
  /// stamps follow.
  void clockStepped(double seconds) { timeline_.clockStepped(seconds); }

  /// Stores a request, e.g. to set or forget the pose, in place of an earlier one that has not run.
  /// It runs before the next image is localized, but after a fresh start that this image may cause.
  void beforeNextImage(std::function<void(Localizer*)> request) { request_ = std::move(request); }

  /// Continues with another localizer, made from another map or other settings. Not to be called
  /// while an image is processed.
  void exchange(Successor successor);

  /// The map file's markers except ignored ones, where they are known to hang, followed by those
  /// that mapping has added.
  const MarkerMap& map() const;
  const std::vector<Marker>& ignoredMarkers() const { return ignored_markers_; }
  /// Whether images may change the map.
  bool learnsMap() const { return mapper_ || refinement_; }
  /// What mapping knows of markers that the map file does not have.
  std::vector<ProvisionalMarker> provisional() const;
  /// The map file's markers that images have shown to hang elsewhere.
  std::vector<RefinedMarker> refined() const;
  const CameraModels& cameras() const { return cameras_; }
  const FrameAssembler& assembler(std::size_t camera) const { return assemblers_[camera]; }
  /// The frames, with the map's filled in.
  const FrameNames& frames() const { return parameters_.frames; }
  std::uint64_t lateImages() const { return late_images_; }

 private:
  void start();
  /// Where an image belongs on the timeline; nothing if it comes too late.
  std::optional<StampPlace> placeOf(const ros::Time& stamp, std::size_t camera) const;
  void ignore();
  bool isIgnored(const std::string& family, int id) const;
  void nameIgnored(FrameResult* result) const;
  void learnMap(LocalizedImage* localized);
  /// Without what mapping has added.
  const MarkerMap& ownMap() const;

  LocalizerParameters parameters_;
  CameraModels cameras_;
  MarkerMap map_;
  std::vector<MarkerSelection> ignored_;
  std::vector<Marker> ignored_markers_;
  /// These are by camera.
  std::vector<FrameAssembler> assemblers_;
  std::vector<Advisor> advisors_;
  std::vector<double> last_times_;
  std::optional<MapRefinement> refinement_;
  std::optional<MarkerMapper> mapper_;
  std::unique_ptr<Localizer> localizer_;
  std::function<void(Localizer*)> request_;
  StampTimeline timeline_;
  std::uint64_t late_images_ = 0;
};

}  // namespace omnitag
