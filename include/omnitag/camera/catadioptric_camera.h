#pragma once

#include <vector>

#include "omnitag/camera/camera_model.h"
#include "omnitag/camera/mirror_profile.h"

namespace omnitag {

/// A pinhole lens that looks along its axis at a convex mirror of revolution. In general such a
/// camera has no single viewpoint; parabolic and hyperbolic mirrors have one only in special
/// positions (Baker and Nayar).
///
/// The mirror's surface lies at z = apex_distance + sag(rho) of the optical frame. The law of
/// reflection (the paper's Eqns 7-13) is solved for the point of reflection by a safeguarded Newton
/// iteration on rho, which has one solution since the reflected elevation grows along the profile.
///
/// Valid domain: points in front of the mirror that lie within the fan of rays between the blind
/// spot, where the camera sees itself, and the mirror's rim.
class CatadioptricCamera final : public CameraModel {
 public:
  struct Mirror {
    MirrorProfile profile;
    /// m, from the pinhole to the mirror's apex.
    double apex_distance;
    /// m, distance of the mirror's edge from the axis.
    double rim_radius;
    /// m, radius of the disc at the pinhole, across the axis, that the camera's body fills: rays
    /// that would pass through it show the camera itself.
    double housing_radius = 0.0;
  };

  /// Throws InputError where the mirror cannot work: the rim beyond the profile's domain or hidden
  /// from the lens, reflected rays that cross, or a lens distortion that folds within the rim.
  CatadioptricCamera(const ImageSize& image_size, const ImagePlane& image_plane, Mirror mirror);

  std::optional<RadialImage> imageFromPoint(double distance, double height) const override;
  std::optional<MeridionalRay> rayFromRadius(double radius) const override;
  double minRadius() const override { return min_radius_; }
  double maxRadius() const override { return max_radius_; }

  const Mirror& mirror() const { return mirror_; }

 private:
  /// The ray of the lens that meets the mirror at rho, after its reflection. Vectors are
  /// (distance from the axis, height along it).
  struct Reflection {
    double height;
    double slope;
    Eigen::Vector2d ray;
    Eigen::Vector2d ray_by_rho;
  };
  Reflection reflectAt(double rho) const;
  double elevationAt(double rho) const;
  double initialRho(double distance, double height) const;
  void checkRays() const;

  Mirror mirror_;
  double min_rho_;
  double min_radius_ = 0.0;
  double max_radius_ = 0.0;
  Reflection at_rim_{};

  // Starting points for the forward projection: rho over the elevation of the reflected ray.
  std::vector<double> rho_by_elevation_;
  double first_elevation_ = 0.0;
  double elevation_step_ = 0.0;
  double middle_rho_ = 0.0;
  double middle_height_ = 0.0;
};

}  // namespace omnitag
