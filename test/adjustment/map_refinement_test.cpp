#include "adjustment/map_refinement.h"

#include <gtest/gtest.h>

#include <random>

#include "../support/panorama_renderer.h"
#include "adjustment/bundle_adjustment.h"
#include "adjustment/key_frame.h"
#include "adjustment/mapped_entries.h"
#include "omnitag/marker/marker_map_file.h"
#include "simulated_recording.h"

namespace omnitag {
namespace {

constexpr double kDeviation = 0.005;
const double kOrientationDeviation = radians(1.0);

/// The file's map: each marker as far off its true place as its deviations say.
MarkerMap surveyed(const std::vector<Marker>& truth, std::mt19937* random) {
  std::normal_distribution<double> normal;
  MarkerMap map{"map", truth};
  for (Marker& marker : map.markers) {
    MarkerIncrement increment;
    for (int i = 0; i < 6; ++i) {
      increment(i) = (i < 3 ? kDeviation : kOrientationDeviation) * normal(*random);
    }
    marker.map_from_marker = moved(marker.map_from_marker, increment);
    marker.deviation = kDeviation;
    marker.orientation_deviation = kOrientationDeviation;
  }
  return map;
}

MotionModelConfig evenFloor() {
  MotionModelConfig motion;
  motion.floor.lean_deviation = 0.0;
  motion.floor.height_deviation = 0.0;
  return motion;
}

/// How far a map is off as a whole, in its plane.
Eigen::Vector3d meanError(const MarkerMap& map, const std::vector<Marker>& truth) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < truth.size(); ++i) {
    sum += map.markers[i].center() - truth[i].center();
  }
  return sum / static_cast<double>(truth.size());
}

class KeyFrameTest : public testing::TestWithParam<bool> {};

