#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "adjustment/marker_projection.h"
#include "camera/mounted_camera.h"
#include "marker/tag_pattern.h"
#include "omnitag/common/pose.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// A marker's corners in the panorama, and their covariance in pixels^2.
struct AlignedCorners {
  CornerPixels pixels;
  Eigen::Matrix<double, 8, 8> covariance;
};

/// Locates a marker's corners by all of its pixels, several times more exactly than decoding does.
/// The pattern is projected from a pose and the marker's place, known to about half a pixel. Its
/// corners are moved, and everything between them in proportion, until it explains the panorama's
/// grey levels (CV_8UC1) under any light. Least squares (Gauss-Newton) with robust weights. The
/// covariance is the inverse of the pixels' information, at the noise estimated from their
/// residuals, plus errors that the residuals do not show: of the pose, and from shadows.
///
/// Nothing if too little of the pattern is in the image, its contrast is too low, or it does
/// not fit.
std::optional<AlignedCorners> alignCorners(const cv::Mat& panorama, const Marker& marker,
                                           const TagPattern& pattern, const MountedCamera& camera,
                                           const Pose& map_from_base);

}  // namespace omnitag
