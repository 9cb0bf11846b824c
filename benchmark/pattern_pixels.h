#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "camera/mounted_camera.h"
#include "marker/tag_pattern.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// A pixel of the panorama that shows nothing but a marker's drawing.
struct PatternPixel {
  /// Share of the pixel that is white, and its derivative by what is unknown in a frame: by the
  /// pose, per metre and per radian; by the imaging error, per standard deviation.
  double white = 0.0;
  FrameVector white_by_frame = FrameVector::Zero();
  /// From the marker's middle in the image to the pixel; the drawing reaches from -1 to 1.
  Eigen::Vector2d offset = Eigen::Vector2d::Zero();
  /// As the image has it.
  double grey = 0.0;
  /// What a renderer takes for the share of white that averages over a grid of points.
  double sampled_white = 0.0;

  /// Whether no edge runs through it.
  bool isEven() const { return white_by_frame.isZero(); }
};

/// The pixels of a marker's drawing as the exact projection of its modules has them, the image
/// being averaged over square pixels. The derivative is that of the white area: what the outlines
/// of the modules sweep as the projections of their points move. None where the camera does not see
/// all of the drawing. `image`: CV_8UC1; `samples`: points across a pixel of which its renderer
/// takes the mean.
std::vector<PatternPixel> patternPixels(const cv::Mat& image, const MountedCamera& camera,
                                        const Pose& map_from_base, const Marker& marker,
                                        const TagPattern& pattern, int samples);

}  // namespace omnitag
