#pragma once

#include <Eigen/Core>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "marker/marker_families.h"
#include "omnitag/marker/marker_map.h"
#include "omnitag/marker/tag_detector_config.h"

namespace omnitag {

/// A marker read in a view. Positions are pixels of that view, the centre of its top-left pixel at
/// (0, 0).
struct TagDetection {
  std::string family;
  int id = 0;
  int hamming = 0;
  /// Grey levels; of a picture, the standard deviation within its border.
  double decision_margin = 0.0;
  /// Between two corners; of a picture, as if its border were one module wide.
  int modules_per_edge = 0;
  Corners<Eigen::Vector2d> corners;
  Eigen::Vector2d center;
};

/// Where the diagonals of a quadrilateral meet.
Eigen::Vector2d centerOf(const Corners<Eigen::Vector2d>& corners);

/// Finds AprilTags, ArUco markers and pictures in grey images. Not safe to use from two threads at
/// once: give each thread its own.
class TagDetector {
 public:
  /// Throws InputError for an unknown family.
  TagDetector(const TagDetectorConfig& config, const MarkerFamilies& families);
  /// With the families of another detector, whose decoding tables (many megabytes) the two share.
  /// `max_hamming` remains the other detector's.
  TagDetector(const TagDetectorConfig& config, const TagDetector& other);
  ~TagDetector();
  TagDetector(TagDetector&& other) noexcept;
  TagDetector& operator=(TagDetector&& other) noexcept;

  /// The tags in an image (CV_8UC1, at most 32767 pixels a side), ordered by id, and then the
  /// pictures. None in an image of less than 8 pixels a side, times `quad_decimate`. Rows may be
  /// padded. `min_contrast`: grey levels between white and black, if more than the settings
  /// require. Throws std::invalid_argument for other images.
  std::vector<TagDetection> detect(const cv::Mat& image, int min_contrast = 0) const;

 private:
  struct Library;
  std::unique_ptr<Library> library_;
};

}  // namespace omnitag
