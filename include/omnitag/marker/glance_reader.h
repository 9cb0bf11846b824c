#pragma once

#include <limits>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "omnitag/camera/camera_model.h"
#include "omnitag/marker/glance_sectors.h"
#include "omnitag/marker/marker_reader.h"
#include "omnitag/marker/tag_detector.h"
#include "omnitag/view/view.h"
#include "omnitag/view/view_warper.h"

namespace omnitag {

/// Whether an image shows the world as mirrors do: writing in it runs backwards.
bool isMirrored(const CameraModel& camera);

/// What a glance is to find: by default every marker that it can.
struct GlanceAim {
  /// Where all of a marker must be.
  Annulus where = {};
  Sector toward = {};
  /// At most this many of those that were read, the largest.
  std::size_t at_most = std::numeric_limits<std::size_t>::max();
  /// Whether the first glance is only for markers that stand out from the light and dark around
  /// them, which takes a fifth to two fifths less time.
  bool starts_with_the_obvious = false;
};

/// What a glance at a panorama read. Each reading has a view of its own.
struct Glance {
  std::vector<MarkerReading> readings;
  std::vector<View> views;
  std::vector<cv::Mat> view_images;
};

/// Reads markers in the panorama as it is, at first reduced, without the views that show everything
/// undistorted: several times faster than looking all around, and enough for markers that are
/// neither small nor seen much from the side. Their corners are then found again in a view of each,
/// since the panorama bends their edges. Not safe to use from two threads at once.
class GlanceReader {
 public:
  /// `config`: the settings of the last glance. The families are those of `detector`. `threads`:
  /// how many find corners again.
  GlanceReader(std::shared_ptr<const CameraModel> camera, const TagDetectorConfig& config,
               const TagDetector& detector, int threads = 1);

  /// How many glances there are, each at about twice the resolution of the one before, the last
  /// at that of the detector's settings.
  std::size_t count() const { return detectors_.size(); }

  /// `panorama`: CV_8UC1, as large as the camera's image. `glance`: less than count(). `warper`:
  /// the camera's.
  Glance read(const cv::Mat& panorama, std::size_t glance, const ViewWarper& warper, bool axis_up,
              const GlanceAim& aim = {}) const;

 private:
  std::shared_ptr<const CameraModel> camera_;
  bool is_mirrored_;
  int threads_;
  std::vector<TagDetector> detectors_;
};

}  // namespace omnitag
