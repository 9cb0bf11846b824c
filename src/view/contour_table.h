#pragma once

#include <limits>
#include <vector>

#include "omnitag/camera/camera_model.h"

namespace omnitag {

/// The paper's look-up tables E, F and F^-1 (Section 5, Eqns 3-5), computed once per camera: where
/// points and horizontal lines of the world image.
///
/// A line across the optical axis ("horizontal" if the axis is vertical) is given by its nearest
/// point to the axis, which images at radius_main in the direction theta_main. A point of the line
/// that lies azimuth_offset away from that direction images at `radius` (R_main, d theta, R_i in
/// the paper). Without a single viewpoint, contours depend slightly on the distance of the line;
/// the table's are for lines at `distance`. doc/camera_models.md gives the error.
///
/// All radii are of the ideal image plane, all angles in radians, all lengths in metres. Immutable,
/// and self-contained once built.
class ContourTable {
 public:
  /// The contours reach this far to both sides of theta_main.
  static constexpr double kMaxAzimuthOffset = 1.05;

  ContourTable(const CameraModel& camera, double distance);

  /// E: radius of the image of a point that is `distance` away from the axis, at `height` along it.
  /// NaN if the camera does not see the point.
  double imageRadius(double distance, double height) const;

  /// The inverse of E at a given distance: the height of the point that images at `radius`. Radii
  /// beyond the camera's field give the height at the field's edge.
  double height(double radius, double distance) const;

  /// F^-1: R_i over R_main and d theta. NaN if the camera sees no such point.
  double radius(double radius_main, double azimuth_offset) const;

  /// F: R_main over R_i and d theta. NaN if the camera does not see the line's nearest point.
  double radiusMain(double radius, double azimuth_offset) const;

  double distance() const { return distance_; }

  /// A radius R_main as a position between two columns of the table; index -1 if it is off
  /// the table.
  struct Place {
    int index = -1;
    float fraction = 0.0F;
  };
  Place placeOf(double radius_main) const;

  /// F^-1 at one azimuth offset as a function of R_main, for use with many radii.
  class Contours {
   public:
    /// NaN if the camera sees no such point.
    float radius(const Place& radius_main) const {
      const auto i = radius_main.index;
      if (nearer_ == nullptr || i < 0) return std::numeric_limits<float>::quiet_NaN();
      const auto blend = [&radius_main, i](const float* radii) {
        return radii[i] + radius_main.fraction * (radii[i + 1] - radii[i]);
      };
      const float near = blend(nearer_);
      return near + fraction_ * (blend(farther_) - near);
    }

   private:
    friend class ContourTable;
    const float* nearer_ = nullptr;
    const float* farther_ = nullptr;
    float fraction_ = 0.0F;
  };
  /// Valid as long as the table lives.
  Contours contours(double azimuth_offset) const;

 private:
  double positionOf(double radius) const;

  double distance_;
  double min_radius_;
  double max_radius_;
  double radius_step_;
  /// The lines of sight of evenly spaced radii, and whether height grows with the radius.
  std::vector<MeridionalRay> rays_;
  bool height_grows_;
  /// R_i by azimuth offset, then by R_main.
  std::vector<float> radii_;
};

}  // namespace omnitag
