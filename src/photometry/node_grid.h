#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace omnitag {

/// Pixels of the corners of square facets, row by row; nothing where one is not seen.
using NodeGrid = std::vector<std::optional<Eigen::Vector2d>>;

/// Facets along either side from whose nodes cubic polynomials tell all others.
constexpr int kProjectedFacets = 3;

/// The nodes of this many facets along either side of the same square as the kProjectedFacets of
/// `nodes`. Nothing where one of these is missing.
std::optional<NodeGrid> interpolated(const NodeGrid& nodes, int facets);

}  // namespace omnitag
