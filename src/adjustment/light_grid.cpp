#include "adjustment/light_grid.h"

#include <algorithm>

namespace omnitag {
namespace {

using Square = Eigen::Matrix<double, kGridLightTerms, kGridLightTerms>;

Eigen::Index termOf(Eigen::Index column, Eigen::Index row) {
  return 1 + row * kLightNodes + column;
}

/// The node before a place along one axis, and the share of the way to the next node.
struct BetweenNodes {
  explicit BetweenNodes(double place) {
    const double along = (place + 0.5) * static_cast<double>(kLightNodes - 1);
    node = std::clamp<Eigen::Index>(static_cast<Eigen::Index>(along), 0, kLightNodes - 2);
    share = std::clamp(along - static_cast<double>(node), 0.0, 1.0);
  }

  Eigen::Index node;
  double share;
};

Square sumOfSecondDifferences() {
  Square sum = Square::Zero();
  const auto add = [&sum](const GridLight& difference) {
    sum += difference * difference.transpose();
  };
  for (Eigen::Index i = 0; i < kLightNodes; ++i) {
    for (Eigen::Index k = 0; k + 2 < kLightNodes; ++k) {
      GridLight along_row = GridLight::Zero();
      GridLight along_column = GridLight::Zero();
      for (Eigen::Index n = 0; n < 3; ++n) {
        const double factor = n == 1 ? -2.0 : 1.0;
        along_row[termOf(k + n, i)] = factor;
        along_column[termOf(i, k + n)] = factor;
      }
      add(along_row);
      add(along_column);
    }
  }
  for (Eigen::Index row = 0; row + 1 < kLightNodes; ++row) {
    for (Eigen::Index column = 0; column + 1 < kLightNodes; ++column) {
      GridLight twist = GridLight::Zero();
      twist[termOf(column, row)] = 1.0;
      twist[termOf(column + 1, row)] = -1.0;
      twist[termOf(column, row + 1)] = -1.0;
      twist[termOf(column + 1, row + 1)] = 1.0;
      add(twist);
    }
  }
  return sum;
}

}  // namespace

GridLight greyByLight(double white, const Eigen::Vector2d& place) {
  const BetweenNodes x(place.x());
  const BetweenNodes y(place.y());
  GridLight by_light = GridLight::Zero();
  by_light[0] = 1.0;
  by_light[termOf(x.node, y.node)] = white * (1.0 - x.share) * (1.0 - y.share);
  by_light[termOf(x.node + 1, y.node)] = white * x.share * (1.0 - y.share);
  by_light[termOf(x.node, y.node + 1)] = white * (1.0 - x.share) * y.share;
  by_light[termOf(x.node + 1, y.node + 1)] = white * x.share * y.share;
  return by_light;
}

double contrastAt(const Eigen::Vector2d& place, const GridLight& light) {
  return light.dot(greyByLight(1.0, place)) - light[0];
}

double meanContrast(const GridLight& light) { return light.tail<kGridLightTerms - 1>().mean(); }

const Square& roughness() {
  static const Square kRoughness = sumOfSecondDifferences();
  return kRoughness;
}

}  // namespace omnitag
