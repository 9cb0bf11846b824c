#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "marker/pattern_picture.h"

namespace omnitag::test {

/// The names of the pictures that come with the package.
inline const std::vector<std::string>& pictureNames() {
  static const std::vector<std::string> names = {"crown", "flag",  "hammer", "moon", "plough",
                                                 "road",  "snake", "steps",  "wave"};
  return names;
}

/// One of them. `border`: as a share of the edge.
inline std::shared_ptr<const PatternPicture> picture(const std::string& name,
                                                     double border = 0.25) {
  PatternPicture read =
      loadPatternPicture(std::string(PACKAGE_DIR) + "/maps/patterns/" + name + ".patt");
  read.border = border;
  return std::make_shared<PatternPicture>(std::move(read));
}

}  // namespace omnitag::test
