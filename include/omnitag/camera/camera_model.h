#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "omnitag/camera/camera_uncertainty.h"
#include "omnitag/camera/image_plane.h"
#include "omnitag/camera/image_size.h"

namespace omnitag {

/// A line of sight in the camera's optical frame, in metres: every point that images at its pixel
/// is origin + s * direction, s > 0. The direction has length 1. A camera without a single
/// viewpoint has a different origin for every ray.
struct Ray {
  Eigen::Vector3d origin;
  Eigen::Vector3d direction;
};

/// A line of sight within its half-plane through the optical axis. Both vectors are (distance from
/// the axis, height along the axis), in metres; the direction has length 1.
struct MeridionalRay {
  Eigen::Vector2d origin;
  Eigen::Vector2d direction;

  /// Height along the axis at which the ray is `distance` metres away from the axis.
  double heightAt(double distance) const {
    return origin.y() + (distance - origin.x()) * direction.y() / direction.x();
  }
};

/// Radius in the ideal image plane at which a point images, and its derivatives with respect to the
/// point's distance from the axis and its height along the axis, per metre.
struct RadialImage {
  double radius;
  double radius_by_distance;
  double radius_by_height;
};

/// A camera whose optics are radially symmetric about the optical axis: a mirror of any profile, a
/// fisheye, and any other camera whose projection preserves the azimuth exactly.
///
/// The optical frame has its origin at the lens's pinhole, z along the optical axis out of the
/// lens, x toward increasing u and y toward increasing v. A model describes one half-plane through
/// the axis (`imageFromPoint`, `rayFromRadius`: the paper's E and its inverse); this class extends
/// it to three dimensions, and the ImagePlane to pixels.
///
/// Immutable once it is shared, and therefore safe to share between threads.
class CameraModel {
 public:
  virtual ~CameraModel() = default;

  /// The pixel of a point of the optical frame (metres) and, on request, its derivative with
  /// respect to the point (pixels per metre). Nothing if the camera does not see the point because
  /// it lies beyond the optics' field, in the camera's own blind spot, or off the image.
  std::optional<Eigen::Vector2d> pixelFromPoint(
      const Eigen::Vector3d& point, Eigen::Matrix<double, 2, 3>* jacobian = nullptr) const;

  /// The same, even if the pixel lies off the image: for a camera whose parameters are still to
  /// be found.
  std::optional<Eigen::Vector2d> pixelBeyondImage(
      const Eigen::Vector3d& point, Eigen::Matrix<double, 2, 3>* jacobian = nullptr) const;

  /// The line of sight of a pixel. Nothing if the pixel is off the image or does not show the world
  /// through the optics, e.g. beyond the mirror's rim.
  std::optional<Ray> rayFromPixel(const Eigen::Vector2d& pixel) const;

  /// The same from a table over the radius, several times faster. Off by less than a thousandth of
  /// a pixel where the rays' directions change evenly from pixel to pixel; the direction's length
  /// is nearly 1.
  std::optional<Ray> tabulatedRayFromPixel(const Eigen::Vector2d& pixel) const;

  /// Image of a point at `distance` >= 0 from the axis and at `height` along it, in metres (the
  /// paper's E, Eqns 5 and 7-14). Nothing if the optics do not show the point.
  virtual std::optional<RadialImage> imageFromPoint(double distance, double height) const = 0;

  /// Line of sight of a radius of the ideal image plane. Nothing outside
  /// [minRadius(), maxRadius()].
  virtual std::optional<MeridionalRay> rayFromRadius(double radius) const = 0;

  /// The ring of the ideal image plane that shows the world.
  virtual double minRadius() const = 0;
  virtual double maxRadius() const = 0;

  /// Pixels, radius of the field in the image.
  double rimPixels() const { return image_plane_.scale() * maxRadius(); }

  /// How far the model may be off; by default, it is exact.
  const CameraUncertainty& uncertainty() const { return uncertainty_; }
  void setUncertainty(const CameraUncertainty& uncertainty) { uncertainty_ = uncertainty; }

  /// Displacement of the image at a pixel (pixels) by each mode of the uncertainty, off by a
  /// standard deviation.
  Eigen::Matrix<double, 2, kCameraModes> displacementByError(const Eigen::Vector2d& pixel) const;

  /// Whether images may also be larger or smaller than the camera's by an integer factor.
  bool scalesToImage() const { return scales_to_image_; }
  void setScalesToImage(bool scales) { scales_to_image_ = scales; }

  /// The camera for images of another size. Unchanged if the size is the camera's own, or if it
  /// must not scale. Scaled, with its deviations, if both sides are an integer multiple or fraction
  /// of the camera's, cut off by less than a pixel. Nothing for any other size.
  std::shared_ptr<const CameraModel> ofImage(const ImageSize& size) const;

  const ImageSize& imageSize() const { return image_size_; }
  const ImagePlane& imagePlane() const { return image_plane_; }

  /// Whether a pixel position lies on the image, whose pixels reach half a pixel around their
  /// centres.
  bool isInImage(const Eigen::Vector2d& pixel) const;

 protected:
  CameraModel(const ImageSize& image_size, const ImagePlane& image_plane)
      : image_size_(image_size), image_plane_(image_plane) {}
  CameraModel(const CameraModel&) = default;
  CameraModel& operator=(const CameraModel&) = default;

  /// A copy of the whole model.
  virtual std::shared_ptr<CameraModel> copy() const = 0;

  /// To be called at the end of every model's constructor.
  void tabulateRays();

 private:
  std::optional<Eigen::Vector2d> idealFromPixel(const Eigen::Vector2d& pixel) const;

  ImageSize image_size_;
  ImagePlane image_plane_;
  CameraUncertainty uncertainty_;
  bool scales_to_image_ = false;
  /// In equal steps from minRadius() to maxRadius().
  std::vector<MeridionalRay> rays_;
  double radius_step_ = 1.0;
};

/// Cameras of one robot; images name theirs by its index.
using CameraModels = std::vector<std::shared_ptr<const CameraModel>>;

}  // namespace omnitag
