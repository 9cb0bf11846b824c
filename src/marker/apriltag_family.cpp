#include "marker/apriltag_family.h"

#include <apriltag/tag16h5.h>
#include <apriltag/tag25h9.h>
#include <apriltag/tag36h11.h>
#include <apriltag/tagCircle21h7.h>
#include <apriltag/tagCircle49h12.h>
#include <apriltag/tagCustom48h12.h>
#include <apriltag/tagStandard41h12.h>
#include <apriltag/tagStandard52h13.h>
// Not in every 3.x release of the library.
#if __has_include(<apriltag/tag36h10.h>)
#include <apriltag/tag36h10.h>
#endif

#include <array>
#include <set>

#include "marker/aprilgrid_family.h"
#include "marker/aruco_family.h"
#include "marker/tag_family.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

struct FamilyFunctions {
  const char* name;
  apriltag_family_t* (*create)();
  void (*destroy)(apriltag_family_t*);
};

constexpr std::array kFamilies = {
    FamilyFunctions{"tag16h5", tag16h5_create, tag16h5_destroy},
    FamilyFunctions{"tag25h9", tag25h9_create, tag25h9_destroy},
#if __has_include(<apriltag/tag36h10.h>)
    FamilyFunctions{"tag36h10", tag36h10_create, tag36h10_destroy},
#endif
    FamilyFunctions{"tag36h11", tag36h11_create, tag36h11_destroy},
    FamilyFunctions{"tagCircle21h7", tagCircle21h7_create, tagCircle21h7_destroy},
    FamilyFunctions{"tagCircle49h12", tagCircle49h12_create, tagCircle49h12_destroy},
    FamilyFunctions{"tagCustom48h12", tagCustom48h12_create, tagCustom48h12_destroy},
    FamilyFunctions{"tagStandard41h12", tagStandard41h12_create, tagStandard41h12_destroy},
    FamilyFunctions{"tagStandard52h13", tagStandard52h13_create, tagStandard52h13_destroy},
};

}  // namespace

AprilTagFamily createAprilTagFamily(const std::string& name) {
  for (const FamilyFunctions& family : kFamilies) {
    if (name == family.name) return {family.create(), family.destroy};
  }
  if (name == kAprilGridFamily) return createAprilGridFamily();
  if (arucoDictionaries().count(name) > 0) return createArucoFamily(name);
  throw InputError(
      "expected a family of the AprilTag library, aprilgrid or a dictionary of OpenCV, found '" +
      name + "'");
}

const std::set<std::string>& tagFamilies() {
  static const std::set<std::string> names = [] {
    std::set<std::string> result = arucoDictionaries();
    result.insert(kAprilGridFamily);
    for (const FamilyFunctions& family : kFamilies) result.insert(family.name);
    return result;
  }();
  return names;
}

int tagCount(const std::string& family) {
  if (arucoDictionaries().count(family) > 0) return arucoCount(family);
  return static_cast<int>(createAprilTagFamily(family)->ncodes);
}

}  // namespace omnitag
