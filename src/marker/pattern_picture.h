#pragma once

#include <string>
#include <vector>

#include "common/grid_index.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// The name of the family whose markers are pictures in a black border, as ARToolKit's are.
constexpr const char* kPictureFamily = "artoolkit";

/// The picture of a marker, within its black border.
struct PatternPicture {
  /// Where it was read from, and its path as the map states it.
  std::string path;
  std::string name;
  /// Width of the border, as a share of the marker's edge.
  double border = kPictureBorder;
  /// Cells along either side.
  int side = 0;
  /// Share of white of each cell, row by row from the upper left for a person who looks at the
  /// upright marker.
  std::vector<double> white;

  double whiteAt(int column, int row) const { return white[gridIndex(column, row, side)]; }
};

/// Reads a pattern file of ARToolKit: four blocks, each turned by a quarter relative to the one
/// before, of three planes (blue, green, red) of as many rows as columns, with values from 0
/// (black) to 255. The first block is the upright picture; its luma follows Rec. 601. Throws
/// InputError, with the path, if the file cannot be read, has other contents or hardly any
/// contrast.
PatternPicture loadPatternPicture(const std::string& path);

/// Normalized correlation of a picture with another one turned counter-clockwise by `quarters`: 1
/// if they are alike whatever the light. Both must have the same number of cells.
double correlationOf(const PatternPicture& a, const PatternPicture& b, int quarters);

/// The number of independent ways in which pictures of this kind vary: for random pictures with the
/// same spectrum, the variance of their correlation with this one is 1 / n, so
/// n = 1 / sum(p^2), p: the shares of the spectrum's components in the variance.
double dimensionsOf(const PatternPicture& picture);

}  // namespace omnitag
