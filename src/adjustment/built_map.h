#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "adjustment/bundle.h"
#include "adjustment/corner_residual.h"
#include "adjustment/marker_projection.h"
#include "adjustment/seen_from.h"
#include "omnitag/common/pose.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// A marker of the map that was built.
struct BuiltMarker {
  Marker marker;
  /// Whether the seed has it, and whether its place in the seed is exact and was therefore kept.
  bool is_seed = false;
  bool is_exact = false;
  /// Of a MarkerIncrement, in m^2, m rad and rad^2; of the size (m^2), 0 if it is not estimated.
  /// Relative to the markers whose places are exactly known; if there are none, within the map once
  /// it is aligned with the true one.
  MarkerCovariance covariance = MarkerCovariance::Zero();
  double size_variance = 0.0;
  /// Number of images in which it was read and agrees, and RMS over their corners in pixels.
  std::size_t sightings = 0;
  double residual = 0.0;
  /// Its place and deviations in the seed; nothing for other markers.
  std::optional<PlacePrior> survey = {};
  SeenFrom seen = {};

  /// Whether the recording told more about its place than was known.
  bool isFound() const { return !is_exact && !covariance.isZero(0.0); }
  /// m and rad: standard deviations, each in the direction in which it is largest.
  double positionDeviation() const;
  double orientationDeviation() const;
};

/// A reading that the map explains badly.
struct WorstReading {
  double stamp = 0.0;
  std::string marker;
  /// Pixels, RMS over its corners.
  double residual = 0.0;
};

struct BuiltMap {
  /// The seed's markers in their order, then the new ones by id.
  std::vector<BuiltMarker> markers;
  /// Those that were found but are left out, since they are not known well enough.
  std::vector<BuiltMarker> uncertain;
  /// For the user, a line each: markers that moved or are left out, and why.
  std::vector<std::string> remarks;
  /// Largest residuals first; ten at most.
  std::vector<WorstReading> worst;
  /// The robot's poses in the images that have one.
  std::vector<double> stamps;
  std::vector<Pose> trajectory;
  /// Of all readings; their frames are indices of these poses, their landmarks of the markers.
  std::vector<CornerResidual> residuals;
  std::size_t images = 0;
  /// Without a seed, the index of the marker that defines the map's frame.
  std::optional<std::size_t> reference;

  MarkerMap map(const std::string& frame_id) const;
};

}  // namespace omnitag
