#include "localization/marker_memory.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "../support/level_floor.h"
#include "../support/panorama_renderer.h"
#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"
#include "omnitag/localization/localizer.h"

namespace omnitag {
namespace {

const Eigen::Vector3d kHere(1.0, 2.0, 1.1);

RememberedSighting seenAt(std::size_t entry, double stamp) {
  const Eigen::Vector2d anywhere(0.0, 0.0);
  return {stamp,
          {entry, {anywhere, anywhere, anywhere, anywhere}, anywhere},
          {test::sphericalCamera(), test::lookingDown()},
          {}};
}

TEST(MarkerMemoryTest, OneThatWasMissedTwiceIsHiddenForAWhileAndAWay) {
  AttentionConfig config;
  config.hidden_time = 1.0;
  config.hidden_way = 0.25;
  MarkerMemory memory(config);
  EXPECT_FALSE(memory.isHidden(7, kHere, 0.0));
  memory.addMissed(7, kHere, 0.0);
  EXPECT_FALSE(memory.isHidden(7, kHere, 0.1)) << "somebody may have walked by";
  memory.addMissed(7, kHere, 0.1);
  EXPECT_TRUE(memory.isHidden(7, kHere, 1.0));
  EXPECT_FALSE(memory.isHidden(7, kHere, 1.2));
  EXPECT_TRUE(memory.isHidden(7, kHere + Eigen::Vector3d(0.2, 0.0, 0.0), 0.2));
  EXPECT_FALSE(memory.isHidden(7, kHere + Eigen::Vector3d(0.2, 0.2, 0.0), 0.2));
  EXPECT_FALSE(memory.isHidden(6, kHere, 0.2)) << "another one";
  memory.addSeen(seenAt(7, 0.3));
  EXPECT_FALSE(memory.isHidden(7, kHere, 0.4));
}

TEST(MarkerMemoryTest, TellsWhatWasSeenTheLastTime) {
  MarkerMemory memory({});
  EXPECT_FALSE(memory.wasSeen(3));
  memory.addSeen(seenAt(3, 1.0));
  EXPECT_TRUE(memory.wasSeen(3));
  EXPECT_TRUE(memory.wasSeenSince(3, 1.0));
  EXPECT_FALSE(memory.wasSeenSince(3, 1.1));
  memory.addMissed(3, kHere, 1.1);
  EXPECT_FALSE(memory.wasSeen(3));
  EXPECT_TRUE(memory.wasMissed(3));
  EXPECT_TRUE(memory.wasSeenSince(3, 1.0));
}

TEST(MarkerMemoryTest, KnowsWhereMarkersWereSeen) {
  MarkerMemory memory({});
  EXPECT_FALSE(memory.inPlace(2));
  memory.addSeen(seenAt(2, 1.0));
  ASSERT_TRUE(memory.inPlace(2));
  EXPECT_EQ(memory.inPlace(2)->stamp, 1.0);
  const auto never = [](const RememberedSighting&, const Eigen::Isometry3d&) { return false; };
  memory.addElsewhere(seenAt(2, 2.0), never);
  EXPECT_EQ(memory.countInPlace(), 0U);
  memory.addElsewhere(seenAt(2, 3.0), never);
  EXPECT_TRUE(memory.isElsewhere(2));
  EXPECT_EQ(memory.elsewhere(2)->stamp, 3.0);
  EXPECT_EQ(memory.elsewhereSince(2), 2.0);
  memory.addSeen(seenAt(2, 4.0));
  EXPECT_FALSE(memory.isElsewhere(2)) << "back in its place";
  EXPECT_EQ(memory.countInPlace(), 1U);
  memory.forgetPlaces();
  EXPECT_EQ(memory.countInPlace(), 0U);
}

TEST(MarkerMemoryTest, LearnsHowManyMarkersAreSeenAtFirstSight) {
  MarkerMemory memory({});
  EXPECT_EQ(memory.seenAtFirst(), 0.5);
  for (std::size_t entry = 0; entry < 30; ++entry) {
    if (entry % 3 == 0) {
      memory.addSeen(seenAt(entry, 1.0));
    } else {
      memory.addMissed(entry, kHere, 1.0);
    }
  }
  EXPECT_NEAR(memory.seenAtFirst(), 1.0 / 3.0, 0.02);
  for (int i = 0; i < 20; ++i) memory.addMissed(0, kHere, 2.0 + i);
  EXPECT_NEAR(memory.seenAtFirst(), 1.0 / 3.0, 0.02) << "another look is none at first sight";
}

/// A robot that stands in a room whose walls hide some of the map's markers.
class HiddenMarkersTest : public testing::Test {
 protected:
  static constexpr double kPeriod = 0.1;  // s between images

