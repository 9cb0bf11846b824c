#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "marker/tag_detector.h"
#include "omnitag/marker/marker_map.h"
#include "omnitag/marker/marker_reading.h"
#include "omnitag/view/view.h"
#include "view/view_warper.h"

namespace omnitag {

/// Mean length of a quadrilateral's edges.
double meanEdge(const Corners<Eigen::Vector2d>& corners);

/// A tag found in a view, in pixels of the panorama, without the view's index; nothing if the
/// panorama does not show the world at one of its corners.
std::optional<MarkerReading> inPanorama(const TagDetection& tag, const View& view,
                                        const ViewWarper& warper);

/// Reads markers in views and takes the readings back to the panorama. Not safe to use from two
/// threads at once.
class MarkerReader {
 public:
  /// `working_distance`: m, as in ViewWarper. `threads`: how many share the reading of several
  /// views. Throws InputError for an unknown family.
  MarkerReader(std::shared_ptr<const CameraModel> camera, double working_distance,
               const TagDetectorConfig& config, const MarkerFamilies& families, int threads = 1);

  /// The markers in one view's image. A marker is left out if the view cuts it, or if it reaches
  /// beyond what the panorama shows of the world.
  std::vector<MarkerReading> read(const cv::Mat& view_image, const View& view) const;

  /// The markers of several views, one view after the other. `view_images`: the views'
  /// images, CV_8UC1.
  std::vector<MarkerReading> read(const std::vector<cv::Mat>& view_images,
                                  const std::vector<View>& views) const;

  const ViewWarper& warper() const { return warper_; }
  const TagDetector& detector() const { return detectors_.front(); }

 private:
  std::vector<MarkerReading> read(const cv::Mat& view_image, const View& view,
                                  const TagDetector& detector) const;

  ViewWarper warper_;
  /// One for each thread.
  std::vector<TagDetector> detectors_;
};

/// Whether two readings are of one marker that two views show: the same family and id, at nearly
/// the same place in the panorama.
bool areOfOneMarker(const MarkerReading& a, const MarkerReading& b);

/// Readings of overlapping views without repetitions: if a marker was read twice, the reading
/// nearer to the middle of its view is kept.
std::vector<MarkerReading> withoutRepetitions(const std::vector<MarkerReading>& readings,
                                              const std::vector<View>& views,
                                              const ViewWarper& warper);

}  // namespace omnitag
