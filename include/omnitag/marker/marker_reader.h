#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "omnitag/marker/marker_map.h"
#include "omnitag/marker/tag_detector.h"
#include "omnitag/view/view.h"
#include "omnitag/view/view_warper.h"

namespace omnitag {

/// A marker that was read, in pixels of the panoramic image.
struct MarkerReading {
  std::string family;
  int id = 0;
  /// Bits that had to be corrected.
  int hamming = 0;
  Corners<Eigen::Vector2d> corners;
  Eigen::Vector2d center;
  /// Index of the view in which it was read.
  std::size_t view = 0;
  /// Grey levels by which its modules are on their side of black and white, on average.
  double margin = 0.0;
};

/// Mean length of a quadrilateral's edges.
double meanEdge(const Corners<Eigen::Vector2d>& corners);

/// A tag that a view shows, in the panorama, without the view's index; nothing where a corner is
/// off the world that the panorama shows.
std::optional<MarkerReading> inPanorama(const TagDetection& tag, const View& view,
                                        const ViewWarper& warper);

/// Reads markers in views and takes what it read back to the panorama. Not safe to use from two
/// threads at once.
class MarkerReader {
 public:
  /// `working_distance`: m, as in ViewWarper. `threads`: how many read several views. Throws
  /// InputError for a family that the AprilTag library does not have.
  MarkerReader(std::shared_ptr<const CameraModel> camera, double working_distance,
               const TagDetectorConfig& config, const std::set<std::string>& families,
               int threads = 1);

  /// The markers of one view's image. One that the view cuts, or that reaches off the world that
  /// the panorama shows, is left out.
  std::vector<MarkerReading> read(const cv::Mat& view_image, const View& view) const;

  /// Those of several views, one after the other. `view_images`: the views', CV_8UC1.
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

/// Whether two readings are of one marker that two views show: the same family and id, nearly at
/// the same place of the panorama.
bool areOfOneMarker(const MarkerReading& a, const MarkerReading& b);

/// Readings of overlapping views without repetitions: of the same marker read twice, the one that
/// is nearer to the middle of its view stays.
std::vector<MarkerReading> withoutRepetitions(const std::vector<MarkerReading>& readings,
                                              const std::vector<View>& views,
                                              const ViewWarper& warper);

}  // namespace omnitag
