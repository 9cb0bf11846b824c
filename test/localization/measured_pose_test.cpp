#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <opencv2/core.hpp>
#include <vector>

#include "../support/filtered_drive.h"
#include "../support/level_floor.h"
#include "../support/panorama_renderer.h"
#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"
#include "../support/sweep.h"
#include "omnitag/localization/localizer.h"

namespace omnitag {
namespace {

using test::FilterInput;
using test::mean;

class MeasuredPoseTest : public testing::Test {
 protected:
  FrameResult process(Localizer* localizer, const cv::Mat& image, bool wants_measured = true) {
    Frame frame{0.1 * frames_++, image, mounting_, Pose{1.0, 2.0, 0.3}};
    frame.wants_measured = wants_measured;
    return localizer->process(frame);
  }

  std::shared_ptr<const CameraModel> camera_ = test::sphericalCamera();
  Eigen::Isometry3d mounting_ = test::lookingDown();
  Pose truth_{0.3, -0.2, 0.5};
  MarkerMap map_{"map", {test::roomMarkers().front(), test::roomMarkers().at(3)}};
  cv::Mat image_ = test::renderPanorama(map_, {camera_, mounting_}, truth_);
  cv::Mat black_ = cv::Mat::zeros(image_.size(), image_.type());
  int frames_ = 0;
};

TEST_F(MeasuredPoseTest, HasNoPredictionInIt) {
  // A wrong and overconfident prediction draws the pose, but not the measurement.
  Pose beside = truth_;
  beside.x += 1e-3;
  Localizer localizer(camera_, map_, test::onLevelFloor());
  localizer.setPose(floorEstimate(beside, 1e-12 * Eigen::Matrix3d::Identity()));
  const FrameResult result = process(&localizer, image_);
  ASSERT_TRUE(result.map_from_base && result.measured);
  EXPECT_NEAR(result.map_from_base->pose.x, beside.x, 1e-4);
  EXPECT_NEAR(result.measured->pose.x, truth_.x, 3e-4);
  const PoseVector off = difference(result.measured->pose, truth_);
  const Eigen::Vector3d error = off.head<3>();
  EXPECT_LT(error.dot(floorCovariance(*result.measured).ldlt().solve(error)), 16.3);  // 0.1 %
}

TEST_F(MeasuredPoseTest, DoesNotBecomeSurerAtRest) {
  Localizer localizer(camera_, map_, test::onLevelFloor());
  // The localizer learns the blur from the first images.
  for (int i = 0; i < 3; ++i) process(&localizer, image_);
  const auto first = process(&localizer, image_).measured;
  ASSERT_TRUE(first);
  for (int i = 0; i < 10; ++i) process(&localizer, image_);
  const auto last = process(&localizer, image_).measured;
  ASSERT_TRUE(last);
  EXPECT_NEAR(positionDeviation(*last) / positionDeviation(*first), 1.0, 0.3);
}

TEST_F(MeasuredPoseTest, IsNoneWhereNoMarkerIsRead) {
  Localizer localizer(camera_, map_, test::onLevelFloor());
  ASSERT_TRUE(process(&localizer, image_).measured);
  const FrameResult blind = process(&localizer, black_);
  EXPECT_EQ(blind.mode, Mode::kDeadReckoning);
  EXPECT_TRUE(blind.map_from_base);
  EXPECT_FALSE(blind.measured);
  EXPECT_FALSE(process(&localizer, image_, false).measured);
}

TEST_F(MeasuredPoseTest, WorksWithEveryEstimatorAndPoseModel) {
  for (const EstimatorKind kind :
       {EstimatorKind::kTriangulation, EstimatorKind::kReprojection, EstimatorKind::kPhotometric}) {
    for (const PoseModel model : {PoseModel::kFloor, PoseModel::kFree}) {
      if (kind == EstimatorKind::kTriangulation && model == PoseModel::kFree) continue;
      SCOPED_TRACE(testing::Message() << static_cast<int>(kind) << ' ' << static_cast<int>(model));
      LocalizerConfig config = test::onLevelFloor();
      config.estimation.kind = kind;
      config.motion.pose_model = model;
      Localizer localizer(camera_, map_, config);
      localizer.setPose(truth_);
      const auto measured = process(&localizer, image_).measured;
      ASSERT_TRUE(measured);
      EXPECT_LT(translationPart(difference(measured->pose, truth_)).norm(), 0.02);
      EXPECT_EQ(measured->covariance.llt().info(), Eigen::Success);
    }
  }
}

TEST_F(MeasuredPoseTest, IsNotTheOtherPoseThatASingleMarkerLeaves) {
  // Seen nearly from its front, it looks the same from either side.
  Marker marker = test::wallMarker(4, {3.5, 0.3, 1.2}, kPi);
  marker.size = 0.5;
  marker.deviation = 1e-3;
  map_.markers = {marker};
  truth_ = {0.2, -0.3, -0.2};
  const cv::Mat exact = test::renderPanorama(map_, {camera_, mounting_}, truth_);
  cv::RNG random(3);
  for (int i = 0; i < 40; ++i) {
    cv::Mat noise(exact.size(), CV_16SC1);
    random.fill(noise, cv::RNG::NORMAL, 0.0, 4.0);
    cv::Mat image;
    cv::add(exact, noise, image, cv::noArray(), CV_8UC1);
    Localizer localizer(camera_, map_, test::onLevelFloor());
    localizer.setPose(truth_);
    const auto measured = process(&localizer, image).measured;
    if (!measured) continue;
    const Eigen::Vector3d error = difference(measured->pose, truth_).head<3>();
    // Exceeded by chance once in a million.
    EXPECT_LT(error.dot(floorCovariance(*measured).ldlt().solve(error)), 30.7) << i;
  }
}

/// Drives with two stretches where markers are in sight, each followed by one where they are not.
class FilteredPoseTest : public testing::Test {
 protected:
  void SetUp() override {
    if (test::kIsSanitized) GTEST_SKIP() << test::kRepeats;
  }

