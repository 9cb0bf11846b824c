#pragma once

#include "omnitag/common/angle.h"

namespace omnitag {

class YamlReader;

/// How closely a reading must match its prediction.
struct AssociationConfig {
  /// Distance of the centres beyond the prediction's own margin, in lengths of the marker's edge.
  double max_offset = 0.5;
  /// Ratio of the sizes, either way.
  double max_scale = 1.5;
  /// rad, rotation between the two in the image.
  double max_roll = radians(30.0);
};

/// Reads the keys above; absent ones keep their defaults. Throws InputError.
AssociationConfig readAssociationConfig(const YamlReader& reader);

}  // namespace omnitag
