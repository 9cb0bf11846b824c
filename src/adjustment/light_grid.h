#pragma once

#include <Eigen/Core>

namespace omnitag {

/// The light on a marker: the grey level of black, and the contrast at the nodes of a grid over its
/// drawing, bilinear between them. Unlike a smooth function of the place, this fits a shadow whose
/// edge crosses the marker; a misfit would leave the same error in all images taken in the same
/// light.
constexpr Eigen::Index kLightNodes = 5;  // along each side
constexpr Eigen::Index kGridLightTerms = 1 + kLightNodes * kLightNodes;
using GridLight = Eigen::Matrix<double, kGridLightTerms, 1>;

/// Derivative of a grey level by the light, for a pixel with this share of white; its product with
/// the light is the grey level. `place`: on the drawing, relative to its middle; its sides have
/// length 1.
GridLight greyByLight(double white, const Eigen::Vector2d& place);

double contrastAt(const Eigen::Vector2d& place, const GridLight& light);

double meanContrast(const GridLight& light);

/// `light' * roughness() * light` is the sum of the squares of all second differences of the
/// contrast from node to node.
const Eigen::Matrix<double, kGridLightTerms, kGridLightTerms>& roughness();

}  // namespace omnitag