/// All images at once, by Ceres, tell the same of the markers as one after the other.
TEST_P(KeyFrameTest, TellsWhatABatchAdjustmentTells) {
  const bool is_free = GetParam();
  constexpr double kNoise = 0.05;  // pixels
  std::mt19937 random(4);
  const std::vector<Marker> truth = test::roomMarkers();
  const MarkerMap file = surveyed(truth, &random);
  const auto camera = test::sphericalCamera();
  const MountedCamera mounted(camera, test::lookingDown());

  JointEstimate joint;
  joint.append(Eigen::VectorXd::Constant(kStandingNumbers, 1e-12));
  joint.append(Eigen::VectorXd::Ones(kCameraModes));
  std::vector<Eigen::Index> increments;
  for (const Marker& marker : file.markers) {
    increments.push_back(joint.mean.size());
    Eigen::VectorXd variances(6);
    variances << Eigen::Vector3d::Constant(std::pow(marker.deviation, 2)),
        Eigen::Vector3d::Constant(std::pow(marker.orientation_deviation, 2));
    joint.append(variances);
  }
  Bundle bundle;
  bundle.model = std::make_shared<CalibrationModel>(camera);
  for (const Marker& marker : file.markers) {
    bundle.landmarks.push_back({marker, PlacePrior::surveyed(marker), true});
  }
  const std::vector<Pose> poses = test::roundTrip(12);
  for (const FrameReadings& frame : test::record(truth, poses, kNoise)) {
    const std::size_t index = bundle.frames.size();
    KeyFrame key{mounted, poses[index], {}, std::nullopt, {}, kStandingNumbers};
    if (!is_free) key.standing_deviations = standingDeviations(evenFloor().floor);
    for (const MarkerReading& reading : frame.readings) {
      const auto entry = static_cast<std::size_t>(reading.id);
      const AlignedCorners corners{stacked(reading.corners),
                                   kNoise * kNoise * Eigen::Matrix<double, 8, 8>::Identity()};
      key.sights.push_back({entry, file.markers[entry], corners, increments[entry]});
      bundle.observations.push_back({index, entry, corners.pixels});
    }
    bundle.frames.push_back({test::lookingDown(), poses[index], false, frame.stamp});
    ASSERT_TRUE(learnFrom(key, &joint));
  }
  BundleConfig config;
  config.is_free = is_free;
  config.noise = kNoise;
  ASSERT_TRUE(adjust(&bundle, config));
  const auto information = omnitag::information(bundle, config);
  ASSERT_TRUE(information);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Eigen::Isometry3d found =
        moved(file.markers[i].map_from_marker, joint.mean.segment<6>(increments[i]));
    const Eigen::Isometry3d& expected = bundle.landmarks[i].marker.map_from_marker;
    const Eigen::Matrix<double, 6, 6> covariance =
        joint.covariance.block<6, 6>(increments[i], increments[i]);
    const double deviation = std::sqrt(covariance.topLeftCorner<3, 3>().trace());
    EXPECT_LT((found.translation() - expected.translation()).norm(), 0.1 * deviation) << i;
    EXPECT_TRUE(found.linear().isApprox(expected.linear(), 1e-4)) << i;
    EXPECT_TRUE(covariance.isApprox(information->landmarks[i], 0.05)) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(OnAFloorAndFree, KeyFrameTest, testing::Bool());

class MapRefinementTest : public testing::Test {
 protected:
  /// A frame as a localizer sees it whose pose is a little off.
  bool feed(MapRefinement* refinement, const Pose& pose, std::size_t index = 0) {
    const MountedCamera camera(camera_, test::lookingDown());
    Frame frame;
    frame.image = test::renderPanorama({"map", truth_}, camera, pose);
    frame.base_from_camera = test::lookingDown();
    frame.camera = index;
    FrameResult result;
    const Eigen::Vector3d variances(1e-6, 1e-6, 1e-8);
    result.map_from_base =
        floorEstimate({pose.x + 0.002, pose.y - 0.001, pose.yaw + 0.001}, variances.asDiagonal());
    result.camera = std::make_shared<const MountedCamera>(camera);
    for (std::size_t i = 0; i < truth_.size(); ++i) {
      const auto reading = test::exactReading(truth_[i], camera, pose);
      if (!reading) continue;
      MarkerDetection detection;
      detection.accepted = true;
      detection.map_entry = i;
      detection.deviations = far_off_ == i ? 8.0 : 1.0;
      const MarkerReading read = test::withNoise(*reading, 0.1, &random_);
      detection.corners = read.corners;
      detection.center = read.center;
      result.detections.push_back(detection);
    }
    return refinement->add(frame, result);
  }

  int drive(MapRefinement* refinement) {
    int changes = 0;
    for (const Pose& pose : test::roundTrip(10)) changes += feed(refinement, pose) ? 1 : 0;
    return changes;
  }

  std::mt19937 random_{8};
  /// A marker that the localizer finds to be off.
  std::optional<std::size_t> far_off_;
  std::shared_ptr<const CameraModel> camera_ = test::sphericalCamera();
  std::vector<Marker> truth_ = test::roomMarkers();
  MarkerMap file_ = surveyed(truth_, &random_);
};

TEST_F(MapRefinementTest, PutsMarkersWhereTheyHangAndSaysHowWell) {
  MapRefinement refinement(1, file_, evenFloor());
  EXPECT_EQ(drive(&refinement), 10);
  const MarkerMap& map = refinement.map();
  const Eigen::Vector3d shift = meanError(map, truth_);
  for (std::size_t i = 0; i < truth_.size(); ++i) {
    const Eigen::Vector3d error = map.markers[i].center() - truth_[i].center();
    const double before = (file_.markers[i].center() - truth_[i].center()).norm();
    EXPECT_LT((error - shift).norm(), 0.0025) << i << ", before " << before;
    EXPECT_LT(error.norm(), 4.0 * map.markers[i].deviation) << i;
    EXPECT_LE(map.markers[i].deviation, kDeviation);
    EXPECT_LT(map.markers[i].orientation_deviation, 0.5 * kOrientationDeviation);
    const Eigen::AngleAxisd turn(map.markers[i].map_from_marker.linear() *
                                 truth_[i].map_from_marker.linear().transpose());
    EXPECT_LT(turn.angle(), 4.0 * map.markers[i].orientation_deviation) << i;
  }
  EXPECT_EQ(refinement.refined().size(), truth_.size());
}

TEST_F(MapRefinementTest, LearnsNothingNewFromTheSamePlace) {
  MapRefinement refinement(2, file_, evenFloor());
  EXPECT_TRUE(feed(&refinement, {0.3, 0.1, 0.2}));
  EXPECT_FALSE(feed(&refinement, {0.31, 0.1, 0.2}));
  EXPECT_TRUE(feed(&refinement, {0.31, 0.1, 0.2}, 1)) << "through another camera";
  EXPECT_TRUE(feed(&refinement, {0.8, 0.1, 0.2}));
}

TEST_F(MapRefinementTest, TakesTheMapsFrameFromAnExactMarker) {
  file_.markers[2] = truth_[2];
  MapRefinement refinement(1, file_, evenFloor());
  drive(&refinement);
  const Marker& exact = refinement.map().markers[2];
  EXPECT_EQ(exact.map_from_marker.matrix(), truth_[2].map_from_marker.matrix());
  EXPECT_EQ(exact.deviation, 0.0);
  for (std::size_t i = 0; i < truth_.size(); ++i) {
    const Marker& marker = refinement.map().markers[i];
    EXPECT_LT((marker.center() - truth_[i].center()).norm(), 4.0 * marker.deviation + 1e-12) << i;
  }
  EXPECT_LT((refinement.map().markers[3].center() - truth_[3].center()).norm(), 0.0025);
}

TEST_F(MapRefinementTest, LearnsNothingFromAMarkerThatIsFarOff) {
  file_.markers[5].map_from_marker.translation() += Eigen::Vector3d(0.0, 0.06, 0.0);
  far_off_ = 5;
  MapRefinement refinement(1, file_, evenFloor());
  drive(&refinement);
  EXPECT_EQ(refinement.refined().size(), truth_.size() - 1);
  for (std::size_t i = 0; i < truth_.size(); ++i) {
    if (i == far_off_) continue;
    const Marker& marker = refinement.map().markers[i];
    EXPECT_LT((marker.center() - truth_[i].center()).norm(), 4.0 * marker.deviation) << i;
  }
}

TEST_F(MapRefinementTest, MovesNothingFartherThanTheMapSays) {
  file_.markers[5].map_from_marker.translation() += Eigen::Vector3d(0.0, 0.06, 0.0);
  MapRefinement refinement(1, file_, evenFloor());
  drive(&refinement);
  const Marker& moved_by_someone = refinement.map().markers[5];
  EXPECT_EQ(moved_by_someone.map_from_marker.matrix(), file_.markers[5].map_from_marker.matrix());
  EXPECT_EQ(moved_by_someone.deviation, kDeviation);
}

TEST_F(MapRefinementTest, GoesOnWithTheMapThatWasSaved) {
  MapRefinement refinement(1, file_, evenFloor());
  drive(&refinement);
  MarkerMap saved = refinement.map();
  saved.markers.push_back(test::wallMarker(20, {0.0, 4.0, 1.0}, -kPi / 2));
  // The robot drives on while the file is written.
  feed(&refinement, {0.2, 0.1, 0.3});
  const double known = refinement.map().markers[0].orientation_deviation;
  refinement.setMap(saved);
  EXPECT_NEAR(refinement.map().markers[0].orientation_deviation, known, 1e-12);
  EXPECT_FALSE(feed(&refinement, test::roundTrip(10).front())) << "it has been there";
  EXPECT_TRUE((refinement.refined().front().given.map_from_marker.matrix() -
               saved.markers[0].map_from_marker.matrix())
                  .isZero(0.0));
}

TEST_F(MapRefinementTest, StartsAfreshFromAMapThatSomebodyChanged) {
  MapRefinement refinement(1, file_, evenFloor());
  drive(&refinement);
  MarkerMap changed = file_;
  changed.markers[1].map_from_marker.translation().x() += 0.1;
  refinement.setMap(changed);
  EXPECT_TRUE(refinement.refined().empty());
  EXPECT_TRUE(feed(&refinement, test::roundTrip(10).front()));
  changed.markers[2].deviation = 0.0;
  changed.markers[2].orientation_deviation = 0.0;
  refinement.setMap(changed);
  EXPECT_TRUE(refinement.refined().empty());
  drive(&refinement);
  EXPECT_EQ(refinement.map().markers[2].map_from_marker.matrix(),
            changed.markers[2].map_from_marker.matrix());
}

TEST_F(MapRefinementTest, KeepsWhatSomebodyWroteIntoTheFile) {
  const std::string text =
      "family: tag36h11\nsize: 0.8\nmarkers:\n  - {id: 3, position: [4, 1, 1.2], yaw: 3.0}\n"
      "  - {id: 3, position: [0, 4, 1.2], yaw: -1.5}\n";
  const MarkerMap map = parseMarkerMap(text, "map");
  std::vector<RefinedMarker> refined;
  for (const Marker& marker : map.markers) {
    refined.push_back({marker, marker});
    refined.back().refined.map_from_marker.translation().z() += 0.003;
  }
  // One was moved in the file, the other taken down.
  const std::string edited =
      "family: tag36h11\nsize: 0.8\nmarkers:\n  - {id: 3, position: [4, 2, 1.2], yaw: 3.0}\n";
  EXPECT_FALSE(withLearnt(edited, refined, {}, "map").isChanged());
  EXPECT_EQ(withLearnt(text, refined, {}, "map").refined, 2U);
}

TEST_F(MapRefinementTest, IsWrittenIntoTheMapFile) {
  const std::string text =
      "# our hall\nfamily: tag36h11\nsize: 0.8\ndeviation: 0.005\nmarkers:\n"
      "  - {id: 3, position: [4, 1, 1.2], yaw: 3.0}  # by the door\n"
      "  - {id: 4, position: [0, 4, 1.2], yaw: -1.5}\n";
  const MarkerMap map = parseMarkerMap(text, "map");
  RefinedMarker refined{map.markers[0], map.markers[0]};
  refined.refined.map_from_marker.translation().x() = 4.0031;
  refined.refined.deviation = 0.0012;
  const LearntMap learnt = withLearnt(text, {refined, {map.markers[1], map.markers[1]}}, {}, "map");
  EXPECT_EQ(learnt.refined, 1U);
  EXPECT_TRUE(learnt.isChanged());
  const MarkerMap after = parseMarkerMap(learnt.text, "map");
  EXPECT_NEAR(after.markers[0].center().x(), 4.0031, 1e-9);
  EXPECT_NEAR(after.markers[0].deviation, 0.0012, 1e-9);
  EXPECT_EQ(learnt.text.find("# our hall"), 0U);
  EXPECT_NE(learnt.text.find("# by the door"), std::string::npos);
  EXPECT_FALSE(withLearnt(learnt.text, {refined}, {}, "map").isChanged()) << "it has it already";
}

}  // namespace
}  // namespace omnitag
