#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "omnitag/camera/camera_model.h"

namespace omnitag {

/// How much of a camera's field some pixels cover, counted in cells (rings by sectors) of equal
/// area.
struct FieldCoverage {
  /// Share of the cells that have a pixel, from 0 to 1.
  double share = 0.0;
  /// The empty cells in words, such as "the rim (left, upper left)", a part for each ring.
  std::vector<std::string> missing;
};

FieldCoverage fieldCoverage(const CameraModel& camera, const std::vector<Eigen::Vector2d>& pixels);

/// In a line for the user, with what to do about it.
std::string describe(const FieldCoverage& coverage);

}  // namespace omnitag
