#include "planning/pattern_edges.h"

#include "marker/tag_pattern.h"

namespace omnitag {

PatternEdges edgesOf(const Marker& marker) {
  const TagPattern pattern(marker);
  PatternEdges edges;
  edges.modules = pattern.widthBetweenCorners();
  edges.feature_width = pattern.featureWidth();
  const auto contrast = [&pattern](int column, int row, int other_column, int other_row) {
    const double difference =
        pattern.whiteAt(column, row) - pattern.whiteAt(other_column, other_row);
    return difference * difference;
  };
  for (int i = 0; i < pattern.width(); ++i) {
    for (int k = 0; k + 1 < pattern.width(); ++k) {
      edges.along_y += contrast(k, i, k + 1, i);
      edges.along_x += contrast(i, k, i, k + 1);
    }
  }
  return edges;
}

std::vector<PatternEdges> edgesOf(const MarkerMap& map) {
  std::vector<PatternEdges> edges;
  edges.reserve(map.markers.size());
  for (const Marker& marker : map.markers) edges.push_back(edgesOf(marker));
  return edges;
}

}  // namespace omnitag
