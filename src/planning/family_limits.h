#pragma once

#include <string>
#include <vector>

#include "camera/mounted_camera.h"

namespace omnitag {

/// Pixels of the panorama per module (of pictures: per feature, TagPattern::featureWidth()), along
/// the marker's longest edge, at which nine of ten markers of a family are recognized where they
/// are predicted, and read in a search.
struct SmallestModules {
  double recognized = 0.0;
  double read = 0.0;
};

struct FamilyLimits {
  std::string family;
  SmallestModules smallest;
};

/// Families for which family_study measured that.
const std::vector<FamilyLimits>& measuredFamilies();

/// Those of a family; of tag36h11 if it was not measured.
SmallestModules smallestModulesOf(const std::string& family);

/// How far from the camera (m, horizontally) a marker of a family is recognized and read; 0 if it
/// never is.
struct FamilyReach {
  std::string family;
  /// Between the corners that the library reports; of pictures: features.
  int modules = 0;
  /// m, across the whole pattern with its white border.
  double printed_width = 0.0;
  SmallestModules smallest;
  double recognized = 0.0;
  double read = 0.0;
};

/// For each measured family: a marker of this size (m) at this height above the floor (m) that
/// faces the camera. The reaches are medians over those directions, all around the camera, in which
/// it is seen at all.
std::vector<FamilyReach> familyReaches(const MountedCamera& camera, double size, double height);

}  // namespace omnitag
