#pragma once

#include "omnitag/localization/localizer_config.h"

namespace omnitag::test {

/// For a robot on a floor that is exactly even: what is tested elsewhere than leaning is told more
/// exactly by fewer markers where that is known.
inline LocalizerConfig onLevelFloor(LocalizerConfig config = {}) {
  config.motion.floor.lean_deviation = 0.0;
  config.motion.floor.height_deviation = 0.0;
  return config;
}

}  // namespace omnitag::test
