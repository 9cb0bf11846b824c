#pragma once

#include "omnitag/common/angle.h"

namespace omnitag {

class YamlReader;

/// How views are placed around targets.
struct ViewPlannerConfig {
  /// Pixels of a view per pixel of the panorama along the tangent, where the panorama's resolution
  /// is highest. Below 1 a view loses detail of the panorama; a value much above 1 only costs time.
  double oversampling = 1.5;
  /// Pixels, greatest width and height of a view; larger ones are made coarser.
  int max_size = 480;
  /// rad, greatest half width of a merged view.
  double max_merged_half_width = radians(30.0);
};

/// Reads the keys above; absent ones keep their defaults. Throws InputError.
ViewPlannerConfig readViewPlannerConfig(const YamlReader& reader);

}  // namespace omnitag
