#pragma once

#include <vector>

#include "camera/mirror_profile.h"
#include "omnitag/camera/camera_model.h"

namespace omnitag {

/// A pinhole lens that looks along its axis at a convex mirror of revolution. In general such a
/// camera has no single viewpoint; parabolic and hyperbolic mirrors have one only in special
/// positions (Baker and Nayar).
///
/// The mirror's surface lies at z = apex_distance + sag(rho) in the optical frame. A
/// safeguarded Newton iteration on rho solves the law of reflection (the paper's Eqns 7-13) for
/// the point of reflection.
///
/// Valid domain: points in front of the mirror within the fan of rays between the blind spot, where
/// the camera sees itself, and the mirror's edge: its rim or, if the mirror curves away from the
/// lens before that, its silhouette. The constructor makes sure that the reflected rays lead away
/// from the axis and that their elevation grows along the visible profile. Therefore no two rays
/// meet, none meets the mirror again, and a point has at most one image.
class CatadioptricCamera final : public CameraModel {
 public:
  struct Mirror {
    MirrorProfile profile;
    /// m, from the pinhole to the mirror's apex.
    double apex_distance;
    /// m, distance of the mirror's edge from the axis.
    double rim_radius;
    /// m, radius of the disc at the pinhole, across the axis, that the camera's body fills: rays
    /// through it would show the camera itself.
    double housing_radius = 0.0;
  };

  /// Throws InputError if the mirror cannot work: a rim beyond the profile's domain or hidden from
  /// the lens, reflected rays that cross, a lens distortion that folds within the rim, or a housing
  /// that fills the view.
  CatadioptricCamera(const ImageSize& image_size, const ImagePlane& image_plane, Mirror mirror);

  std::optional<RadialImage> imageFromPoint(double distance, double height) const override;
  std::optional<MeridionalRay> rayFromRadius(double radius) const override;
  double minRadius() const override { return min_radius_; }
  double maxRadius() const override { return max_radius_; }

  const Mirror& mirror() const { return mirror_; }

 private:
  std::shared_ptr<CameraModel> copy() const override {
    return std::make_shared<CatadioptricCamera>(*this);
  }

  /// The lens's ray that meets the mirror at some rho, after its reflection. Vectors are (distance
  /// from the axis, height along it); the ray's length has no meaning.
  struct Reflection {
    Eigen::Vector2d origin;
    double slope;
    Eigen::Vector2d ray;
    Eigen::Vector2d ray_by_rho;

    /// Cross product of the vector to a point and the ray: zero if the ray hits the point, negative
    /// if the point must be reflected farther out.
    double turnTo(const Eigen::Vector2d& point) const {
      const Eigen::Vector2d way = point - origin;
      return way.x() * ray.y() - way.y() * ray.x();
    }
    double turnToByRho(const Eigen::Vector2d& point) const {
      const Eigen::Vector2d way = point - origin;
      return way.x() * ray_by_rho.y() - way.y() * ray_by_rho.x() - ray.y() + slope * ray.x();
    }
  };

  void findVisibleRim();
  void checkRays() const;
  void tabulateReflections();
  void hideHousing();
  Reflection reflectAt(double rho) const;
  double startingRho(const Eigen::Vector2d& point) const;

  Mirror mirror_;
  double min_radius_ = 0.0;
  double max_radius_ = 0.0;
  /// The visible part of the mirror, m from the axis, and the reflections at both ends.
  double min_rho_;
  double max_rho_;
  Reflection innermost_{};
  Reflection outermost_{};

  /// Points of reflection over the elevation of the reflected ray, in equal steps.
  std::vector<Eigen::Vector2d> origin_by_elevation_;
  double first_elevation_ = 0.0;
  double elevation_step_ = 0.0;
};

}  // namespace omnitag
