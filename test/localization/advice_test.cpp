#include "localization/advice.h"

#include <gtest/gtest.h>

#include <functional>

#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"

namespace omnitag {
namespace {

/// The advice after the same image has come many times.
class AdviceTest : public testing::Test {
 protected:
  std::vector<std::string> adviceOn(const std::function<void(FrameResult*)>& make) const {
    FrameResult result;
    result.map_from_base = PoseEstimate{};
    for (std::size_t entry = 0; entry < map_.markers.size(); ++entry) {
      MarkerDetection detection;
      detection.map_entry = entry;
      detection.accepted = true;
      // The marker's 0.3 m are 30 pixels: a pixel is a centimetre.
      detection.corners = {Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(30.0, 0.0),
                           Eigen::Vector2d(30.0, 30.0), Eigen::Vector2d(0.0, 30.0)};
      detection.residual = 1.5;
      result.detections.push_back(detection);
    }
    make(&result);
    Advisor advisor;
    constexpr int kImages = 30;
    for (int i = 0; i < kImages; ++i) advisor.add(result, map_, *camera_);
    return advisor.lines();
  }

  static MarkerMap threeMarkers() {
    MarkerMap map{"map", {}};
    for (int id = 0; id < 3; ++id) {
      map.markers.push_back(test::wallMarker(id, {2.0, id - 1.0, 1.2}, kPi));
      map.markers.back().size = 0.3;
    }
    return map;
  }

  MarkerMap map_ = threeMarkers();
  std::shared_ptr<const CameraModel> camera_ = test::sphericalCamera();
};

TEST_F(AdviceTest, NothingIsSaidWhereAllIsAsTheFilesSay) {
  EXPECT_TRUE(adviceOn([](FrameResult* result) { result->excess = 1.3; }).empty());
}

TEST_F(AdviceTest, MarkersThatDisagreeAreTheMapsFault) {
  const auto lines = adviceOn([](FrameResult* result) { result->excess = 9.0; });
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0],
            "markers disagree by 1.5 cm, 3.0 times more than the map says: raise its deviation or "
            "refine it with build_map");
}

TEST_F(AdviceTest, WhatDisagreesTowardTheRimIsTheCamerasFault) {
  const auto lines = adviceOn([](FrameResult* result) {
    result->excess = 9.0;
    result->imaging_error[2] = 3.0;
  });
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_NE(lines[0].find("run calibrate_camera"), std::string::npos) << lines[0];
}

TEST_F(AdviceTest, BlurredMarkersDisagreeByNoFaultOfTheMap) {
  const auto lines = adviceOn([](FrameResult* result) {
    result->excess = 4.0;
    result->blur = ImageBlur{4.0};
  });
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0], "the images are blurred by 2.0 pixels: focus the lens");
}

TEST_F(AdviceTest, TheExposureAndTheLagAreSaidAtOnce) {
  const auto lines = adviceOn([](FrameResult* result) {
    result->exposure = ImageExposure::kTooDark;
    result->image_lag = 0.02;
  });
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_NE(lines[0].find("too dark"), std::string::npos) << lines[0];
  EXPECT_NE(lines[1].find("20 ms later"), std::string::npos) << lines[1];
}

TEST_F(AdviceTest, OneImageIsNoReason) {
  Advisor advisor;
  FrameResult result;
  result.map_from_base = PoseEstimate{};
  result.detections.resize(2);
  for (std::size_t i = 0; i < 2; ++i) {
    result.detections[i].accepted = true;
    result.detections[i].map_entry = i;
  }
  result.excess = 100.0;
  advisor.add(result, map_, *camera_);
  EXPECT_TRUE(advisor.lines().empty());
}

}  // namespace
}  // namespace omnitag
