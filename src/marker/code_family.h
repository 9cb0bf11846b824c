#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "marker/apriltag_family.h"

namespace omnitag {

/// A family of square codes that the AprilTag library does not have, but can read.
struct CodeFamily {
  std::string name;
  /// Bits of each id, the first one the highest; 1 is white. The first quarter of the bits, turned
  /// clockwise by a quarter of the marker, must give the second, and so on; one in the middle is
  /// last.
  std::vector<std::uint64_t> codes;
  /// Modules of the bits, from the outer corner of the black border.
  std::vector<std::uint32_t> columns;
  std::vector<std::uint32_t> rows;
  /// Modules along an outer edge of the black border.
  int border_width = 0;
  /// Least number of bits by which two ids differ, turned or not.
  int distance = 0;
};

/// The same in the library's form, with a white border of one module.
AprilTagFamily libraryFamily(CodeFamily family);

}  // namespace omnitag
