#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "omnitag/marker/map_constraint.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// A MapConstraint with its markers resolved to indices, here of a bundle's landmarks.
struct PlaceConstraint {
  MapConstraint::Kind kind = MapConstraint::Kind::kDistance;
  std::vector<std::size_t> markers;
  /// m; of a distance and a height.
  double value = 0.0;
  /// m, or rad for verticals.
  double deviation = 1.0;
  /// For people, as MapConstraint::text().
  std::string name = {};
};

/// A constraint of these markers; nothing where one that it names is not among them. Throws
/// InputError where it names an id that several have.
std::optional<PlaceConstraint> resolved(const MapConstraint& constraint,
                                        const std::vector<Marker>& markers);

/// In words where markers at these places contradict a constraint by far more than its deviation:
/// what it says, and what they do. Nothing where they do not.
std::optional<std::string> contradiction(const PlaceConstraint& constraint,
                                         const std::vector<Marker>& markers);

/// By how much markers at these places (map_from_marker, in the constraint's order) are off, in the
/// constraint's unit: one number for a distance or a height; the distance of each from the plane
/// that fits all best, along `up`'s side of it; the tilt of each face off the vertical.
Eigen::VectorXd errorsOf(const PlaceConstraint& constraint,
                         const std::vector<Eigen::Isometry3d>& places,
                         const Eigen::Vector3d& up = Eigen::Vector3d::UnitZ());

/// Unit normal of the plane that fits the centres of these places best.
Eigen::Vector3d normalOfPlane(const std::vector<Eigen::Isometry3d>& places);

}  // namespace omnitag
