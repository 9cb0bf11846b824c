#include "localization/belief.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

using Entries = std::vector<std::size_t>;

/// What is believed about a robot in a room with ten markers, entries 0 to 9 around its walls, when
/// some are seen as from one pose and others as from another.
class BeliefTest : public testing::Test {
 protected:
  enum class Outcome { kStays, kMoved, kOpen };

  BeliefTest() : before_{MotionModel(MotionModelConfig{}), MarkerMemory(AttentionConfig{})} {
    before_.motion.reset({here_}, 99.9, std::nullopt);
  }

  /// Remembers these as seen in their places in several images, the last one `age` seconds ago.
  void sawInPlace(const Entries& entries, double age = 0.1) {
    for (int image = 3; image >= 0; --image) {
      FrameResult result;
      result.stamp = kNow - age - 0.1 * image;
      for (const std::size_t entry : entries) {
        before_.memory.addSeen(sightingOf(detection(entry, here_), result, camera_, here_));
      }
    }
  }

  /// Derives the robot's pose from one that was given from outside, with these variances of x and
  /// of y (m^2) and of yaw (rad^2).
  void startWith(double variance, double yaw_variance) {
    before_.restart(PosePrior::about(
        floorEstimate(here_, Eigen::Vector3d(variance, variance, yaw_variance).asDiagonal())));
  }

  MarkerDetection detection(std::size_t entry, const Pose& seen_from) const {
    const Marker& marker = map_.markers[entry];
    const auto reading = test::exactReading(marker, camera_, seen_from);
    if (!reading) throw InputError("the marker is out of sight");
    MarkerDetection detection;
    detection.family = marker.family;
    detection.id = marker.id;
    detection.map_entry = entry;
    detection.corners = reading->corners;
    detection.center = reading->center;
    detection.accepted = true;
    return detection;
  }

  /// A frame that shows these as from a pose, where the robot then is.
  FrameResult result(const Entries& entries, const Pose& pose, const Entries& missed = {}) const {
    FrameResult result;
    result.stamp = kNow;
    result.mode = Mode::kTracking;
    result.map_from_base = PoseEstimate{pose, 1e-6 * PoseMatrix::Identity()};
    for (const std::size_t entry : entries) result.detections.push_back(detection(entry, pose));
    result.missed = missed;
    return result;
  }

  /// The branches that remain when the robot is expected here, and `for_there` are seen as from
  /// there.
  std::vector<Branch> branches(const Entries& for_there, const Entries& for_here,
                               bool has_odometry = true, const Entries& missed = {}) {
    Frame frame;
    frame.stamp = kNow;
    if (has_odometry) frame.odom_from_base = Pose{};
    const Branch stays{before_, result(for_here, here_, missed)};
    std::vector<Branch> branches =
        branchesOf(childrenAt(there_, frame, camera_, before_, stays, evidence_), {there_},
                   result(for_there, there_), frame);
    branches.push_back(stays);
    return judged(std::move(branches), camera_, evidence_);
  }

  Outcome outcome(const Entries& for_there, const Entries& for_here, bool has_odometry = true,
                  const Entries& missed = {}) {
    const std::vector<Branch> kept = branches(for_there, for_here, has_odometry, missed);
    if (kept.size() > 1) return Outcome::kOpen;
    const Pose& pose = kept.front().result.map_from_base->pose;
    return std::abs(pose.x - here_.x) < 0.01 ? Outcome::kStays : Outcome::kMoved;
  }

  static constexpr double kNow = 100.0;
  const Pose here_{0.3, -0.2, 0.4};
  /// Half a metre away.
  const Pose there_{0.7, 0.1, 0.35};
  MarkerMap map_{"map", test::roomMarkers()};
  MountedCamera camera_{test::sphericalCamera(), test::lookingDown()};
  ReprojectionConfig reprojection_;
  Evidence evidence_{EvidenceConfig{}, map_, reprojection_};
  Hypothesis before_;
};

TEST_F(BeliefTest, AGroupThatComesIntoViewWhileOthersStayWasMoved) {
  sawInPlace({3, 4, 5, 6, 7, 8});
  EXPECT_EQ(outcome({0, 1}, {3, 4, 5, 6}), Outcome::kStays);
  EXPECT_EQ(outcome({0, 1}, {3, 4, 5, 6}, false), Outcome::kStays);
}

TEST_F(BeliefTest, OdometryHoldsThePoseAgainstAGroupInViewAlone) {
  sawInPlace({3, 4, 5, 6, 7, 8});
  EXPECT_EQ(outcome({0, 1}, {}), Outcome::kStays);
  EXPECT_EQ(outcome({0, 1}, {}, false), Outcome::kOpen) << "a robot without may have turned off";
}

TEST_F(BeliefTest, MarkersThatWereInPlaceAMomentAgoDoNotMoveTogether) {
  sawInPlace({0, 1, 2, 3, 4, 5});
  for (const bool has_odometry : {true, false}) {
    EXPECT_EQ(outcome({0, 1, 2, 3}, {}, has_odometry), Outcome::kMoved);
    EXPECT_EQ(outcome({0, 1}, {}, has_odometry), Outcome::kMoved);
  }
  EXPECT_EQ(outcome({0}, {1, 2, 3, 4}), Outcome::kStays) << "one alone may";
}

