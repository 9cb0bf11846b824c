#include "planning/family_limits.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "omnitag/camera/camera_file.h"
#include "omnitag/common/angle.h"

namespace omnitag {
namespace {

TEST(FamilyLimits, ReachIsThatOfAPinhole) {
  const auto model = parseCamera(
      "{model: pinhole, image: {width: 640, height: 480}, uncertainty: none,\n"
      " lens: {fx: 500, fy: 500, cx: 319.5, cy: 239.5}, distortion: [0, 0, 0, 0]}",
      "pinhole");
  // It looks ahead, its rows are level.
  Eigen::Isometry3d mounting(Eigen::Translation3d(0.0, 0.0, 1.0));
  mounting.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const MountedCamera camera(model, mounting);
  constexpr double kSize = 0.2;
  const std::vector<FamilyReach> reaches = familyReaches(camera, kSize, 1.0);
  ASSERT_EQ(reaches.size(), measuredFamilies().size());
  for (const FamilyReach& reach : reaches) {
    // Ahead, an edge of kSize is 500 kSize / distance pixels long; to either side it is longer.
    const double recognized =
        500.0 * kSize / std::max(8.0, reach.modules * reach.smallest.recognized);
    const double read = 500.0 * kSize / std::max(12.0, reach.modules * reach.smallest.read);
    EXPECT_GE(reach.recognized, 0.95 * recognized) << reach.family;
    EXPECT_LE(reach.recognized, 1.35 * recognized) << reach.family;
    EXPECT_NEAR(reach.read / reach.recognized, read / recognized, 0.04) << reach.family;
  }
}

TEST(FamilyLimits, AFamilyThatWasNotMeasuredHasThoseOfTag36h11) {
  const SmallestModules known = smallestModulesOf("tag36h11");
  const SmallestModules unknown = smallestModulesOf("DICT_7X7_1000");
  EXPECT_EQ(known.recognized, unknown.recognized);
  EXPECT_EQ(known.read, unknown.read);
  EXPECT_GT(known.read, known.recognized);
}

}  // namespace
}  // namespace omnitag
