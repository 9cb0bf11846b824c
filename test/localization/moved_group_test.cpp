#include <gtest/gtest.h>

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "../support/panorama_renderer.h"
#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"
#include "omnitag/common/angle.h"
#include "omnitag/localization/localizer.h"

namespace omnitag {
namespace {

/// Starts from the true pose among few markers, most of which were moved as one.
class MovedGroupTest : public testing::Test {
 protected:
  /// Where each marker seems to have been before the group was moved.
  static MarkerMap before(const Eigen::Isometry3d& motion, const std::vector<std::size_t>& group,
                          MarkerMap seen) {
    for (const std::size_t entry : group) {
      Marker& moved = seen.markers[entry];
      moved.map_from_marker = motion * moved.map_from_marker;
    }
    return seen;
  }

  /// Expects no pose along a route that is more than 2 cm and 5 standard deviations off.
  void expectNeverWrong(const MarkerMap& seen, const MarkerMap& map,
                        const std::vector<Pose>& route) const {
    Localizer localizer(model_, map, {});
    localizer.setPose(route.front());
    for (std::size_t i = 0; i < route.size(); ++i) {
      const FrameResult result = localizer.process(
          {kPeriod * static_cast<double>(i),
           test::renderPanorama(seen, {model_, mounting_}, route[i]), mounting_, std::nullopt});
      if (!result.map_from_base) continue;
      const double error = test::positionError(result.map_from_base->pose, route[i]);
      EXPECT_TRUE(error < 0.02 || test::deviations(*result.map_from_base, route[i]) < 5.0)
          << "image " << i << ": " << error << " m";
    }
  }

  static constexpr double kPeriod = 0.1;  // s
  std::shared_ptr<const CameraModel> model_ = test::sphericalCamera();
  Eigen::Isometry3d mounting_ = Eigen::Translation3d(0.10, -0.05, 1.1) *
                                Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitZ()) *
                                Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitX());
};

TEST_F(MovedGroupTest, TheOnlyOneInItsPlaceIsHeardAgainstThree) {
  const MarkerMap seen{"map",
                       {test::hung(547, {8.401, 3.661, 1.506}, radians(180.0), 0.43),
                        test::hung(320, {8.401, 4.965, 0.882}, radians(180.0), 0.38),
                        test::hung(2, {8.401, 5.444, 1.614}, radians(180.0), 0.35),
                        test::hung(196, {4.573, 0.010, 0.880}, radians(90.0), 0.46)}};
  const Eigen::Isometry3d motion(Eigen::Translation3d(-0.101, -0.0275, 0.0));
  expectNeverWrong(seen, before(motion, {0, 1, 2}, seen),
                   {Pose{6.613, 4.128, radians(-135.42)}, Pose{6.610, 4.125, radians(-134.95)},
                    Pose{6.601, 4.116, radians(-133.61)}, Pose{6.588, 4.101, radians(-131.42)}});
}

TEST_F(MovedGroupTest, ThreeThatDisagreeGiveNoPoseInASearch) {
  const MarkerMap seen{"map",
                       {test::hung(331, {5.799, 7.144, 1.615}, radians(-90.0), 0.36),
                        test::hung(76, {0.010, 4.174, 0.983}, radians(0.0), 0.48),
                        test::hung(116, {0.010, 4.424, 1.720}, radians(0.0), 0.40)}};
  // The two turn about a point beside them.
  const Eigen::Vector3d center(0.010, 4.174, 0.983);
  const Eigen::Isometry3d motion = Eigen::Translation3d(Eigen::Vector3d(0.289, 4.107, 0.983)) *
                                   Eigen::AngleAxisd(radians(-9.3), Eigen::Vector3d::UnitZ()) *
                                   Eigen::Translation3d(-center);
  expectNeverWrong(seen, before(motion, {1, 2}, seen),
                   {Pose{5.590, 4.685, radians(-130.09)}, Pose{5.588, 4.682, radians(-130.56)}});
}

}  // namespace
}  // namespace omnitag
