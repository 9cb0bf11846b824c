#pragma once

#include "omnitag/common/angle.h"

namespace omnitag {

class YamlReader;

/// How a camera looks all around for markers when its pose is unknown (the paper's Section 8).
struct LookAroundConfig {
  /// Whether to glance at the panorama first, sector by sector, which is several times faster:
  /// three markers that agree are enough, or two if no more should be seen.
  bool glance = true;
  /// rad, between the middles of neighbouring views.
  double step = radians(45.0);
  /// rad: how far neighbouring views or sectors overlap, so that a narrower marker is whole in one
  /// of them. Much wider (nearer) markers are not looked for, except on the floor and under the
  /// ceiling.
  double overlap = radians(20.0);
  /// Pixels of a view per pixel of the panorama along the tangent, where the panorama has its best
  /// resolution.
  double oversampling = 1.0;
  /// Pixels: largest width and height of a view; larger views are made coarser.
  int max_size = 960;
};

/// Reads the keys above; absent ones keep their defaults. Throws InputError.
LookAroundConfig readLookAroundConfig(const YamlReader& reader);

}  // namespace omnitag