  static constexpr unsigned kDrives = 16;
  const std::vector<std::size_t> last_seen_{7, 23};
  const std::vector<std::size_t> last_hidden_{15, 31};

  /// Over these frames; over all if none is given.
  double meanNees(FilterInput input, double map_deviation,
                  const std::vector<std::size_t>& frames = {}) const {
    std::vector<double> all;
    for (unsigned seed = 1; seed <= kDrives; ++seed) {
      const std::vector<double> nees = drive().nees(input, map_deviation, seed);
      if (frames.empty()) all.insert(all.end(), nees.begin(), nees.end());
      for (const std::size_t frame : frames) all.push_back(nees.at(frame));
    }
    return mean(all);
  }

 private:
  /// All tests share its images.
  static const test::FilteredDrive& drive() {
    static const test::FilteredDrive drive(32);
    return drive;
  }
};

// If all frames of a drive had the same error, 16 drives would have 48 degrees of freedom, and the
// mean would be within these limits in 998 of 1000 runs.
constexpr double kLeast = 1.45;
constexpr double kMost = 5.26;

TEST_F(FilteredPoseTest, AFilterThatFusesItWithOdometryIsConsistent) {
  const double nees = meanNees(FilterInput::kMeasured, 0.0);
  EXPECT_GT(nees, kLeast);
  EXPECT_LT(nees, kMost);
}

TEST_F(FilteredPoseTest, AFilterThatFusesThePoseTakesTheOdometryTwice) {
  EXPECT_GT(meanNees(FilterInput::kPose, 0.0, last_hidden_), kMost);
}

TEST_F(FilteredPoseTest, AFilterTakesTheErrorsOfTheMapForNoise) {
  EXPECT_GT(meanNees(FilterInput::kMeasured, 0.005, last_seen_), kMost);
}

}  // namespace
}  // namespace omnitag
