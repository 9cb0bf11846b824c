#pragma once

#include "omnitag/localization/localizer_config.h"

namespace omnitag::test {

/// For a robot on an exactly even floor. If that is known, fewer markers give exact poses, which
/// suits all tests but those of lean.
inline LocalizerConfig onLevelFloor(LocalizerConfig config = {}) {
  config.motion.floor.lean_deviation = 0.0;
  config.motion.floor.height_deviation = 0.0;
  return config;
}

}  // namespace omnitag::test
