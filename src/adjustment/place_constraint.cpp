#include "adjustment/place_constraint.h"

#include <algorithm>
#include <cmath>

#include "common/format.h"
#include "common/symmetric_matrix.h"
#include "omnitag/common/angle.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

Eigen::Vector3d middleOf(const std::vector<Eigen::Isometry3d>& places) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Isometry3d& place : places) sum += place.translation();
  return sum / static_cast<double>(places.size());
}

bool isMeant(const MarkerReference& reference, const Marker& marker) {
  return reference.name.empty() ? marker.id == reference.id : marker.name == reference.name;
}

}  // namespace

std::optional<PlaceConstraint> resolved(const MapConstraint& constraint,
                                        const std::vector<Marker>& markers) {
  PlaceConstraint result;
  result.kind = constraint.kind;
  result.value = constraint.value;
  result.deviation = constraint.deviation;
  result.name = constraint.text();
  for (const MarkerReference& reference : constraint.markers) {
    std::optional<std::size_t> meant;
    for (std::size_t i = 0; i < markers.size(); ++i) {
      if (!isMeant(reference, markers[i])) continue;
      if (meant) {
        throw InputError("constraints: " + constraint.text() + ": several markers have id " +
                         reference.text() + ", expected the name of one");
      }
      meant = i;
    }
    if (!meant) return std::nullopt;
    result.markers.push_back(*meant);
  }
  return result;
}

std::optional<std::string> contradiction(const PlaceConstraint& constraint,
                                         const std::vector<Marker>& markers) {
  constexpr double kFar = 4.0;  // deviations
  std::vector<Eigen::Isometry3d> places;
  for (const std::size_t marker : constraint.markers) {
    places.push_back(markers[marker].map_from_marker);
  }
  const Eigen::VectorXd errors = errorsOf(constraint, places);
  Eigen::Index worst = 0;
  const double error = errors.cwiseAbs().maxCoeff(&worst);
  if (!(error > kFar * constraint.deviation)) return std::nullopt;
  const std::string apart = format(" (%.0f deviations apart)", error / constraint.deviation);
  const bool has_value = constraint.kind == MapConstraint::Kind::kDistance ||
                         constraint.kind == MapConstraint::Kind::kHeight;
  if (has_value) {
    return format("%s: %.4f m was measured, the images tell %.4f m", constraint.name.c_str(),
                  constraint.value, constraint.value + errors(0)) +
           apart;
  }
  const std::string who =
      std::to_string(markers[constraint.markers[static_cast<std::size_t>(worst)]].id);
  if (constraint.kind == MapConstraint::Kind::kVertical) {
    return format("%s: the images tell that marker %s leans by %.2f degrees",
                  constraint.name.c_str(), who.c_str(), degrees(error)) +
           apart;
  }
  return format("%s: the images tell that marker %s is %.4f m off it", constraint.name.c_str(),
                who.c_str(), error) +
         apart;
}

Eigen::Vector3d normalOfPlane(const std::vector<Eigen::Isometry3d>& places) {
  const Eigen::Vector3d middle = middleOf(places);
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Isometry3d& place : places) {
    const Eigen::Vector3d off = place.translation() - middle;
    scatter += off * off.transpose();
  }
  return eigenPairs(scatter).vectors.col(0);
}

Eigen::VectorXd errorsOf(const PlaceConstraint& constraint,
                         const std::vector<Eigen::Isometry3d>& places, const Eigen::Vector3d& up) {
  const auto size = static_cast<Eigen::Index>(places.size());
  switch (constraint.kind) {
    case MapConstraint::Kind::kDistance:
      return Eigen::VectorXd::Constant(
          1, (places[1].translation() - places[0].translation()).norm() - constraint.value);
    case MapConstraint::Kind::kHeight:
      return Eigen::VectorXd::Constant(1, places[0].translation().z() - constraint.value);
    case MapConstraint::Kind::kVertical: {
      Eigen::VectorXd tilts(size);
      std::transform(places.begin(), places.end(), tilts.data(), [](const auto& place) {
        return std::asin(std::clamp(place.linear()(2, 2), -1.0, 1.0));
      });
      return tilts;
    }
    case MapConstraint::Kind::kPlane:
      break;
  }
  const Eigen::Vector3d middle = middleOf(places);
  Eigen::Vector3d normal = normalOfPlane(places);
  if (normal.dot(up) < 0.0) normal = -normal;
  Eigen::VectorXd distances(size);
  std::transform(places.begin(), places.end(), distances.data(),
                 [&](const auto& place) { return normal.dot(place.translation() - middle); });
  return distances;
}

}  // namespace omnitag
