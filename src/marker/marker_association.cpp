#include "marker/marker_association.h"

#include <cmath>
#include <complex>
#include <limits>

#include "common/format.h"
#include "common/yaml_reader.h"

namespace omnitag {
namespace {

/// The rotation and scale, as one complex number, that best maps the corners of one quadrilateral
/// to those of another by least squares, each about its own centre.
std::complex<double> turnAndScale(const Corners<Eigen::Vector2d>& from,
                                  const Corners<Eigen::Vector2d>& to) {
  const auto mean = [](const Corners<Eigen::Vector2d>& corners) -> Eigen::Vector2d {
    return 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
  };
  const Eigen::Vector2d from_mean = mean(from);
  const Eigen::Vector2d to_mean = mean(to);
  std::complex<double> correlation = 0.0;
  double size = 0.0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Eigen::Vector2d a = from[i] - from_mean;
    const Eigen::Vector2d b = to[i] - to_mean;
    correlation +=
        std::conj(std::complex<double>(a.x(), a.y())) * std::complex<double>(b.x(), b.y());
    size += a.squaredNorm();
  }
  return correlation / size;
}

}  // namespace

AssociationConfig readAssociationConfig(const YamlReader& reader) {
  reader.allowOnly({"max_offset", "max_scale", "max_roll"});
  AssociationConfig config;
  reader.read("max_offset", &config.max_offset, kNonNegative);
  reader.read("max_scale", &config.max_scale, {1.0, 100.0});
  reader.read("max_roll", &config.max_roll, {0.0, kPi});
  return config;
}

Association associate(const MarkerReading& reading, const std::vector<PredictedMarker>& predictions,
                      const MarkerMap& map, const AssociationConfig& config) {
  Association association;
  association.reason = "not expected here";
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t index = 0; index < predictions.size(); ++index) {
    const PredictedMarker& prediction = predictions[index];
    const Marker& marker = map.markers[prediction.map_entry];
    if (marker.id != reading.id || marker.family != reading.family) continue;
    const double offset = (reading.center - prediction.center).norm();
    const double limit = std::hypot(prediction.tangential_margin, prediction.radial_margin) +
                         config.max_offset * meanEdge(prediction.corners);
    const std::complex<double> change = turnAndScale(prediction.corners, reading.corners);
    const double scale = std::abs(change);
    const double roll = std::arg(change);

    std::string reason;
    if (offset > limit) {
      reason = format("%.1f px from where it was expected", offset);
    } else if (std::abs(roll) > config.max_roll) {
      reason = format("turned by %.0f degrees against the map", degrees(roll));
    } else if (scale > config.max_scale || scale * config.max_scale < 1.0) {
      reason = format("%.2f times the expected size", scale);
    }
    // A prediction that fits beats all that do not.
    const bool fits = reason.empty();
    if (association.prediction ? fits && offset < nearest : fits || offset < nearest) {
      nearest = offset;
      association.reason = reason;
      if (fits) association.prediction = index;
    }
  }
  return association;
}

}  // namespace omnitag
