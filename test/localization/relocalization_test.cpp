#include "localization/relocalization.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"

namespace omnitag {
namespace {

constexpr double kMaxResidual = 1.5;  // pixels
constexpr double kNoise = 0.05;       // pixels

/// Markers read at random poses in a room, by an exactly known camera, with noise in the corners.
class RelocalizationTest : public testing::Test {
 protected:
  Pose randomPose() { return {uniform(-2.5, 2.5), uniform(-2.5, 2.5), uniform(-kPi, kPi)}; }

  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator_);
  }

  /// A marker as it is read from a pose.
  std::optional<MarkerReading> read(const Marker& marker, const Pose& pose) {
    const auto exact = test::exactReading(marker, camera_, pose);
    if (!exact) return std::nullopt;
    return test::withNoise(*exact, kNoise, &generator_);
  }

  /// `count` random markers that are seen from a pose, in random order.
  std::vector<MarkerReading> readSome(const std::vector<Marker>& markers, const Pose& pose,
                                      std::size_t count) {
    std::vector<MarkerReading> readings;
    for (const Marker& marker : markers) {
      if (auto reading = read(marker, pose)) readings.push_back(std::move(*reading));
    }
    std::shuffle(readings.begin(), readings.end(), generator_);
    if (readings.size() > count) readings.resize(count);
    return readings;
  }

  /// A marker of the room as a robot that has turned by an angle reads it: in another direction.
  MarkerReading readTurned(int id, const Pose& pose, double angle) {
    const Marker& marker = room_.markers[static_cast<std::size_t>(id)];
    return *read(marker, {pose.x, pose.y, normalizeAngle(pose.yaw + angle)});
  }

  Relocalization search(const MarkerMap& map, const std::vector<MarkerReading>& readings) const {
    return relocalize(map, camera_, readings, PosePrior::upright(), {}, config_);
  }

  /// Expects a right pose, within its covariance.
  void expectPose(const Relocalization& found, const Pose& truth, double tolerance) const {
    ASSERT_TRUE(found.map_from_base) << found.reason;
    expectNoWrongPose(found, truth, tolerance);
  }

  /// Expects either no pose and a reason, or the right one.
  static void expectNoWrongPose(const Relocalization& found, const Pose& truth, double tolerance) {
    if (!found.map_from_base) {
      EXPECT_NE(found.reason, "");
      return;
    }
    EXPECT_EQ(found.reason, "");
    const PoseEstimate& estimate = *found.map_from_base;
    const Eigen::Vector3d error = difference(estimate.pose, truth).head<3>();
    EXPECT_LT(error.head<2>().norm(), tolerance);
    EXPECT_LT(std::abs(error.z()), tolerance);
    // Chi-square with 3 degrees of freedom exceeds 21.1 once in 10 000.
    EXPECT_LT(error.dot(floorCovariance(estimate).ldlt().solve(error)), 21.1);
  }

  MountedCamera camera_{test::sphericalCamera(), test::lookingDown()};
  MarkerMap room_{"map", test::roomMarkers()};
  RelocalizationConfig config_;
  std::mt19937 generator_{7};
};

TEST_F(RelocalizationTest, TwoMarkersOrMoreGiveThePose) {
  for (const std::size_t count : {2U, 3U, 5U}) {
    for (int i = 0; i < 100; ++i) {
      const Pose truth = randomPose();
      const std::vector<MarkerReading> readings = readSome(room_.markers, truth, count);
      ASSERT_EQ(readings.size(), count);
      const Relocalization found = search(room_, readings);
      expectPose(found, truth, 0.05);
      for (std::size_t k = 0; k < count; ++k) {
        ASSERT_TRUE(found.entries[k]);
        EXPECT_EQ(room_.markers[*found.entries[k]].id, readings[k].id);
        EXPECT_LT(found.misfits[k].residual, 6.0 * kNoise);
      }
    }
  }
}

TEST_F(RelocalizationTest, OneMarkerGivesTheRightPoseOrNone) {
  int found_count = 0;
  constexpr int kTrials = 400;
  for (int i = 0; i < kTrials; ++i) {
    const Pose truth = randomPose();
    const Relocalization found = search(room_, readSome(room_.markers, truth, 1));
    expectNoWrongPose(found, truth, 1.0);
    if (found.map_from_base) ++found_count;
  }
  EXPECT_GT(found_count, kTrials / 4);
}