TEST_F(BeliefTest, WhatHungElsewhereIsNotForgottenByBeingInItsPlace) {
  sawInPlace({4, 5, 6, 7, 8});
  FrameResult earlier = result({0, 1, 2, 3}, there_);
  std::vector<RememberedSighting> group;
  for (const MarkerDetection& each : earlier.detections) {
    group.push_back(sightingOf(each, earlier, camera_, here_));
  }
  before_.memory.addGroup(group, there_.toIsometry() * here_.toIsometry().inverse());
  const double moved = evidence_.logOfPlaces(before_.memory);
  ASSERT_LT(moved, std::log(1e-2));
  const std::vector<Branch> kept = branches({0, 1, 2, 3}, {}, false);
  // If the robot had been carried, that would have happened just as they returned to their places.
  EXPECT_LT(std::abs(kept.front().result.map_from_base->pose.x - here_.x), 0.01);
  EXPECT_NEAR(kept.front().log_probability, moved, 1e-9);
  for (const Branch& branch : kept) {
    const double carried = branch.hypothesis.log_of_carried;
    EXPECT_LE(branch.log_probability, moved + carried + 1e-9);
  }
}

TEST_F(BeliefTest, ASearchThatFindsATrackedPoseKnowsNothingBetter) {
  startWith(0.01, 0.0076);
  Hypothesis there = before_;
  there.log_of_carried = evidence_.logOfCarried(true);
  Branch tracked{there, result({0, 1, 2}, there_)};
  Branch found{before_, result({0, 1, 2}, there_), true};
  found.hypothesis.memory.moveBy(there_.toIsometry() * here_.toIsometry().inverse(),
                                 evidence_.contradiction());
  const std::vector<Branch> kept = judged({found, tracked}, camera_, evidence_);
  ASSERT_EQ(kept.size(), 1U);
  EXPECT_FALSE(kept.front().is_of_search);
}

TEST_F(BeliefTest, ThoseThatAreMissedSpeakForARobotThatWasCarried) {
  sawInPlace({3, 4, 5, 6, 7, 8});
  EXPECT_EQ(outcome({0, 1}, {}, true, {3, 4, 5, 6, 7, 8}), Outcome::kMoved);
}

TEST_F(BeliefTest, APoseThatWasGivenByMistakeIsReplaced) {
  startWith(0.01, 0.0076);
  EXPECT_EQ(outcome({0, 2, 3, 5, 7}, {}), Outcome::kMoved);
  EXPECT_NE(outcome({0, 1}, {4, 5, 7, 8}), Outcome::kMoved) << "which others confirm";
}

TEST_F(BeliefTest, BetweenTwoGroupsThatAreSeenFirstNothingIsCertain) {
  // Both poses are within the uncertainty of the given pose.
  startWith(1.0, 0.5);
  EXPECT_EQ(outcome({0, 1, 2}, {5, 6, 7}), Outcome::kOpen);
  EXPECT_EQ(outcome({5, 6, 7}, {0, 1, 2}), Outcome::kOpen);
}

TEST_F(BeliefTest, OneThatIsMisreadIsOutvoted) {
  sawInPlace({2, 3, 5});
  EXPECT_EQ(outcome({0}, {2, 3, 5, 7, 8}), Outcome::kStays);
}

TEST_F(BeliefTest, NobodyIsOutvotedWhereAVaguePoseFromOutsideIsAllThatIsKnown) {
  startWith(1.0, 0.5);
  EXPECT_EQ(outcome({0}, {2, 3, 5, 7, 8}), Outcome::kOpen) << "five of a shelf may have moved";
  EXPECT_EQ(outcome({2, 3, 5, 7, 8}, {0}), Outcome::kOpen);

  startWith(0.01, 1e-4);
  EXPECT_EQ(outcome({0}, {2, 3, 5, 7, 8}), Outcome::kStays) << "a sharper one decides";
}

TEST_F(BeliefTest, ARobotThatWasAlwaysElsewhereTakesItsMarkersWithIt) {
  // First, two markers of a shelf were seen as if in their places; now the others are seen.
  startWith(1.0, 0.5);
  sawInPlace({0, 1}, 2.0);
  const std::vector<Branch> kept = {branches({3, 4, 5, 6, 7, 8}, {}).front()};
  const std::vector<DisplacedGroup> groups = kept.front().hypothesis.memory.displacedGroups();
  ASSERT_EQ(groups.size(), 1U);
  EXPECT_EQ(groups.front().entries, (Entries{0, 1}));
  ASSERT_TRUE(groups.front().motion);
  // The motion moves the pose back to where the robot seemed to be, with them in their places.
  const Pose back = Pose::fromIsometry(*groups.front().motion * there_.toIsometry());
  EXPECT_LT(difference(back, here_).norm(), 1e-9);

  // Their middle moved to where it is seen from the robot's actual pose.
  const FrameResult result = reported(kept, map_, EvidenceConfig());
  ASSERT_EQ(result.displaced_groups.size(), 1U);
  const Eigen::Vector3d middle = 0.5 * (map_.markers[0].center() + map_.markers[1].center());
  const Eigen::Vector3d seen = here_.toIsometry().inverse() * middle;
  const GroupDisplacement& moved = result.displaced_groups.front();
  EXPECT_LT((moved.shift - (there_.toIsometry() * seen - middle)).norm(), 1e-9);
  EXPECT_NEAR(moved.turn, there_.yaw - here_.yaw, 1e-9);
}

