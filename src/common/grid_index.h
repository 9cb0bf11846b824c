#pragma once

#include <cstddef>

namespace omnitag {

/// The index of a grid's cell, row by row; the grid has `columns` columns.
inline std::size_t gridIndex(int column, int row, int columns) {
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
         static_cast<std::size_t>(column);
}

}  // namespace omnitag
