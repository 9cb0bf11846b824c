#pragma once

#include <limits>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "marker/glance_sectors.h"
#include "marker/marker_reader.h"
#include "marker/tag_detector.h"
#include "omnitag/camera/camera_model.h"
#include "omnitag/view/view.h"
#include "view/view_warper.h"

namespace omnitag {

/// Whether the camera's images are mirrored: writing in them runs backwards.
bool isMirrored(const CameraModel& camera);

/// What a glance should find; by default every marker that it can.
struct GlanceAim {
  /// Where the whole marker must be.
  Annulus where = {};
  Sector toward = {};
  /// At most this many readings, those of the largest markers.
  std::size_t at_most = std::numeric_limits<std::size_t>::max();
  /// Whether the first glance is only for markers whose contrast stands out from their
  /// surroundings, which takes a fifth to two fifths less time.
  bool starts_with_the_obvious = false;
};

/// The result of a glance at a panorama. Each reading has its own view.
struct Glance {
  std::vector<MarkerReading> readings;
  std::vector<View> views;
  std::vector<cv::Mat> view_images;
};

/// Reads markers in the panorama itself, at first reduced, without undistorted views: several times
/// faster than looking all around, and enough for markers that are neither small nor seen very
/// obliquely. Their corners are then located again in a view of each marker, since the panorama
/// bends their edges. Not safe to use from two threads at once.
class GlanceReader {
 public:
  /// `config`: the settings of the last glance. The families are those of `detector`. `threads`:
  /// how many locate corners at the same time.
  GlanceReader(std::shared_ptr<const CameraModel> camera, const TagDetectorConfig& config,
               const TagDetector& detector, int threads = 1);

  /// The number of glances. Each has about twice the resolution of the one before, and the last has
  /// that of the detector's settings.
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
