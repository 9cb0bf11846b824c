#pragma once

#include <limits>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "omnitag/camera/image_plane.h"
#include "omnitag/common/angle.h"

namespace omnitag {

/// What images at these radii of the ideal image plane.
struct Annulus {
  double min_radius = 0.0;
  double max_radius = std::numeric_limits<double>::infinity();
};

/// What images in these directions from the centre of the ideal image plane.
struct Sector {
  /// rad, of its middle and from there to either side.
  double azimuth = 0.0;
  double half_width = kPi;
};

/// Where a glance at a panorama (CV_8UC1) looks one after another: quarters of the annulus, or all
/// of it at once where it reaches the axis. Neighbours overlap by an angle (rad). Those come first
/// that change the most between light and dark, as they do where markers are.
std::vector<Sector> sectorsToGlanceAt(const cv::Mat& panorama, const Annulus& annulus,
                                      const ImagePlane& plane, double overlap);

}  // namespace omnitag
