#pragma once

#include <limits>

#include "camera/increasing_function.h"
#include "omnitag/camera/camera_model.h"

namespace omnitag {

/// What a central camera sees: everything up to an angle off the optical axis.
struct CentralField {
  /// rad off the axis, and the radius of the ideal image plane at which this angle images.
  double max_angle = 0.0;
  double max_radius = 0.0;
  /// Whether the middle of the image looks back at the camera, as through a mirror, instead of out
  /// of the lens: angles are then counted from the axis's other end, -z.
  bool through_mirror = false;
};

/// What limits a central camera's field in addition to its model.
struct FieldLimits {
  /// rad off the axis. If not given, as far as the model grows. The field never reaches beyond the
  /// image's farthest corner.
  std::optional<double> max_angle;
  bool through_mirror = false;
};

/// A camera with a single viewpoint, the origin of its optical frame: a point's radius depends only
/// on the angle of its direction off the optical axis, and grows with it. Angles of more than 90
/// degrees, of rays that point backwards, are nothing special.
///
/// Valid domain: points other than the viewpoint itself, up to `maxAngle()`.
class CentralCamera : public CameraModel {
 public:
  /// rad. No field reaches farther: directly behind, a point would image along a whole circle.
  static constexpr double kLargestAngle = 3.12;

  std::optional<RadialImage> imageFromPoint(double distance, double height) const final;
  std::optional<MeridionalRay> rayFromRadius(double radius) const final;
  double minRadius() const final { return 0.0; }
  double maxRadius() const final { return field_.max_radius; }

  /// rad off the axis; see CentralField for which end of it.
  double maxAngle() const { return field_.max_angle; }
  bool throughMirror() const { return field_.through_mirror; }

 protected:
  CentralCamera(const ImageSize& image_size, const ImagePlane& image_plane,
                const CentralField& field)
      : CameraModel(image_size, image_plane), field_(field) {}

  /// The radius of the ideal image plane that no pixel exceeds: at the image's farthest corner, or
  /// where the plane's distortion folds if that comes first.
  static double radiusOfImage(const ImageSize& image_size, const ImagePlane& image_plane);

 private:
  /// Radius of the ideal image plane (and its derivative) at an angle in [0, maxAngle()].
  virtual ValueAndSlope radiusAt(double angle) const = 0;
  /// Angle at a radius in [0, maxRadius()].
  virtual double angleAt(double radius) const = 0;

  CentralField field_;
};

}  // namespace omnitag
