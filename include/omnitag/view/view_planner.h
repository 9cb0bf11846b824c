#pragma once

#include <vector>

#include "omnitag/common/angle.h"
#include "omnitag/common/yaml_reader.h"
#include "omnitag/view/contour_table.h"
#include "omnitag/view/view.h"

namespace omnitag {

/// How views are placed around targets.
struct ViewPlannerConfig {
  /// Pixels of a view per pixel of the panorama along the tangent, where the panorama's resolution
  /// is highest. Below 1 a view loses detail of the panorama; a value much above 1 only costs time.
  double oversampling = 1.5;
  /// Pixels, greatest width and height of a view; larger ones are made coarser.
  int max_size = 480;
  /// rad, greatest half width of a merged view.
  double max_merged_half_width = radians(30.0);
};

/// Reads the keys above; absent ones keep their defaults. Throws InputError.
ViewPlannerConfig readViewPlannerConfig(const YamlReader& reader);

/// The view of one target.
///
/// `pixels_per_unit`: pixels of the panorama per unit of the ideal image plane.
View planView(const ViewTarget& target, const ContourTable& table, double pixels_per_unit,
              bool axis_up, const ViewPlannerConfig& config);

/// Views that together cover all targets, overlapping ones merged if that leaves no more pixels to
/// read; a target near the axis has a view of its own. A target that reaches farther than the
/// table's contours is cut there.
std::vector<View> planViews(const std::vector<ViewTarget>& targets, const ContourTable& table,
                            double pixels_per_unit, bool axis_up, const ViewPlannerConfig& config);

}  // namespace omnitag
