#include "adjustment/marker_mapper.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "../support/panorama_renderer.h"
#include "../support/sweep.h"
#include "omnitag/common/error.h"
#include "omnitag/localization/localizer.h"
#include "simulated_recording.h"

namespace omnitag {
namespace {

MarkerMap roomMap(std::size_t count) {
  const std::vector<Marker> all = test::roomMarkers();
  MarkerMap map{"map", {all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count)}};
  map.default_family = "tag36h11";
  map.default_size = 0.8;
  return map;
}

/// A localizer's result for a frame whose pose is based on marker 0.
FrameResult resultOf(const FrameReadings& frame, const Pose& pose, double deviation) {
  FrameResult result;
  result.stamp = frame.stamp;
  const Eigen::Vector3d variances(deviation * deviation, deviation * deviation, 1e-8);
  result.map_from_base = floorEstimate(pose, variances.asDiagonal());
  MarkerDetection known;
  known.accepted = true;
  known.map_entry = 0;
  known.range = 2.0;
  result.detections.push_back(known);
  result.explored = frame.readings;
  return result;
}

class MarkerMapperTest : public testing::Test {
 protected:
  /// Feeds a recording; returns how often the map changed.
  int feed(MarkerMapper* mapper, const std::vector<Marker>& markers, const std::vector<Pose>& poses,
           double deviation = 1e-3) {
    int changes = 0;
    const auto frames = test::record(markers, poses, 0.05);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const Frame frame{frames[i].stamp, {}, frames[i].base_from_camera, std::nullopt};
      changes += mapper->add(frame, resultOf(frames[i], poses[i], deviation)) ? 1 : 0;
    }
    return changes;
  }

  std::shared_ptr<const CameraModel> camera_ = test::sphericalCamera();
  MarkerMapperConfig config_;
};

TEST_F(MarkerMapperTest, AddsWhatItSeesAndNeverTouchesTheMap) {
  MarkerMapper mapper({camera_}, roomMap(2), config_);
  feed(&mapper, test::roomMarkers(), test::roundTrip(40));
  const std::vector<Marker> truth = test::roomMarkers();
  ASSERT_EQ(mapper.map().markers.size(), truth.size());
  for (std::size_t i = 0; i < mapper.map().markers.size(); ++i) {
    const Marker& marker = mapper.map().markers[i];
    const Marker& true_marker = truth[static_cast<std::size_t>(marker.id)];
    const double error = (marker.center() - true_marker.center()).norm();
    if (i < 2) {
      EXPECT_EQ(error, 0.0);
      EXPECT_EQ(marker.deviation, 0.0);
    } else {
      EXPECT_LT(error, 0.01) << marker.id;
      EXPECT_LT(error, 4.0 * marker.deviation) << marker.id;
      EXPECT_LE(marker.deviation, config_.max_position_deviation);
    }
  }
}

TEST_F(MarkerMapperTest, NothingWithoutMotionOrAPoseThatIsSure) {
  MarkerMapper still({camera_}, roomMap(2), config_);
  EXPECT_EQ(feed(&still, test::roomMarkers(), std::vector<Pose>(30, Pose{0.5, 0.2, 0.1})), 0);
  EXPECT_EQ(still.map().markers.size(), 2U);
  // What it has seen can be shown.
  ASSERT_FALSE(still.provisional().empty());
  EXPECT_EQ(still.provisional().front().sightings, 1U);
  EXPECT_FALSE(still.provisional().front().is_used);

  MarkerMapper unsure({camera_}, roomMap(2), config_);
  EXPECT_EQ(feed(&unsure, test::roomMarkers(), test::roundTrip(40), 0.1), 0);
  EXPECT_TRUE(unsure.provisional().empty());
}

TEST_F(MarkerMapperTest, VaguePosesMakeVagueMarkers) {
  if (test::kIsSanitized) GTEST_SKIP() << test::kRepeats;
  MarkerMapper sure({camera_}, roomMap(2), config_);
  feed(&sure, test::roomMarkers(), test::roundTrip(40), 1e-4);
  MarkerMapper vague({camera_}, roomMap(2), config_);
  feed(&vague, test::roomMarkers(), test::roundTrip(40), 0.01);
  for (std::size_t i = 0; i < vague.provisional().size(); ++i) {
    EXPECT_LT(sure.provisional()[i].estimate.positionDeviation(),
              vague.provisional()[i].estimate.positionDeviation());
  }
}

TEST_F(MarkerMapperTest, KeepsEntriesWhenItsOwnMarkersAreReplaced) {
  MarkerMapper mapper({camera_}, roomMap(2), config_);
  feed(&mapper, test::roomMarkers(), test::roundTrip(40));
  const auto idsOf = [](const MarkerMap& map) {
    std::vector<int> ids;
    for (const Marker& marker : map.markers) ids.push_back(marker.id);
    return ids;
  };
  const std::vector<int> before = idsOf(mapper.map());
  ASSERT_FALSE(std::is_sorted(before.begin(), before.end())) << "entries are in order of discovery";
  mapper.setOwn(roomMap(2));
  EXPECT_EQ(idsOf(mapper.map()), before);
}

TEST_F(MarkerMapperTest, AnIdAtTwoPlacesIsNotUsed) {
  std::vector<Marker> markers = test::roomMarkers();
  markers.push_back(test::wallMarker(5, {2.6, 4.0, 1.7}, -kPi / 2));
  MarkerMapper mapper({camera_}, roomMap(2), config_);
  feed(&mapper, markers, test::roundTrip(40));
  EXPECT_TRUE(entriesOf(mapper.map(), "tag36h11", 5).empty());
  EXPECT_EQ(mapper.map().markers.size(), test::roomMarkers().size() - 1);
}

