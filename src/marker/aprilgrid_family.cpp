#include "marker/aprilgrid_family.h"

#include <apriltag/tag36h11.h>

#include <cstdint>
#include <utility>

#include "marker/code_family.h"

namespace omnitag {

AprilTagFamily createAprilGridFamily() {
  const AprilTagFamily single(tag36h11_create(), tag36h11_destroy);
  CodeFamily family;
  family.name = kAprilGridFamily;
  family.codes.assign(single->codes, single->codes + single->ncodes);
  for (std::uint32_t bit = 0; bit < single->nbits; ++bit) {
    family.columns.push_back(single->bit_x[bit] + 1);
    family.rows.push_back(single->bit_y[bit] + 1);
  }
  family.border_width = single->width_at_border + 2;
  family.distance = static_cast<int>(single->h);
  return libraryFamily(std::move(family));
}

}  // namespace omnitag
