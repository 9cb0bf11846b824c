#pragma once

#include <cstddef>

namespace omnitag {

/// Where a place of a grid with so many columns stands, row by row.
inline std::size_t gridIndex(int column, int row, int columns) {
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
         static_cast<std::size_t>(column);
}

}  // namespace omnitag
