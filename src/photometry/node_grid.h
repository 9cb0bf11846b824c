#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace omnitag {

/// Pixels of the corners of square facets, row by row; nothing if one is not seen.
using NodeGrid = std::vector<std::optional<Eigen::Vector2d>>;

/// Facets along either side for which nodes are projected; cubic polynomials interpolate
/// all others.
constexpr int kProjectedFacets = 3;

/// The nodes of a grid with this many facets along either side, interpolated from the nodes of a
/// grid with kProjectedFacets on the same square. Nothing if one of those is missing.
std::optional<NodeGrid> interpolated(const NodeGrid& nodes, int facets);

}  // namespace omnitag
