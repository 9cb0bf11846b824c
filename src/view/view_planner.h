#pragma once

#include <vector>

#include "omnitag/view/view.h"
#include "omnitag/view/view_planner_config.h"
#include "view/contour_table.h"
#include "view/view_target.h"

namespace omnitag {

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
