#pragma once

namespace omnitag {

/// Pixels.
struct ImageSize {
  int width = 0;
  int height = 0;
};

}  // namespace omnitag
