#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "omnitag/camera/camera_model.h"

namespace omnitag {

/// A part of a camera's field: its ring, from the middle on, and its sector in the image, from the
/// right on clockwise.
struct FieldCell {
  std::size_t ring = 0;
  std::size_t sector = 0;

  bool operator==(const FieldCell& other) const {
    return ring == other.ring && sector == other.sector;
  }
};

/// The cell of a pixel; nothing beyond the field.
std::optional<FieldCell> fieldCellOf(const CameraModel& camera, const Eigen::Vector2d& pixel);

/// How much of a camera's field some pixels cover, counted in cells of equal area.
struct FieldCoverage {
  /// Share of the cells that have a pixel, from 0 to 1.
  double share = 0.0;
  /// The empty cells in words, such as "the rim (left, upper left)", a part for each ring.
  std::vector<std::string> missing;
  /// The same cells, ring by ring.
  std::vector<FieldCell> empty;
};

FieldCoverage fieldCoverage(const CameraModel& camera, const std::vector<Eigen::Vector2d>& pixels);

/// In a line for the user, with what to do about it.
std::string describe(const FieldCoverage& coverage);

}  // namespace omnitag
