#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "marker/tag_detector.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// Finds dark squares on brighter ground, whatever is in them, with the AprilTag library. Not safe
/// to use from two threads at once.
class SquareFinder {
 public:
  explicit SquareFinder(const TagDetectorConfig& config);
  ~SquareFinder();
  SquareFinder(SquareFinder&& other) noexcept;
  SquareFinder& operator=(SquareFinder&& other) noexcept;

  /// The corners of the squares in an image (CV_8UC1), to about a pixel of the reduced image,
  /// counter-clockwise from any of them for a person who looks at the square. `min_contrast`: grey
  /// levels, as for TagDetector::detect().
  std::vector<Corners<Eigen::Vector2d>> find(const cv::Mat& image, int min_contrast) const;

 private:
  struct Library;
  std::unique_ptr<Library> library_;
};

}  // namespace omnitag
