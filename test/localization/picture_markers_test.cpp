#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "../support/panorama_renderer.h"
#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"
#include "../support/sample_pictures.h"
#include "../support/sweep.h"
#include "omnitag/common/angle.h"
#include "omnitag/localization/localizer.h"

namespace omnitag {
namespace {

/// A robot among twelve pictures on the walls of a room; some hang twice, turned or not.
class PictureMarkersTest : public testing::Test {
 protected:
  PictureMarkersTest() {
    const std::vector<Marker> places = test::roomMarkers();
    const std::vector<std::string>& names = test::pictureNames();
    for (std::size_t i = 0; i < places.size(); ++i) {
      Marker marker = places[i];
      marker.family = kPictureFamily;
      // The last one is the second one, upside down.
      const std::size_t picture = i < names.size() ? i : 1;
      marker.id = static_cast<int>(picture);
      marker.picture = pictures_[picture];
      if (i >= names.size())
        marker.map_from_marker.rotate(Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitZ()));
      map_.markers.push_back(marker);
    }
  }

  Frame frameFrom(const Pose& truth, double stamp, const MarkerMap& world) const {
    return {stamp,
            test::renderPanorama(world, MountedCamera(camera_, test::lookingDown()), truth, 5),
            test::lookingDown(), std::nullopt};
  }
  Frame frameFrom(const Pose& truth, double stamp) const { return frameFrom(truth, stamp, map_); }

  Pose randomPose() {
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    const double x = 1.8 * uniform(generator_);
    const double y = 1.8 * uniform(generator_);
    return {x, y, kPi * uniform(generator_)};
  }

  static std::vector<std::shared_ptr<const PatternPicture>> pictures() {
    std::vector<std::shared_ptr<const PatternPicture>> all;
    for (const std::string& name : test::pictureNames()) all.push_back(test::picture(name));
    return all;
  }

  std::vector<std::shared_ptr<const PatternPicture>> pictures_ = pictures();
  std::shared_ptr<const CameraModel> camera_ = test::largeSphericalCamera();
  MarkerMap map_;
  std::mt19937 generator_{5};
};

TEST_F(PictureMarkersTest, AreFoundFromNothing) {
  constexpr int kPoses = 12;
  for (int i = 0; i < kPoses; ++i) {
    const Pose truth = randomPose();
    if (i % test::kSweepStride != 0) continue;
    Localizer localizer(camera_, map_, {});
    const FrameResult result = localizer.process(frameFrom(truth, 0.0));
    ASSERT_TRUE(result.map_from_base) << i << ": " << result.remark;
    EXPECT_LT(test::positionError(result.map_from_base->pose, truth), 0.003) << i;
    EXPECT_LT(test::deviations(*result.map_from_base, truth), 5.0) << i;
    EXPECT_GE(result.acceptedMarkers(), 4u) << i;
  }
}

TEST_F(PictureMarkersTest, AreRecognizedWithoutReadingWhileTracking) {
  Localizer localizer(camera_, map_, {});
  Pose truth{0.3, -0.4, 0.5};
  for (int i = 0; i < 8; ++i) {
    const FrameResult result = localizer.process(frameFrom(truth, 0.1 * i));
    ASSERT_TRUE(result.map_from_base) << i << ": " << result.remark;
    EXPECT_LT(test::positionError(result.map_from_base->pose, truth), 0.002) << i;
    if (i > 1) {
      EXPECT_GE(result.acceptedMarkers(), 8u) << i;
      EXPECT_TRUE(std::any_of(result.detections.begin(), result.detections.end(),
                              [](const MarkerDetection& each) { return each.hamming == -1; }))
          << i;
    }
    truth = truth * Pose{0.03, 0.0, 0.02};
  }
}

TEST_F(PictureMarkersTest, AnotherPictureInItsPlaceIsNotTakenForOne) {
  MarkerMap world = map_;
  std::swap(world.markers[0].picture, world.markers[5].picture);
  Localizer localizer(camera_, map_, {});
  const Pose truth{0.2, 0.1, -0.3};
  localizer.setPose(truth);
  for (int i = 0; i < 3; ++i) {
    const FrameResult result = localizer.process(frameFrom(truth, 0.1 * i, world));
    ASSERT_TRUE(result.map_from_base) << result.remark;
    EXPECT_LT(test::positionError(result.map_from_base->pose, truth), 0.002);
    for (const MarkerDetection& detection : result.detections) {
      const bool is_swapped = detection.map_entry == 0u || detection.map_entry == 5u;
      EXPECT_FALSE(detection.accepted && is_swapped) << *detection.map_entry;
    }
  }
}

}  // namespace
}  // namespace omnitag
