#include "adjustment/map_builder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "simulated_recording.h"

namespace omnitag {
namespace {

constexpr double kNoise = 0.05;  // pixels

MapBuilderConfig config() {
  MapBuilderConfig result;
  result.size = 0.8;
  // The floor of the recordings is even.
  result.motion.floor.lean_deviation = 0.0;
  result.motion.floor.height_deviation = 0.0;
  return result;
}

MarkerMap seed(std::size_t count) {
  const std::vector<Marker> all = test::roomMarkers();
  return {"map", {all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count)}};
}

double turnBetween(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle();
}

const BuiltMarker* find(const BuiltMap& map, int id) {
  const auto found = std::find_if(map.markers.begin(), map.markers.end(),
                                  [id](const BuiltMarker& each) { return each.marker.id == id; });
  return found == map.markers.end() ? nullptr : &*found;
}

/// What buildMap says if it refuses; empty if it does not.
std::string refusal(const std::vector<FrameReadings>& frames, const MarkerMap& seed_map) {
  try {
    buildMap(test::sphericalCamera(), frames, seed_map, config());
    return "";
  } catch (const DegenerateRecording& error) {
    return error.what();
  }
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

class MapBuilderTest : public testing::TestWithParam<bool> {};

TEST_P(MapBuilderTest, FromASeedFindsTheOthers) {
  const std::vector<Marker> truth = test::roomMarkers();
  const std::vector<Pose> poses = test::roundTrip(40);
  const BuiltMap map = buildMap(test::sphericalCamera(),
                                test::record(truth, poses, kNoise, GetParam()), seed(3), config());
  ASSERT_EQ(map.markers.size(), truth.size());
  double squares = 0.0;
  int new_markers = 0;
  for (const Marker& marker : truth) {
    const BuiltMarker* built = find(map, marker.id);
    ASSERT_NE(built, nullptr) << marker.id;
    if (built->is_seed) {
      EXPECT_TRUE(built->marker.map_from_marker.isApprox(marker.map_from_marker, 1e-15));
      continue;
    }
    const Eigen::Vector3d error = built->marker.center() - marker.center();
    EXPECT_LT(error.norm(), 0.005) << marker.id;
    EXPECT_LT(turnBetween(built->marker.map_from_marker, marker.map_from_marker), radians(0.3));
    squares += error.dot(built->covariance.topLeftCorner<3, 3>().ldlt().solve(error));
    ++new_markers;
    EXPECT_LT(built->residual, 2.0 * kNoise);
  }
  EXPECT_TRUE(map.remarks.empty());
  ASSERT_EQ(map.trajectory.size(), poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_LT(test::positionError(map.trajectory[i], poses[i]), 0.003);
  }
  // The errors are neither larger than the covariances say nor much smaller: `corner_noise` is
  // twice the noise here, so chi-square with three degrees of freedom per marker has a quarter of
  // its mean.
  EXPECT_LT(squares / new_markers, 3.0);
  EXPECT_GT(squares / new_markers, 0.1);
}

TEST_P(MapBuilderTest, FromASeedFindsTheOthersInSomebodysHand) {
  const std::vector<Marker> truth = test::roomMarkers();
  std::vector<Pose> poses = test::roundTrip(40);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const double t = 0.25 * static_cast<double>(i);
    poses[i].z = 0.3 * std::sin(1.1 * t);
    poses[i].roll = radians(20.0) * std::sin(1.7 * t + 1.0);
    poses[i].pitch = radians(20.0) * std::sin(1.3 * t);
  }
  MapBuilderConfig free = config();
  free.motion.pose_model = PoseModel::kFree;
  const BuiltMap map = buildMap(test::sphericalCamera(),
                                test::record(truth, poses, kNoise, GetParam()), seed(3), free);
  ASSERT_EQ(map.markers.size(), truth.size());
  for (const Marker& marker : truth) {
    const BuiltMarker* built = find(map, marker.id);
    ASSERT_NE(built, nullptr) << marker.id;
    EXPECT_LT((built->marker.center() - marker.center()).norm(), 0.01) << marker.id;
    EXPECT_LT(turnBetween(built->marker.map_from_marker, marker.map_from_marker), radians(0.5));
  }
  ASSERT_EQ(map.trajectory.size(), poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const PoseVector error = difference(map.trajectory[i], poses[i]);
    EXPECT_LT(translationPart(error).norm(), 0.01) << i;
    EXPECT_LT(rotationPart(error).norm(), radians(0.3)) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Odometry, MapBuilderTest, testing::Bool(), [](const auto& test) {
  return test.param ? "WithOdometry" : "WithoutOdometry";
});

/// A survey's map whose markers hang elsewhere than it says, each off by about its deviation.
MarkerMap roughSurvey(double deviation, double orientation_deviation) {
  std::mt19937 random(21);
  std::normal_distribution<double> normal(0.0, 1.0);
  MarkerMap map{"map", test::roomMarkers()};
  for (Marker& marker : map.markers) {
    MarkerIncrement increment;
    for (Eigen::Index i = 0; i < 6; ++i) {
      increment(i) = (i < 3 ? deviation : orientation_deviation) * normal(random);
    }
    marker.map_from_marker = moved(marker.map_from_marker, increment);
    marker.deviation = deviation;
    marker.orientation_deviation = orientation_deviation;
  }
  return map;
}

/// m: how far the distances between the markers of a map are off, RMS.
double distanceError(const BuiltMap& map) {
  const std::vector<Marker> truth = test::roomMarkers();
  double squares = 0.0;
  int count = 0;
  for (const Marker& a : truth) {
    for (const Marker& b : truth) {
      if (a.id >= b.id || find(map, a.id) == nullptr || find(map, b.id) == nullptr) continue;
      const double found =
          (find(map, a.id)->marker.center() - find(map, b.id)->marker.center()).norm();
      squares += std::pow(found - (a.center() - b.center()).norm(), 2);
      ++count;
    }
  }
  return std::sqrt(squares / count);
}

TEST(MapBuilderSurveyTest, ARoughSurveyComesBack) {
  const MarkerMap survey = roughSurvey(0.02, radians(3.0));
  const auto frames = test::record(test::roomMarkers(), test::roundTrip(40), kNoise);
  const BuiltMap map = buildMap(test::sphericalCamera(), frames, survey, config());
  ASSERT_EQ(map.markers.size(), survey.markers.size());
  EXPECT_LT(distanceError(map), 0.004);
  double squares = 0.0;
  for (std::size_t i = 0; i < map.markers.size(); ++i) {
    const BuiltMarker& built = map.markers[i];
    EXPECT_TRUE(built.is_seed);
    EXPECT_FALSE(built.is_exact);
    const double far = (built.marker.center() - survey.markers[i].center()).norm();
    EXPECT_LT(far, 5.0 * 0.02) << built.marker.id;
    squares += built.covariance.topLeftCorner<3, 3>().trace();
  }
  // Within the map, the markers are known several times better than in the survey.
  EXPECT_LT(std::sqrt(squares / 30.0), 0.005);
}

TEST(MapBuilderSurveyTest, ATapeSetsTheScale) {
  // All markers are 1 % larger than configured.
  MapBuilderConfig wrong = config();
  wrong.size = 0.8 / 1.01;
  const std::vector<Marker> truth = test::roomMarkers();
  const auto frames = test::record(truth, test::roundTrip(40), kNoise);
  const BuiltMap small = buildMap(test::sphericalCamera(), frames, {}, wrong);
  EXPECT_GT(distanceError(small), 0.03);
  MapConstraint tape;
  tape.markers = {{"", 0}, {"", 5}};
  tape.value = (truth[0].center() - truth[5].center()).norm();
  tape.deviation = 0.001;
  wrong.estimates_sizes = true;
  wrong.constraints = {tape};
  const auto with_odometry = test::record(truth, test::roundTrip(40), kNoise, true);
  const BuiltMap taped = buildMap(test::sphericalCamera(), with_odometry, {}, wrong);
  EXPECT_LT(distanceError(taped), 0.012);
}

TEST(MapBuilderSurveyTest, NamesBothSidesOfAContradiction) {
  const std::vector<Marker> truth = test::roomMarkers();
  MapBuilderConfig with_tape = config();
  MapConstraint height;
  height.kind = MapConstraint::Kind::kHeight;
  height.markers = {{"", 6}};
  height.value = truth[6].center().z() + 0.1;
  height.deviation = 0.003;
  MapConstraint right = height;
  right.markers = {{"", 7}};
  right.value = truth[7].center().z();
  with_tape.constraints = {height, right};
  const auto frames = test::record(truth, test::roundTrip(40), kNoise);
  const BuiltMap map = buildMap(test::sphericalCamera(), frames, seed(3), with_tape);
  ASSERT_EQ(map.remarks.size(), 1U);
  const std::string begin = "height of 6: 1.5000 m was measured, the images tell ";
  ASSERT_EQ(map.remarks[0].find(begin), 0U) << map.remarks[0];
  EXPECT_NEAR(std::stod(map.remarks[0].substr(begin.size())), truth[6].center().z(), 0.005);
  EXPECT_LT((find(map, 6)->marker.center() - truth[6].center()).norm(), 0.02);
}

TEST(MapBuilderWithoutSeedTest, DoesNotKnowWhichWayIsUpInSomebodysHand) {
  MapBuilderConfig free = config();
  free.motion.pose_model = PoseModel::kFree;
  const auto frames = test::record(test::roomMarkers(), test::roundTrip(40), kNoise);
  EXPECT_THROW(buildMap(test::sphericalCamera(), frames, {}, free), DegenerateRecording);
}

TEST(MapBuilderWithoutSeedTest, StandsOnTheMarkerThatIsReadFirst) {
  const std::vector<Marker> truth = test::roomMarkers();
  const std::vector<FrameReadings> frames = test::record(truth, test::roundTrip(40), kNoise);
  const BuiltMap map = buildMap(test::sphericalCamera(), frames, {}, config());
  ASSERT_EQ(map.markers.size(), truth.size());

  // The first image's largest marker is upright above the origin and looks along x.
  const auto& readings = frames.front().readings;
  const auto largest = std::max_element(readings.begin(), readings.end(),
                                        [](const MarkerReading& a, const MarkerReading& b) {
                                          return meanEdge(a.corners) < meanEdge(b.corners);
                                        });
  const Marker& first = find(map, largest->id)->marker;
  EXPECT_LT(first.center().head<2>().norm(), 1e-9);
  EXPECT_NEAR(first.center().z(), truth[static_cast<std::size_t>(first.id)].center().z(), 0.005);
  EXPECT_NEAR(first.normal().y(), 0.0, 1e-6);
  EXPECT_NEAR(first.normal().x(), 1.0, 1e-3);

  // Relative to that one, all others hang as they do in the room.
  const Marker& first_truth = truth[static_cast<std::size_t>(first.id)];
  for (const Marker& marker : truth) {
    const Marker& built = find(map, marker.id)->marker;
    const Eigen::Isometry3d between = first.map_from_marker.inverse() * built.map_from_marker;
    const Eigen::Isometry3d between_truth =
        first_truth.map_from_marker.inverse() * marker.map_from_marker;
    EXPECT_LT(turnBetween(between, between_truth), radians(0.5)) << marker.id;
    EXPECT_NEAR(between.translation().norm(), between_truth.translation().norm(), 0.02);
  }
}

TEST(MapBuilderChecksTest, NamesAMarkerThatMoved) {
  std::vector<Marker> markers = test::roomMarkers();
  const std::vector<Pose> poses = test::roundTrip(48);
  const std::vector<Pose> before(poses.begin(), poses.begin() + 24);
  const std::vector<Pose> after(poses.begin() + 24, poses.end());
  std::vector<FrameReadings> frames = test::record(markers, before, kNoise);
  // Marker 5 can be read in both halves.
  markers[5].map_from_marker.translation() += Eigen::Vector3d(0.0, 0.3, 0.1);
  for (FrameReadings& frame : test::record(markers, after, kNoise)) {
    frame.stamp += 6.0;
    frames.push_back(frame);
  }
  const BuiltMap map = buildMap(test::sphericalCamera(), frames, seed(3), config());
  EXPECT_EQ(find(map, 5), nullptr);
  ASSERT_EQ(map.remarks.size(), 1U);
  EXPECT_TRUE(has(map.remarks[0], "marker 5 moved by 0.3")) << map.remarks[0];
  for (const Marker& marker : test::roomMarkers()) {
    if (marker.id == 5) continue;
    EXPECT_LT((find(map, marker.id)->marker.center() - marker.center()).norm(), 0.005);
  }
}

TEST(MapBuilderChecksTest, NamesAMarkerOfAnotherSize) {
  std::vector<Marker> markers = test::roomMarkers();
  markers[6].size = 0.5;
  const std::vector<FrameReadings> frames = test::record(markers, test::roundTrip(48), kNoise);
  const BuiltMap map = buildMap(test::sphericalCamera(), frames, seed(3), config());
  EXPECT_EQ(find(map, 6), nullptr);
  ASSERT_EQ(map.remarks.size(), 1U);
  EXPECT_EQ(map.remarks[0].find("marker 6 left out: its readings tell a size of 0.50"), 0U)
      << map.remarks[0];
  EXPECT_TRUE(has(map.remarks[0], "--estimate-sizes")) << map.remarks[0];
  for (const Marker& marker : test::roomMarkers()) {
    if (marker.id == 6) continue;
    EXPECT_LT((find(map, marker.id)->marker.center() - marker.center()).norm(), 0.005);
  }

  MapBuilderConfig with_sizes = config();
  with_sizes.estimates_sizes = true;
  const BuiltMap sized = buildMap(test::sphericalCamera(), frames, seed(3), with_sizes);
  ASSERT_NE(find(sized, 6), nullptr);
  EXPECT_NEAR(find(sized, 6)->marker.size, 0.5, 0.005);
}

TEST(MapBuilderResultTest, TellsWhatPicturesAndAdviceNeed) {
  MarkerMap soft = seed(3);
  for (Marker& marker : soft.markers) marker.deviation = 0.005;
  const std::vector<Pose> poses = test::roundTrip(40);
  std::vector<std::string> steps;
  const BuiltMap map = buildMap(
      test::sphericalCamera(), test::record(test::roomMarkers(), poses, kNoise), soft, config(),
      nullptr,
      [&steps](const std::string& step, std::size_t, std::size_t) { steps.push_back(step); });
  EXPECT_EQ(steps, (std::vector<std::string>{"placing markers", "adjusting poses and markers"}));
  std::vector<double> squares(map.markers.size());
  std::vector<std::size_t> corners(map.markers.size());
  for (const CornerResidual& corner : map.residuals) {
    ASSERT_LT(corner.frame, map.stamps.size());
    ASSERT_TRUE(corner.residual);
    squares.at(corner.landmark) += corner.residual->squaredNorm();
    ++corners.at(corner.landmark);
  }
  const Eigen::Vector3d mounting = test::lookingDown().translation();
  for (std::size_t i = 0; i < map.markers.size(); ++i) {
    const BuiltMarker& built = map.markers[i];
    EXPECT_EQ(corners[i], 4 * built.sightings);
    EXPECT_NEAR(std::sqrt(squares[i] / static_cast<double>(corners[i])), built.residual, 1e-9);
    ASSERT_EQ(built.survey.has_value(), i < 3);
    if (built.survey) {
      EXPECT_TRUE(built.survey->map_from_marker.isApprox(soft.markers[i].map_from_marker));
      EXPECT_EQ(built.survey->deviations(0), 0.005);
    }
    // The robot is never nearer to a marker than this, whether it reads it there or not.
    double nearest = 100.0;
    for (const Pose& pose : poses) {
      nearest = std::min(nearest, (pose.toIsometry() * mounting - built.marker.center()).norm());
    }
    EXPECT_GT(built.seen.nearest, nearest - 0.01);
    EXPECT_LT(built.seen.nearest, 6.5);
    EXPECT_GT(built.seen.parallax, radians(10.0));
  }
}

TEST(MapBuilderChecksTest, NamesASeedsMarkerOfAnotherSize) {
  std::vector<Marker> markers = test::roomMarkers();
  markers[2].size = 0.5;
  const BuiltMap map =
      buildMap(test::sphericalCamera(), test::record(markers, test::roundTrip(48), kNoise), seed(4),
               config());
  ASSERT_EQ(map.remarks.size(), 1U);
  EXPECT_EQ(map.remarks[0].find("marker 2: its readings tell a size of 0.50"), 0U)
      << map.remarks[0];
}

TEST(MapBuilderChecksTest, SaysWhatIsMissing) {
  const std::vector<Marker> all = test::roomMarkers();
  const std::vector<Pose> poses = test::roundTrip(30);

  const std::vector<Pose> still(20, Pose{0.3, 0.2, 0.5});
  EXPECT_TRUE(has(refusal(test::record(all, still, kNoise), seed(3)), "too little motion"));
  EXPECT_TRUE(has(refusal(test::record(all, still, kNoise), {}), "too little motion"));

  EXPECT_TRUE(has(refusal(test::record({all[2]}, poses, kNoise), {}), "only marker 2 was read"));
  EXPECT_TRUE(has(refusal(test::record({}, poses, kNoise), {}), "no marker was read"));
  EXPECT_TRUE(has(refusal(test::record(all, poses, kNoise), {"map", all}), "nothing to add"));
  EXPECT_TRUE(has(refusal(test::record({all[4], all[5], all[6]}, poses, kNoise), seed(3)),
                  "none of the seed's 3 markers"));

  // Three side by side, seen from afar.
  const std::vector<Marker> one_side = {test::wallMarker(1, {4.0, -0.9, 1.1}, kPi),
                                        test::wallMarker(2, {4.0, 0.1, 1.5}, kPi),
                                        test::wallMarker(3, {4.0, 1.1, 0.9}, kPi)};
  std::vector<Pose> aside;
  for (int i = 0; i < 20; ++i) aside.push_back({0.0, -0.8 + 0.08 * i, 0.02 * i});
  EXPECT_TRUE(has(refusal(test::record(one_side, aside, kNoise), {}), "on one side only"));

  std::vector<Marker> twice = all;
  twice.push_back(test::wallMarker(7, {2.6, 4.0, 1.7}, -kPi / 2));
  EXPECT_TRUE(has(refusal(test::record(twice, poses, kNoise), seed(3)), "marker 7 hangs at 2"));
}

}  // namespace
}  // namespace omnitag
