#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "marker/tag_pattern.h"
#include "photometry/marker_patch.h"

namespace omnitag {

/// Where a marker images, relative to where it is predicted.
struct Placement {
  /// Pixels by which its middle is displaced.
  Eigen::Vector2d displacement = Eigen::Vector2d::Zero();
  /// Additional displacement around the predicted middle, per pixel of distance from it.
  Eigen::Matrix2d stretch = Eigen::Matrix2d::Zero();
  Eigen::Vector2d predicted_middle = Eigen::Vector2d::Zero();

  /// Displacement, in pixels, of a point that is predicted at this pixel.
  Eigen::Vector2d displacementAt(const Eigen::Vector2d& predicted) const {
    return displacement + stretch * (predicted - predicted_middle);
  }
};

/// Visits the footprints of a marker in its place: pixels move by the whole pixels of the
/// displacement, and the positions on the drawing by the rest. (Interpolated grey levels would be
/// blurred.) Calls back with the predicted pixel and the footprint, except if that is off the
/// panorama or nearer to the drawing's edge than it reaches, or than `least_reach` modules.
/// `width`: the drawing's, in modules.
template <typename Visit>
void visitPlaced(const std::vector<Footprint>& footprints, const Placement& placement,
                 const cv::Size& panorama, double width, double least_reach, const Visit& visit) {
  const Eigen::Vector2d whole = placement.displacement.array().round();
  const cv::Point offset(static_cast<int>(whole.x()), static_cast<int>(whole.y()));
  const cv::Rect image({0, 0}, panorama);
  for (Footprint footprint : footprints) {
    const Eigen::Vector2d predicted(footprint.column, footprint.row);
    footprint.column += offset.x;
    footprint.row += offset.y;
    footprint.position += footprint.facet->by_pixel * (whole - placement.displacementAt(predicted));
    const Eigen::Vector2d reach = footprint.facet->window.core().cwiseMax(least_reach);
    if (!image.contains({footprint.column, footprint.row}) ||
        (footprint.position - reach).minCoeff() < 0.0 ||
        (footprint.position + reach).maxCoeff() > width) {
      continue;
    }
    visit(predicted, footprint);
  }
}

struct PatternFit {
  Placement placement;
  /// Grey levels between black and white.
  double contrast = 0.0;
};

/// Least squares over the placement, and over grey = black + contrast * white, from a placement
/// whose displacement is right to a quarter of a module (TagPattern::featureWidth()).
/// `is_stretched`: whether the marker may image larger, turned or slanted; otherwise it is only
/// displaced. Nothing if the pixels leave an unknown undetermined, or if black is brighter than
/// white.
std::optional<PatternFit> alignPattern(const cv::Mat& panorama,
                                       const std::vector<Footprint>& footprints,
                                       const TagPattern& pattern, const Placement& start,
                                       bool is_stretched);

}  // namespace omnitag
