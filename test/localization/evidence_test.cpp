#include "omnitag/localization/evidence.h"

#include <gtest/gtest.h>

#include <memory>

#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"
#include "omnitag/localization/pose_estimator.h"

namespace omnitag {
namespace {

/// What becomes of a robot in a room of ten markers, entries 0 to 9 around its walls, that are
/// taken for seen in their places or elsewhere.
class EvidenceTest : public testing::Test {
 protected:
  EvidenceTest() { memory_.startFrame(100.0); }

  /// As an image some seconds ago showed these in their places.
  void sawInPlace(const std::vector<std::size_t>& entries, double age = 0.1) {
    for (const std::size_t entry : entries) memory_.addSeen(sighting(entry, 100.0 - age));
  }

  RememberedSighting sighting(std::size_t entry, double stamp) const {
    const auto reading = test::exactReading(map_.markers[entry], camera_, here_);
    if (!reading) throw InputError("the marker is out of sight");
    return {stamp, {entry, reading->corners, reading->center}, camera_, here_};
  }

  Verdict weigh(const std::vector<std::size_t>& for_found,
                const std::vector<std::size_t>& for_expected, bool has_odometry = true,
                const std::vector<std::size_t>& missed = {}) const {
    return evidence_.weigh({here_, here_, there_, for_found, for_expected, missed, has_odometry},
                           start_);
  }

  const Pose here_{0.3, -0.2, 0.4};
  /// Half a metre away.
  const Pose there_{0.7, 0.1, 0.35};
  MarkerMap map_{"map", test::roomMarkers()};
  MountedCamera camera_{test::sphericalCamera(), test::lookingDown()};
  MarkerMemory memory_{AttentionConfig{}};
  ReprojectionConfig reprojection_;
  Evidence evidence_{EvidenceConfig{}, map_, memory_, reprojection_, EstimatorConfig{}.max_misfit};
  std::optional<PosePrior> start_;
};

TEST_F(EvidenceTest, AGroupThatComesIntoViewWhileOthersStayWasMoved) {
  sawInPlace({3, 4, 5, 6, 7, 8});
  EXPECT_EQ(weigh({0, 1}, {3, 4, 5, 6}), Verdict::kExpected);
  EXPECT_EQ(weigh({0, 1}, {3, 4, 5, 6}, false), Verdict::kExpected);
}

TEST_F(EvidenceTest, OdometryHoldsThePoseAgainstAGroupInViewAlone) {
  sawInPlace({3, 4, 5, 6, 7, 8});
  EXPECT_EQ(weigh({0, 1}, {}), Verdict::kExpected);
  EXPECT_EQ(weigh({0, 1}, {}, false), Verdict::kOpen) << "a robot without may have turned off";
}

TEST_F(EvidenceTest, MarkersThatWereInPlaceAMomentAgoDoNotMoveTogether) {
  sawInPlace({0, 1, 2, 3, 4, 5});
  for (const bool has_odometry : {true, false}) {
    EXPECT_EQ(weigh({0, 1, 2, 3}, {}, has_odometry), Verdict::kFound);
    EXPECT_EQ(weigh({0, 1}, {}, has_odometry), Verdict::kFound);
  }
  EXPECT_EQ(weigh({0}, {1, 2, 3, 4}), Verdict::kExpected) << "one alone may";
}

TEST_F(EvidenceTest, ThoseThatAreMissedSpeakForARobotThatWasCarried) {
  sawInPlace({3, 4, 5, 6, 7, 8});
  EXPECT_EQ(weigh({0, 1}, {}, true, {3, 4, 5, 6, 7, 8}), Verdict::kFound);
}

TEST_F(EvidenceTest, APoseThatWasGivenByMistakeIsReplaced) {
  start_ = PosePrior::about(floorEstimate(here_, Eigen::Vector3d(0.01, 0.01, 0.0076).asDiagonal()));
  EXPECT_EQ(weigh({0, 2, 3, 5, 7}, {}), Verdict::kFound);
  EXPECT_NE(weigh({0, 1}, {4, 5, 7, 8}), Verdict::kFound) << "which others confirm";
}

TEST_F(EvidenceTest, BetweenTwoGroupsThatAreSeenFirstNothingIsCertain) {
  // Within what a given pose leaves open.
  start_ = PosePrior::about(floorEstimate(here_, Eigen::Vector3d(1.0, 1.0, 0.5).asDiagonal()));
  EXPECT_EQ(weigh({0, 1, 2}, {5, 6, 7}), Verdict::kOpen);
  EXPECT_EQ(weigh({5, 6, 7}, {0, 1, 2}), Verdict::kOpen);
}

TEST_F(EvidenceTest, OneThatIsMisreadIsOutvoted) {
  EXPECT_EQ(weigh({0}, {2, 3, 5, 7, 8}), Verdict::kExpected);
  EXPECT_EQ(weigh({2, 3, 5, 7, 8}, {0}), Verdict::kFound);
}

}  // namespace
}  // namespace omnitag