TEST_F(RelocalizationTest, PoorCornersOfOneMarkerDoNotMislead) {
  // If nothing is known about how the robot stands, its pose's six numbers hide how poor the
  // corners are.
  constexpr double kPoor = 0.33;  // pixels
  constexpr int kTrials = 600;
  int found_poses = 0;
  for (int i = 0; i < kTrials; ++i) {
    Pose truth = randomPose();
    truth.z = uniform(-0.4, 0.4);
    truth.roll = uniform(-0.35, 0.35);
    truth.pitch = uniform(-0.35, 0.35);
    const auto index = static_cast<std::size_t>(i) % room_.markers.size();
    const auto exact = test::exactReading(room_.markers[index], camera_, truth);
    if (!exact) continue;
    const Relocalization found = relocalize(
        room_, camera_, {test::withNoise(*exact, kPoor, &generator_)}, PosePrior{}, {}, config_);
    if (!found.map_from_base) continue;
    ++found_poses;
    const PoseVector error = difference(found.map_from_base->pose, truth);
    // Chi-square with 6 degrees of freedom exceeds 33 once in 100 000.
    EXPECT_LT(error.dot(found.map_from_base->covariance.ldlt().solve(error)), 33.0) << i;
  }
  EXPECT_GT(found_poses, 10);
}

TEST_F(RelocalizationTest, RoughPosesOfOneMarkerAreAllFromWhichItLooksLikeThat) {
  MarkerMap twice = room_;
  for (const Marker& marker : room_.markers) {
    twice.markers.push_back(marker);
    twice.markers.back().map_from_marker.pretranslate(Eigen::Vector3d(40.0, 0.0, 0.0));
  }
  const auto posesIn = [this](const MarkerMap& map, const std::vector<MarkerReading>& readings) {
    return roughPoses(map, camera_, readings, PosePrior::upright(), {}, config_);
  };
  int uncertain = 0;
  int good = 0;
  for (int i = 0; i < 200; ++i) {
    const Pose truth = randomPose();
    const std::vector<MarkerReading> readings = readSome(room_.markers, truth, 1);
    ASSERT_EQ(readings.size(), 1U);
    const std::vector<Relocalization> found = posesIn(room_, readings);
    ASSERT_FALSE(found.empty());
    double nearest = std::numeric_limits<double>::infinity();
    for (const Relocalization& one : found) {
      ASSERT_TRUE(one.map_from_base);
      ASSERT_TRUE(one.entries[0]);
      const Marker& marker = room_.markers[*one.entries[0]];
      EXPECT_EQ(marker.id, readings[0].id);
      const auto seen = test::exactReading(marker, camera_, one.map_from_base->pose);
      ASSERT_TRUE(seen);
      double squares = 0.0;
      for (std::size_t k = 0; k < seen->corners.size(); ++k) {
        squares += (seen->corners[k] - readings[0].corners[k]).squaredNorm();
      }
      EXPECT_LE(std::sqrt(squares / 4.0), kMaxResidual);
      const Eigen::Vector3d error = difference(one.map_from_base->pose, truth).head<3>();
      nearest = std::min(nearest, error.head<2>().norm());
    }
    if (nearest < 0.3) ++good;
    if (!search(room_, readings).map_from_base) ++uncertain;
    EXPECT_TRUE(posesIn(twice, readings).empty());
    // One that the map does not have changes nothing.
    std::vector<MarkerReading> with_unknown = readings;
    with_unknown.push_back(readings[0]);
    with_unknown.back().id = 500;
    EXPECT_EQ(posesIn(room_, with_unknown).size(), found.size());
  }
  EXPECT_GT(uncertain, 20);
  EXPECT_GT(good, 150);
}

TEST_F(RelocalizationTest, SeveralMarkersHaveOneRoughPose) {
  for (int i = 0; i < 50; ++i) {
    const Pose truth = randomPose();
    const auto found = roughPoses(room_, camera_, readSome(room_.markers, truth, 3),
                                  PosePrior::upright(), {}, config_);
    ASSERT_EQ(found.size(), 1U);
    expectPose(found[0], truth, 0.05);
  }
}

