#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "marker/map_constraint.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// A MapConstraint with its markers resolved to indices, for example of a bundle's landmarks.
struct PlaceConstraint {
  MapConstraint::Kind kind = MapConstraint::Kind::kDistance;
  std::vector<std::size_t> markers;
  /// m; for distances and heights.
  double value = 0.0;
  /// m, or rad for verticals.
  double deviation = 1.0;
  /// For messages, as MapConstraint::text().
  std::string name = {};
};

/// The constraint with its markers' indices; nothing if one of them is not among `markers`. Throws
/// InputError if it names an id that several markers have.
std::optional<PlaceConstraint> resolved(const MapConstraint& constraint,
                                        const std::vector<Marker>& markers);

/// If the markers contradict a constraint by far more than its deviation: the constrained and the
/// actual value, in words.
std::optional<std::string> contradiction(const PlaceConstraint& constraint,
                                         const std::vector<Marker>& markers);

/// Errors of markers at these places (map_from_marker, in the constraint's order), in the
/// constraint's unit: one number for a distance or a height; for a plane, each marker's distance
/// from the best-fitting plane, positive on the side of `up`; for verticals, the tilt of each face
/// off the vertical.
Eigen::VectorXd errorsOf(const PlaceConstraint& constraint,
                         const std::vector<Eigen::Isometry3d>& places,
                         const Eigen::Vector3d& up = Eigen::Vector3d::UnitZ());

/// Unit normal of the plane that best fits the centres of these places.
Eigen::Vector3d normalOfPlane(const std::vector<Eigen::Isometry3d>& places);

}  // namespace omnitag