  HiddenMarkersTest() {
    // Behind the walls, and beside the markers in view.
    for (const Marker& marker : test::roomMarkers()) {
      Marker behind = marker;
      behind.id += 100;
      behind.map_from_marker.translate(Eigen::Vector3d(1.1, 0.0, -1.0));
      map_.markers.push_back(behind);
    }
  }

  cv::Mat render(const std::vector<Marker>& seen) const {
    return test::renderPanorama({"map", seen}, {model_, mounting_}, pose_, 2);
  }

  FrameResult process(const cv::Mat& image) {
    return localizer_.process({kPeriod * frames_++, image, mounting_, pose_});
  }

  static bool shows(const FrameResult& result, int id) {
    return std::any_of(result.detections.begin(), result.detections.end(),
                       [id](const MarkerDetection& detection) { return detection.id == id; });
  }

  std::shared_ptr<const CameraModel> model_ = test::sphericalCamera();
  Eigen::Isometry3d mounting_ = test::lookingDown();
  Pose pose_{0.3, -0.2, 0.4};
  MarkerMap map_{"map", test::roomMarkers()};
  Localizer localizer_{model_, map_, test::onLevelFloor()};
  int frames_ = 0;
};

TEST_F(HiddenMarkersTest, AreLookedForNowAndThenAlone) {
  Localizer localizer(model_, map_, test::onLevelFloor());
  const cv::Mat image = render(test::roomMarkers());
  localizer.setPose(pose_);
  std::size_t looks = 0;
  constexpr int kFrames = 40;
  for (int i = 0; i < kFrames; ++i) {
    const FrameResult result = localizer.process({kPeriod * i, image, mounting_, pose_});
    ASSERT_EQ(result.mode, Mode::kTracking);
    EXPECT_EQ(result.acceptedMarkers(), 10);
    // The given pose leaves some undecided, so views of them are decoded.
    EXPECT_LE(result.views.size(), i > 0 ? 1U : 5U) << "nothing but the patrol's";
    looks += result.missed.size();
  }
  // Twice at first, and then once a second.
  EXPECT_GE(looks, 10U);
  EXPECT_LE(looks, 10U * (2 + 4));
}

TEST_F(HiddenMarkersTest, AreSeenWithinASecondOnceNothingHidesThem) {
  Localizer localizer(model_, map_, test::onLevelFloor());
  const cv::Mat before = render(test::roomMarkers());
  const cv::Mat after = render(map_.markers);
  localizer.setPose(pose_);
  const auto seenIn = [&](int frame, const cv::Mat& image) {
    return localizer.process({kPeriod * frame, image, mounting_, pose_}).acceptedMarkers();
  };
  for (int i = 0; i < 15; ++i) EXPECT_EQ(seenIn(i, before), 10);
  int seen = 0;
  for (int i = 15; i <= 26; ++i) seen = seenIn(i, after);
  EXPECT_GT(seen, 16);
}

TEST_F(HiddenMarkersTest, OneThatTheMapDoesNotHaveIsReadWithinThePeriod) {
  std::vector<Marker> seen = test::roomMarkers();
  constexpr int kUnknown = 200;
  seen.push_back(test::wallMarker(kUnknown, {3.1, 4.0, 1.2}, -kPi / 2));
  const cv::Mat before = render(test::roomMarkers());
  const cv::Mat after = render(seen);
  localizer_.setPose(pose_);
  // Whichever view has its turn when the marker appears.
  for (int start = 0; start < 5; ++start) {
    for (int i = 0; i < 20 + 4 * start; ++i) EXPECT_FALSE(shows(process(before), kUnknown));
    int frames = 1;
    while (!shows(process(after), kUnknown) && frames < 100) ++frames;
    EXPECT_LE(frames * kPeriod, AttentionConfig{}.period + 2 * kPeriod);
  }
}

}  // namespace
}  // namespace omnitag