TEST_F(RelocalizationTest, AmongManyMarkersOfTheSameIdsThoseTogetherAreFound) {
  // A building of such rooms, with different ids beside each other in different rooms.
  constexpr int kRooms = 40;
  MarkerMap building{"map", {}};
  for (int room = 0; room < kRooms; ++room) {
    for (std::size_t k = 0; k < room_.markers.size(); ++k) {
      Marker marker = room_.markers[k];
      const auto count = static_cast<int>(room_.markers.size());
      marker.id = room_
                      .markers[static_cast<std::size_t>(
                          (static_cast<int>(k) * (1 + room % 3) + room) % count)]
                      .id;
      marker.map_from_marker.pretranslate(Eigen::Vector3d(9.0 * (room % 8), 9.0 * (room / 8), 0.0));
      building.markers.push_back(marker);
    }
  }
  int found_count = 0;
  for (int i = 0; i < 40; ++i) {
    const Pose in_room = randomPose();
    const Pose truth{in_room.x + 9.0 * (i % 8), in_room.y + 9.0 * (i / 8), in_room.yaw};
    const auto first = building.markers.begin() + i * static_cast<int>(room_.markers.size());
    const std::vector<Marker> markers(first, first + static_cast<int>(room_.markers.size()));
    const Relocalization found = search(building, readSome(markers, truth, 5));
    expectNoWrongPose(found, truth, 0.05);
    if (found.map_from_base) ++found_count;
  }
  // Some rooms look the same.
  EXPECT_GE(found_count, 15);
}

TEST_F(RelocalizationTest, AMarkerNearbySeenFromTheSideIsEnoughAlone) {
  const Marker marker = test::wallMarker(3, {2.0, 1.0, 1.2}, kPi);
  for (const double incidence : {-50.0, -40.0, 40.0, 50.0}) {
    const double azimuth = kPi + radians(incidence);
    const Pose truth{2.0 + 1.6 * std::cos(azimuth), 1.0 + 1.6 * std::sin(azimuth), 0.3};
    const Relocalization found = search({"map", {marker}}, {*read(marker, truth)});
    expectPose(found, truth, 0.05);
  }
}

TEST_F(RelocalizationTest, IdsThatStandOnSeveralEntriesAreToldApart) {
  for (std::size_t i = 0; i < room_.markers.size(); ++i) {
    room_.markers[i].id = static_cast<int>(i % 3);
  }
  int found_count = 0;
  constexpr int kTrials = 60;
  for (int i = 0; i < kTrials; ++i) {
    const Pose truth = randomPose();
    const std::vector<MarkerReading> readings = readSome(room_.markers, truth, 5);
    const Relocalization found = search(room_, readings);
    expectNoWrongPose(found, truth, 0.05);
    if (!found.map_from_base) continue;
    ++found_count;
    for (std::size_t k = 0; k < readings.size(); ++k) {
      if (!found.entries[k]) continue;
      const auto exact = test::exactReading(room_.markers[*found.entries[k]], camera_, truth);
      ASSERT_TRUE(exact);
      EXPECT_LT((exact->center - readings[k].center).norm(), 6.0 * kNoise);
    }
  }
  EXPECT_EQ(found_count, kTrials);
}

TEST_F(RelocalizationTest, TheSameIdIsToldApartByRollAlone) {
  // Opposite each other at the same height: from the opposite point, the room looks the same except
  // for one marker's roll.
  for (const double roll : {90.0, 180.0, -90.0}) {
    const MarkerMap map{"map",
                        {test::wallMarker(4, {3.0, 0.0, 1.3}, kPi),
                         test::wallMarker(4, {-3.0, 0.0, 1.3}, 0.0, radians(roll))}};
    for (std::size_t entry = 0; entry < 2; ++entry) {
      const double side = entry == 0 ? 1.0 : -1.0;
      const Pose truth{side * 1.8, side * 1.1, 0.9};
      const Relocalization found = search(map, {*read(map.markers[entry], truth)});
      expectPose(found, truth, 0.05);
      EXPECT_EQ(found.entries[0], entry);
    }
  }
}

