#include "omnitag/calibration/ring_views.h"

#include <gtest/gtest.h>

#include <cmath>

#include "../support/sample_cameras.h"
#include "omnitag/view/view_warper.h"

namespace omnitag {
namespace {

/// How many of the views have a direction of the optical frame well inside.
int viewsOf(const Eigen::Vector3d& direction, const std::vector<View>& views,
            const ViewWarper& warper, const CameraModel& camera) {
  const auto pixel = camera.pixelFromPoint(5.0 * direction);
  if (!pixel) return -1;
  int count = 0;
  for (const View& view : views) {
    const auto place = warper.viewFromPanorama(view, *pixel);
    if (place && place->minCoeff() > 0.0 && place->x() < view.size.width - 1 &&
        place->y() < view.size.height - 1) {
      ++count;
    }
  }
  return count;
}

class RingViewsTest : public testing::TestWithParam<int> {
 protected:
  const std::shared_ptr<const CameraModel> camera =
      GetParam() == 0 ? test::sphericalCamera() : test::equidistantCamera();
  const MountedCamera mounted{camera, GetParam() == 0 ? test::lookingDown() : test::lookingUp()};
  const ViewWarper warper{camera, 3.0};
};

TEST_P(RingViewsTest, ShowAllThatTheCameraSeesUpToTheirHighest) {
  const std::vector<View> views = viewsOfRing(mounted, warper.table(), false);
  int seen = 0;
  for (double azimuth = 0.0; azimuth < 2.0 * kPi; azimuth += radians(7.0)) {
    for (double elevation = radians(-55.0); elevation <= radians(55.0); elevation += radians(5.0)) {
      const Eigen::Vector3d direction(std::cos(elevation) * std::cos(azimuth),
                                      std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
      const int count = viewsOf(direction, views, warper, *camera);
      seen += count > 0 ? 1 : 0;
      EXPECT_NE(count, 0) << degrees(azimuth) << ' ' << degrees(elevation);
    }
  }
  EXPECT_GT(seen, 400);
}

TEST_P(RingViewsTest, ShowTheAxisWhereAsked) {
  const std::size_t around = viewsOfRing(mounted, warper.table(), false).size();
  const std::size_t all = viewsOfRing(mounted, warper.table(), true).size();
  // Both see along one end of the axis: past the lens, and out of it.
  EXPECT_EQ(all, around + 1);
}

INSTANTIATE_TEST_SUITE_P(MirrorAndFisheye, RingViewsTest, testing::Values(0, 1));

}  // namespace
}  // namespace omnitag
