#pragma once

#include <optional>
#include <vector>

#include "omnitag/camera/camera_model.h"

namespace omnitag {

/// The paper's look-up table: the image contours of horizontal lines.
///
/// A line across the optical axis is given by its nearest point to the axis, which images at
/// radius_main (at the azimuth theta_main); a point of it that lies azimuth_offset away images at
/// `radius` (the paper's R_main, d theta and R_i, Section 5, Eqns 3-5). A camera without a single
/// viewpoint has another contour for every distance of the line, so the table is computed for one
/// working distance; doc/camera_models.md gives the error at others.
///
/// All radii are of the ideal image plane. Immutable once built.
class ContourTable {
 public:
  /// The nearest point of the lines is `distance` metres from the axis. The table reaches
  /// max_azimuth_offset (rad, < pi / 2) to both sides.
  ContourTable(const CameraModel& camera, double distance,
               double max_azimuth_offset = kMaxAzimuthOffset);

  /// R_i = F^-1(R_main, d theta) of Eqn 4, interpolated bilinearly; NaN where the camera does not
  /// see that point or the table does not reach.
  double radius(double radius_main, double azimuth_offset) const;

  /// R_main = F(R_i, d theta) of Eqn 3, exactly; nothing where the camera does not see the line's
  /// nearest point.
  std::optional<double> radiusMain(double radius, double azimuth_offset) const;

  double distance() const { return distance_; }
  double maxAzimuthOffset() const { return max_azimuth_offset_; }

  /// One azimuth offset of the table, for fast access to many radii: radii[k] belongs to
  /// radius_main = first + k * step.
  struct Column {
    std::vector<float> radii;
    double first;
    double step;

    double radius(double radius_main) const;
  };
  Column column(double azimuth_offset) const;

  static constexpr double kMaxAzimuthOffset = 1.05;

 private:
  const CameraModel* camera_;
  double distance_;
};

}  // namespace omnitag