TEST_F(RelocalizationTest, WhatLooksTheSameInTwoRoomsGivesNoPoseUntilSomethingDiffers) {
  MarkerMap rooms = room_;
  for (Marker marker : room_.markers) {
    marker.map_from_marker.pretranslate(Eigen::Vector3d(12.0, 3.0, 0.0));
    rooms.markers.push_back(marker);
  }
  rooms.markers.push_back(test::wallMarker(50, {8.01, 4.8, 1.2}, 0.0));
  for (int i = 0; i < 12; ++i) {
    Pose truth = randomPose();
    truth.x += 12.0;
    truth.y += 3.0;
    std::vector<MarkerReading> readings =
        readSome(room_.markers, {truth.x - 12.0, truth.y - 3.0, truth.yaw}, 4);
    const Relocalization ambiguous = search(rooms, readings);
    EXPECT_FALSE(ambiguous.map_from_base);
    EXPECT_NE(ambiguous.reason.find("2 poses"), std::string::npos) << ambiguous.reason;
    EXPECT_TRUE(std::none_of(ambiguous.entries.begin(), ambiguous.entries.end(),
                             [](const auto& entry) { return entry.has_value(); }));
    auto unique = read(rooms.markers.back(), truth);
    if (!unique) continue;
    readings.push_back(std::move(*unique));
    expectPose(search(rooms, readings), truth, 0.05);
  }
}

TEST_F(RelocalizationTest, OneMarkerThatHangsElsewhereIsLeftOut) {
  for (const std::size_t count : {3U, 4U, 5U, 6U}) {
    int found_count = 0;
    constexpr int kTrials = 40;
    for (int i = 0; i < kTrials; ++i) {
      const Pose truth = randomPose();
      std::vector<MarkerReading> readings = readSome(room_.markers, truth, count);
      Marker moved = room_.markers[static_cast<std::size_t>(readings[0].id)];
      // Along its wall and into the room.
      moved.map_from_marker.translate(
          Eigen::Vector3d(uniform(0.6, 1.5), uniform(-0.2, 0.2), uniform(0.0, 0.4)));
      const auto reading = read(moved, truth);
      if (!reading) {
        ++found_count;
        continue;
      }
      readings[0] = *reading;
      const Relocalization found = search(room_, readings);
      expectNoWrongPose(found, truth, 0.08);
      if (!found.map_from_base) continue;
      ++found_count;
      EXPECT_FALSE(found.entries[0]);
    }
    // Among three, the moved one and either of the others may leave a second pose plausible.
    EXPECT_GE(found_count, count == 3 ? kTrials / 2 : kTrials * 9 / 10) << count;
  }
}

TEST_F(RelocalizationTest, OneMarkerBesideItsPlaceDoesNotDragThePoseAlong) {
  int found_count = 0;
  constexpr int kTrials = 200;
  for (int i = 0; i < kTrials; ++i) {
    const Pose truth = randomPose();
    std::vector<MarkerReading> readings = readSome(room_.markers, truth, 5);
    Marker moved = room_.markers[static_cast<std::size_t>(readings[0].id)];
    moved.map_from_marker.translate(
        Eigen::Vector3d(uniform(0.1, 0.3), uniform(-0.1, 0.1), uniform(0.0, 0.3)));
    const auto reading = read(moved, truth);
    if (!reading) continue;
    readings[0] = *reading;
    const Relocalization found = search(room_, readings);
    expectNoWrongPose(found, truth, 0.05);
    if (found.map_from_base) ++found_count;
  }
  EXPECT_GE(found_count, kTrials * 8 / 10);
}

TEST_F(RelocalizationTest, TwoOfFiveInAWrongDirectionAreLeftOut) {
  for (const auto& [count, wrong] : {std::pair<std::size_t, std::size_t>(5, 2), {7, 2}}) {
    for (int i = 0; i < 60; ++i) {
      const Pose truth = randomPose();
      std::vector<MarkerReading> readings = readSome(room_.markers, truth, count);
      ASSERT_GE(readings.size(), 5U);
      for (std::size_t k = 0; k < wrong; ++k) {
        const double angle = (k % 2 == 0 ? 1.0 : -1.0) * uniform(0.4, 2.8);
        readings[k] = readTurned(readings[k].id, truth, angle);
      }
      const Relocalization found = search(room_, readings);
      expectPose(found, truth, 0.05);
      for (std::size_t k = 0; k < readings.size(); ++k) {
        EXPECT_EQ(found.entries[k].has_value(), k >= wrong) << k;
        EXPECT_EQ(std::isnan(found.misfits[k].residual), k < wrong) << k;
      }
    }
  }
}