TEST_F(BeliefTest, AnOpenPoseCoversTheOther) {
  startWith(1.0, 0.5);
  const std::vector<Branch> kept = branches({0, 1, 2}, {5, 6, 7});
  ASSERT_EQ(kept.size(), 2U);
  EvidenceConfig config;
  EXPECT_FALSE(reported(kept, map_, config).map_from_base) << "half a metre is too much";
  config.open_deviation = 1.0;
  const FrameResult result = reported(kept, map_, config);
  ASSERT_TRUE(result.map_from_base);
  EXPECT_TRUE(result.is_open);
  ASSERT_EQ(result.hypotheses.size(), 2U);
  EXPECT_GE(result.hypotheses[0].probability, result.hypotheses[1].probability);
  EXPECT_NEAR(result.hypotheses[0].probability + result.hypotheses[1].probability, 1.0, 1e-9);
  EXPECT_NEAR(std::log(result.hypotheses[0].probability / result.hypotheses[1].probability),
              kept[0].log_probability - kept[1].log_probability, 1e-9);
  for (const Branch& branch : kept) {
    const Eigen::Vector2d off =
        difference(branch.result.map_from_base->pose, result.map_from_base->pose).head<2>();
    const Eigen::Matrix2d covariance = result.map_from_base->covariance.topLeftCorner<2, 2>();
    EXPECT_LT(off.dot(covariance.ldlt().solve(off)), 4.2 * 4.2);
  }
}

TEST_F(BeliefTest, ThereIsNoPoseWhileAnotherMayBeRightThatTheImageDoesNotTell) {
  startWith(1.0, 0.5);
  std::vector<Branch> kept = branches({0, 1, 2}, {5, 6, 7});
  ASSERT_EQ(kept.size(), 2U);
  kept[1].result.map_from_base.reset();
  EvidenceConfig config;
  config.open_deviation = 1.0;
  const FrameResult result = reported(kept, map_, config);
  EXPECT_FALSE(result.map_from_base);
  EXPECT_EQ(result.mode, Mode::kSearching);
}

TEST_F(BeliefTest, AnOpenPoseCoversWhereverTheOtherMayBe) {
  startWith(1.0, 0.5);
  std::vector<Branch> kept = branches({0, 1, 2, 3}, {6});
  ASSERT_EQ(kept.size(), 2U);
  constexpr double kDeviation = 0.3;  // m
  kept[1].result.map_from_base->covariance.diagonal().head<2>().setConstant(kDeviation *
                                                                            kDeviation);
  EvidenceConfig config;
  config.open_deviation = 1.0;
  const FrameResult result = reported(kept, map_, config);
  ASSERT_TRUE(result.map_from_base);
  const Eigen::Matrix2d covariance = result.map_from_base->covariance.topLeftCorner<2, 2>();
  const Eigen::Vector2d apart =
      difference(kept[1].result.map_from_base->pose, result.map_from_base->pose).head<2>();
  for (const double azimuth : {0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0}) {
    const Eigen::Vector2d off =
        apart + 2.0 * kDeviation * Eigen::Vector2d(std::cos(azimuth), std::sin(azimuth));
    EXPECT_LT(off.dot(covariance.ldlt().solve(off)), 4.2 * 4.2) << azimuth;
  }
}

TEST_F(BeliefTest, MarkersThatWereInTheirPlacesStayThereWhenOthersThatComeIntoViewDisagree) {
  const PoseEstimate predicted{here_, 1e-4 * PoseMatrix::Identity()};
  sawInPlace({3});
  FrameResult found = result({0, 1}, there_);
  found.detections.push_back(detection(3, here_));
  const auto elsewhereBeside = [&] {
    const Branch stays =
        stayingAt(predicted, found, map_, EstimatorConfig{}, camera_, {before_, {}});
    EXPECT_EQ(stays.result.acceptedMarkers() + stays.result.elsewhere.size(),
              found.detections.size());
    return stays.result.elsewhere;
  };
  EXPECT_EQ(elsewhereBeside(), (Entries{0, 1}));
  found.detections.back() = detection(4, here_);
  EXPECT_EQ(elsewhereBeside(), (Entries{0, 1, 4})) << "nothing tells it from the others";
  found = result({3}, here_);
  EXPECT_EQ(elsewhereBeside(), (Entries{3})) << "if all are in their places, the robot was moved";
}

}  // namespace
}  // namespace omnitag
