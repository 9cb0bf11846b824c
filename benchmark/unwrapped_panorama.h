#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "camera/mounted_camera.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// How many rows an unwrapped panorama has.
enum class RowSpacing {
  kSquare,   ///< as far apart as its columns
  kDensest,  ///< a pixel of the panorama where it resolves best along the radius
};

/// A panorama unwrapped onto an upright cylinder about the optical axis, as high as the map's
/// markers reach from 0.8 m away. Its columns resolve what the panorama resolves along the tangent
/// at its best, the outermost radius that the cylinder shows; 20 degrees are there twice, so that
/// no marker is cut. What is up and right for a person in the room is so in it.
class UnwrappedPanorama {
 public:
  /// Computes the tables for cv::remap; `distance` in metres is the cylinder's radius. Throws
  /// InputError where the camera does not see the markers' heights.
  UnwrappedPanorama(const MountedCamera& camera, const MarkerMap& map, double distance,
                    RowSpacing spacing);

  /// The cylinder, by an interpolation of OpenCV's.
  void unwrap(const cv::Mat& panorama, int interpolation, cv::Mat* cylinder) const;

  cv::Size size() const { return whole_.size(); }

  /// The panorama's pixel at a pixel of the cylinder.
  Eigen::Vector2d panoramaPixel(const Eigen::Vector2d& pixel) const;

 private:
  double radiusAt(double row) const;

  ImagePlane image_plane_;
  /// Radii of the ideal image plane, of each row.
  Eigen::VectorXd radii_;
  /// rad, from column to column.
  double azimuth_step_;
  /// The tables in cv::remap's fastest form: whole pixels, and 1/32 of pixels.
  cv::Mat whole_;
  cv::Mat fraction_;
};

}  // namespace omnitag