TEST_F(RelocalizationTest, TwoThatContradictEachOtherGiveNoPose) {
  for (int i = 0; i < 150; ++i) {
    const Pose truth = randomPose();
    std::vector<MarkerReading> readings = readSome(room_.markers, truth, 2);
    readings[1] = readTurned(readings[1].id, truth, uniform(0.8, 5.0));
    const Relocalization found = search(room_, readings);
    EXPECT_FALSE(found.map_from_base);
    EXPECT_NE(found.reason, "");
  }
}

TEST_F(RelocalizationTest, AnEntryIsInOnePlaceOnly) {
  for (int i = 0; i < 60; ++i) {
    const Pose truth = randomPose();
    std::vector<MarkerReading> readings = readSome(room_.markers, truth, 3);
    readings.insert(readings.begin(), readTurned(readings[1].id, truth, uniform(0.5, 2.5)));
    // Read twice at the same place.
    readings.push_back(test::withNoise(readings[1], kNoise, &generator_));
    const Relocalization found = search(room_, readings);
    expectPose(found, truth, 0.06);
    EXPECT_FALSE(found.entries[0]);
    EXPECT_NE(found.entries[1].has_value(), found.entries[4].has_value());
    EXPECT_TRUE(found.entries[2]);
    EXPECT_TRUE(found.entries[3]);
  }
}

TEST_F(RelocalizationTest, WhatIsNotInTheMapDoesNotMatter) {
  const Pose truth = randomPose();
  std::vector<MarkerReading> readings = readSome(room_.markers, truth, 3);
  readings[1].id = 99;
  MarkerReading other_family = readings[2];
  other_family.family = "tag16h5";
  readings.push_back(other_family);
  const Relocalization found = search(room_, readings);
  expectPose(found, truth, 0.05);
  EXPECT_TRUE(found.entries[0]);
  EXPECT_FALSE(found.entries[1]);
  EXPECT_TRUE(found.entries[2]);
  EXPECT_FALSE(found.entries[3]);
}

TEST_F(RelocalizationTest, NothingOfTheMapGivesNoPose) {
  const Relocalization empty = search(room_, {});
  EXPECT_FALSE(empty.map_from_base);
  EXPECT_NE(empty.reason, "");
  EXPECT_TRUE(empty.entries.empty());

  std::vector<MarkerReading> readings = readSome(room_.markers, randomPose(), 2);
  for (MarkerReading& reading : readings) reading.id += 100;
  const Relocalization unknown = search(room_, readings);
  EXPECT_FALSE(unknown.map_from_base);
  EXPECT_NE(unknown.reason, "");
  EXPECT_EQ(unknown.entries.size(), 2U);
  EXPECT_EQ(unknown.misfits.size(), 2U);

  EXPECT_FALSE(search({"map", {}}, readings).map_from_base);
}

TEST_F(RelocalizationTest, ManyCorrectedBitsAreNotBelievedAlone) {
  const Marker marker = test::wallMarker(3, {2.0, 1.0, 1.2}, kPi);
  const Marker other = test::wallMarker(4, {-1.0, 3.0, 1.2}, -kPi / 2);
  const Pose truth{0.8, 0.0, 0.3};
  std::vector<MarkerReading> readings = {*read(marker, truth)};
  readings[0].hamming = config_.max_hamming_of_one;
  expectPose(search({"map", {marker, other}}, readings), truth, 0.05);
  readings[0].hamming = config_.max_hamming_of_one + 1;
  EXPECT_FALSE(search({"map", {marker, other}}, readings).map_from_base);
  readings.push_back(*read(other, truth));
  readings[1].hamming = config_.max_hamming_of_one + 1;
  expectPose(search({"map", {marker, other}}, readings), truth, 0.05);
}

TEST_F(RelocalizationTest, ABadFitIsNotBelievedAlone) {
  const Marker marker = test::wallMarker(3, {2.0, 1.0, 1.2}, kPi);
  MarkerReading reading = *read(marker, {0.8, 0.0, 0.3});
  reading.corners[2] += Eigen::Vector2d(2.0, 1.5);
  EXPECT_FALSE(search({"map", {marker}}, {reading}).map_from_base);
}

}  // namespace
}  // namespace omnitag
