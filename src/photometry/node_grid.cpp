#include "photometry/node_grid.h"

#include "common/grid_index.h"

namespace omnitag {
namespace {

/// Weights of a cubic polynomial's nodes at the nodes of this many facets: a row for each of
/// the latter.
Eigen::Matrix<double, Eigen::Dynamic, kProjectedFacets + 1> cubicWeights(int facets) {
  Eigen::Matrix<double, Eigen::Dynamic, kProjectedFacets + 1> weights(facets + 1,
                                                                      kProjectedFacets + 1);
  for (int i = 0; i <= facets; ++i) {
    const double place = static_cast<double>(kProjectedFacets * i) / facets;
    for (int k = 0; k <= kProjectedFacets; ++k) {
      double weight = 1.0;  // Lagrange's
      for (int j = 0; j <= kProjectedFacets; ++j) {
        if (j != k) weight *= (place - j) / (k - j);
      }
      weights(i, k) = weight;
    }
  }
  return weights;
}

}  // namespace

std::optional<NodeGrid> interpolated(const NodeGrid& nodes, int facets) {
  Eigen::Matrix<double, kProjectedFacets + 1, kProjectedFacets + 1> u;
  Eigen::Matrix<double, kProjectedFacets + 1, kProjectedFacets + 1> v;
  for (int row = 0; row <= kProjectedFacets; ++row) {
    for (int column = 0; column <= kProjectedFacets; ++column) {
      const auto& node = nodes[gridIndex(column, row, kProjectedFacets + 1)];
      if (!node) return std::nullopt;
      u(row, column) = node->x();
      v(row, column) = node->y();
    }
  }
  const auto weights = cubicWeights(facets);
  const Eigen::MatrixXd all_u = weights * u * weights.transpose();
  const Eigen::MatrixXd all_v = weights * v * weights.transpose();
  NodeGrid all(gridIndex(0, facets + 1, facets + 1));
  for (int row = 0; row <= facets; ++row) {
    for (int column = 0; column <= facets; ++column) {
      all[gridIndex(column, row, facets + 1)] =
          Eigen::Vector2d(all_u(row, column), all_v(row, column));
    }
  }
  return all;
}

}  // namespace omnitag
