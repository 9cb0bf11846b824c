#pragma once

#include <limits>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "omnitag/camera/image_plane.h"
#include "omnitag/common/angle.h"

namespace omnitag {

/// The part of an image between these radii of the ideal image plane.
struct Annulus {
  double min_radius = 0.0;
  double max_radius = std::numeric_limits<double>::infinity();
};

/// The part of an image in these directions from the centre of the ideal image plane.
struct Sector {
  /// rad, of its middle, and from there to either side.
  double azimuth = 0.0;
  double half_width = kPi;
};

/// The parts of a panorama (CV_8UC1) to glance at, one after another: quarters of the annulus, or
/// all of it at once if it reaches the axis. Neighbours overlap by an angle (rad). Those with the
/// strongest changes between light and dark, as at markers, come first.
std::vector<Sector> sectorsToGlanceAt(const cv::Mat& panorama, const Annulus& annulus,
                                      const ImagePlane& plane, double overlap);

}  // namespace omnitag
