#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "omnitag/camera/mounted_camera.h"
#include "omnitag/marker/marker_map.h"
#include "omnitag/marker/tag_pattern.h"

namespace omnitag {

/// A pixel of the panorama that shows nothing but a marker's drawing.
struct PatternPixel {
  /// Share of the pixel that is white, and its derivative by the pose (x, y, yaw), per metre and
  /// per radian.
  double white = 0.0;
  Eigen::Vector3d white_by_pose = Eigen::Vector3d::Zero();
  /// From the marker's middle in the image to the pixel; the drawing reaches from -1 to 1.
  Eigen::Vector2d offset = Eigen::Vector2d::Zero();
  /// As the image has it.
  double grey = 0.0;
  /// What a renderer takes for the share of white that averages over a grid of points.
  double sampled_white = 0.0;
};

/// The pixels of a marker's drawing as the exact projection of its modules has them, the image
/// being averaged over square pixels. The derivative is that of the white area: what the outlines
/// of the modules sweep as the projections of their points move, by difference quotients. None
/// where the camera does not see all of the drawing. `image`: CV_8UC1; `samples`: points across a
/// pixel of which its renderer takes the mean.
std::vector<PatternPixel> patternPixels(const cv::Mat& image, const MountedCamera& camera,
                                        const Pose& map_from_base, const Marker& marker,
                                        const TagPattern& pattern, int samples);

/// How the greys of a marker's pixels follow its white: grey = black + contrast * white.
struct Light {
  double black = 0.0;
  double contrast = 0.0;
  /// Of the greys, their noise taken off, with what this formula gives: 0 to 1 or a little more;
  /// low where something hides a part of the marker.
  double correlation = 0.0;
};

/// Least squares; at least three pixels. `noise`: standard deviation in grey levels.
Light fitLight(const std::vector<PatternPixel>& pixels, double noise);

/// Mean square, over the pixels at edges, by which the renderer's share of white is off.
double samplingVariance(const std::vector<PatternPixel>& pixels);

/// What pixels tell about the pose (x, y, yaw), independent normal noise being on each. Black,
/// contrast, and the contrast's slopes across the marker are unknown. The information of several
/// markers adds up.
struct PixelInformation {
  /// Fisher information; its inverse is the Cramer-Rao bound.
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
  /// The matrix times the step from the pose to the most likely one near by.
  Eigen::Vector3d times_step = Eigen::Vector3d::Zero();
};

/// `noise`: standard deviation in grey levels; `edge_variance`: what pixels at edges have besides,
/// of their share of white.
PixelInformation pixelInformation(const std::vector<PatternPixel>& pixels, double contrast,
                                  double noise, double edge_variance);

}  // namespace omnitag
