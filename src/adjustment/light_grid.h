#pragma once

#include <Eigen/Core>

namespace omnitag {

/// The light on a marker: black, and the contrast at the nodes of a grid over its drawing, bilinear
/// between them. A shadow whose edge crosses the marker fits, which no smooth function of the place
/// does; what a marker errs by otherwise is the same in all images that are taken in this light.
constexpr Eigen::Index kLightNodes = 5;  // along each side
constexpr Eigen::Index kGridLightTerms = 1 + kLightNodes * kLightNodes;
using GridLight = Eigen::Matrix<double, kGridLightTerms, 1>;

/// Derivative of a grey level by the light, where so much is white; the grey level is the product
/// with the light. `place` is on the drawing, whose sides have length 1, from its middle.
GridLight greyByLight(double white, const Eigen::Vector2d& place);

double contrastAt(const Eigen::Vector2d& place, const GridLight& light);

double meanContrast(const GridLight& light);

/// `light' * roughness() * light` is the sum of the squares of all second differences of the
/// contrast from node to node.
const Eigen::Matrix<double, kGridLightTerms, kGridLightTerms>& roughness();

}  // namespace omnitag
