#include "marker/code_family.h"

#include <memory>
#include <utility>

namespace omnitag {

AprilTagFamily libraryFamily(CodeFamily family) {
  /// What the library's pointers refer to.
  struct Storage {
    CodeFamily data;
    apriltag_family_t library{};
  };
  auto storage = std::make_shared<Storage>();
  storage->data = std::move(family);
  CodeFamily& data = storage->data;
  apriltag_family_t& library = storage->library;
  library.ncodes = static_cast<std::uint32_t>(data.codes.size());
  library.codes = data.codes.data();
  library.width_at_border = data.border_width;
  library.total_width = data.border_width + 2;
  library.reversed_border = false;
  library.nbits = static_cast<std::uint32_t>(data.columns.size());
  library.bit_x = data.columns.data();
  library.bit_y = data.rows.data();
  library.h = static_cast<std::uint32_t>(data.distance);
  library.name = data.name.data();
  return {&library, [storage](apriltag_family_t* /*family*/) mutable { storage.reset(); }};
}

}  // namespace omnitag