TEST_F(MarkerMapperTest, AMarkerThatIsCarriedOffIsNotUsedWhereItHung) {
  const std::vector<Pose> poses = test::roundTrip(40);
  std::vector<Marker> markers = test::roomMarkers();
  constexpr std::size_t kCarried = 5;
  constexpr std::ptrdiff_t kBefore = 3;  // one sighting too few
  MarkerMapper mapper({camera_}, roomMap(2), config_);
  feed(&mapper, markers, {poses.begin(), poses.begin() + kBefore});
  markers[kCarried].map_from_marker.translation().y() -= 0.3;
  for (auto pose = poses.begin() + kBefore; pose != poses.end(); ++pose) {
    feed(&mapper, markers, {*pose});
    for (const Marker& marker : mapper.map().markers) {
      const Marker& truth = markers[static_cast<std::size_t>(marker.id)];
      EXPECT_LT((marker.center() - truth.center()).norm(), 0.05) << marker.id;
    }
  }
  EXPECT_GE(mapper.map().markers.size(), markers.size() - 1);
}

TEST_F(MarkerMapperTest, KeepsABoundedNumberOfSightings) {
  if (test::kIsSanitized) GTEST_SKIP() << test::kRepeats;
  MarkerMapper all({camera_}, roomMap(2), config_);
  feed(&all, test::roomMarkers(), test::roundTrip(60));
  config_.max_sightings = 6;
  MarkerMapper few({camera_}, roomMap(2), config_);
  feed(&few, test::roomMarkers(), test::roundTrip(60));
  ASSERT_EQ(few.provisional().size(), all.provisional().size());
  for (std::size_t i = 0; i < few.provisional().size(); ++i) {
    EXPECT_LE(few.provisional()[i].sightings, 6U);
    EXPECT_GT(few.provisional()[i].parallax, 0.6 * all.provisional()[i].parallax);
  }
}

TEST_F(MarkerMapperTest, WantsToSeeAgainWhatIsNotGoodEnough) {
  MarkerMapper mapper({camera_}, roomMap(2), config_);
  const std::vector<Pose> poses = test::roundTrip(40);
  feed(&mapper, test::roomMarkers(), {poses.front(), poses.back()});
  const std::vector<Marker> unfinished = mapper.unfinished();
  ASSERT_GE(unfinished.size(), 5U);
  for (const Marker& marker : unfinished) {
    const Marker truth = test::roomMarkers()[static_cast<std::size_t>(marker.id)];
    const double off = (marker.center() - truth.center()).norm();
    EXPECT_GT(marker.deviation, 0.0);
    EXPECT_LT(off, 4.0 * marker.deviation) << marker.id;
  }
  MarkerMapper finished({camera_}, roomMap(2), config_);
  feed(&finished, test::roomMarkers(), poses);
  EXPECT_TRUE(finished.unfinished().empty());
}

TEST_F(MarkerMapperTest, WhatIsSavedStays) {
  MarkerMapper mapper({camera_}, roomMap(2), config_);
  feed(&mapper, test::roomMarkers(), test::roundTrip(40));
  const MarkerMap before = mapper.map();
  mapper.setOwn(before);
  EXPECT_TRUE(mapper.provisional().empty());
  EXPECT_EQ(feed(&mapper, test::roomMarkers(), test::roundTrip(30, 1.2)), 0);
  for (std::size_t i = 0; i < before.markers.size(); ++i) {
    EXPECT_EQ(mapper.map().markers[i].center(), before.markers[i].center());
  }
}

TEST_F(MarkerMapperTest, NeedsASize) {
  MarkerMap map = roomMap(2);
  map.default_size = 0.0;
  EXPECT_THROW(MarkerMapper({camera_}, map, config_), InputError);
  config_.size = 0.8;
  EXPECT_NO_THROW(MarkerMapper({camera_}, map, config_));
}

TEST(MappingLocalizerTest, LocalizesByWhatItHasMapped) {
  const auto camera = test::sphericalCamera();
  const Eigen::Isometry3d mounting = test::lookingDown();
  const MarkerMap all{"map", test::roomMarkers()};
  const MarkerMap known = roomMap(4);
  LocalizerConfig config;
  config.exploring_views = 2;
  Localizer localizer(camera, known, config);
  MarkerMapper mapper({camera}, known, {});
  const std::vector<Pose> poses = test::roundTrip(36, 1.0);
  localizer.setPose(poses.front());
  int used_new = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Frame frame{0.25 * static_cast<double>(i),
                      test::renderPanorama(all, {camera, mounting}, poses[i], 2), mounting,
                      std::nullopt};
    const FrameResult result = localizer.process(frame);
    ASSERT_TRUE(result.map_from_base) << i;
    EXPECT_LT(test::positionError(result.map_from_base->pose, poses[i]), 0.02) << i;
    for (const MarkerDetection& detection : result.detections) {
      used_new += detection.accepted && *detection.map_entry >= known.markers.size() ? 1 : 0;
    }
    if (mapper.add(frame, result)) localizer.setMap(mapper.map());
    localizer.seek(mapper.unfinished());
  }
  EXPECT_EQ(mapper.map().markers.size(), all.markers.size());
  EXPECT_GT(used_new, 10);
  for (const Marker& marker : mapper.map().markers) {
    const Marker& truth = all.markers[static_cast<std::size_t>(marker.id)];
    EXPECT_LT((marker.center() - truth.center()).norm(), 0.04) << marker.id;
  }
}

}  // namespace
}  // namespace omnitag
