#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/core/version.hpp>
#include <opencv2/imgproc.hpp>
#if __has_include(<opencv2/objdetect/aruco_dictionary.hpp>)
#include <opencv2/objdetect/aruco_dictionary.hpp>
#else
#include <opencv2/aruco/dictionary.hpp>
#endif
#include <string>
#include <vector>

#include "../support/supersampling.h"
#include "marker/tag_detector.h"
#include "marker/tag_family.h"
#include "marker/tag_pattern.h"

namespace omnitag {
namespace {

/// A marker as OpenCV draws it, one pixel for each module, with its black border.
cv::Mat drawnByOpenCv(int dictionary, int id, int side) {
  cv::Mat drawing;
#if CV_VERSION_MAJOR > 4 || CV_VERSION_MINOR >= 7
  cv::aruco::getPredefinedDictionary(dictionary).generateImageMarker(id, side + 2, drawing);
#else
  cv::aruco::getPredefinedDictionary(dictionary)->drawMarker(id, side + 2, drawing);
#endif
  return drawing;
}

struct Sample {
  std::string name;
  int dictionary;
  int side;
  int count;
};

const std::vector<Sample>& samples() {
  static const std::vector<Sample> all = {
      {"DICT_4X4_50", cv::aruco::DICT_4X4_50, 4, 50},
      {"DICT_4X4_1000", cv::aruco::DICT_4X4_1000, 4, 1000},
      {"DICT_5X5_100", cv::aruco::DICT_5X5_100, 5, 100},
      {"DICT_6X6_250", cv::aruco::DICT_6X6_250, 6, 250},
      {"DICT_7X7_50", cv::aruco::DICT_7X7_50, 7, 50},
      {"DICT_ARUCO_ORIGINAL", cv::aruco::DICT_ARUCO_ORIGINAL, 5, 1024},
      {"DICT_APRILTAG_36h11", cv::aruco::DICT_APRILTAG_36h11, 6, 587}};
  return all;
}

TEST(ArucoFamilyTest, HasTheMarkersOfItsDictionary) {
  for (const Sample& sample : samples()) {
    EXPECT_EQ(tagFamilies().count(sample.name), 1U);
    EXPECT_EQ(tagCount(sample.name), sample.count) << sample.name;
    for (const int id : {0, 7, sample.count - 1}) {
      const cv::Mat drawing = drawnByOpenCv(sample.dictionary, id, sample.side);
      const TagPattern pattern(sample.name, id);
      ASSERT_EQ(pattern.width(), sample.side + 4);
      ASSERT_EQ(pattern.widthBetweenCorners(), sample.side + 2);
      EXPECT_EQ(pattern.dataModules(), sample.side * sample.side);
      for (int row = 0; row < pattern.width(); ++row) {
        for (int column = 0; column < pattern.width(); ++column) {
          const bool is_around =
              std::min(row, column) < 1 || std::max(row, column) > sample.side + 2;
          const bool is_white = is_around || drawing.at<std::uint8_t>(row - 1, column - 1) > 127;
          EXPECT_EQ(pattern.whiteAt(column, row) > 0.5, is_white)
              << sample.name << " " << id << ": column " << column << ", row " << row;
        }
      }
    }
  }
}

TEST(ArucoFamilyTest, IsReadInEveryTurn) {
  constexpr int kModule = 12;
  constexpr int kMargin = 3 * kModule;
  for (const Sample& sample : samples()) {
    const TagDetector detector({}, {sample.name});
    for (const int id : {1, 8, sample.count - 2}) {
      cv::Mat upright = drawnByOpenCv(sample.dictionary, id, sample.side);
      cv::resize(upright, upright, {}, kModule, kModule, cv::INTER_NEAREST);
      cv::copyMakeBorder(upright, upright, kMargin, kMargin, kMargin, kMargin, cv::BORDER_CONSTANT,
                         cv::Scalar(255));
      const double low = kMargin - 0.5;
      const double high = low + kModule * (sample.side + 2);
      // Counter-clockwise from the lower left one.
      std::vector<Eigen::Vector2d> corners = {{low, high}, {high, high}, {high, low}, {low, low}};
      for (int turn = 0; turn < 4; ++turn) {
        const std::vector<TagDetection> found = detector.detect(upright);
        ASSERT_EQ(found.size(), 1U) << sample.name << " " << id << ", turned " << turn << " times";
        EXPECT_EQ(found.front().family, sample.name);
        EXPECT_EQ(found.front().id, id);
        EXPECT_EQ(found.front().hamming, 0);
        EXPECT_EQ(found.front().modules_per_edge, sample.side + 2);
        for (std::size_t i = 0; i < 4; ++i) {
          EXPECT_LT((found.front().corners[i] - corners[i]).norm(), 0.3)
              << sample.name << " " << id << ", turned " << turn << " times, corner " << i;
        }
        cv::rotate(upright, upright, cv::ROTATE_90_CLOCKWISE);
        for (Eigen::Vector2d& corner : corners) {
          corner = Eigen::Vector2d(upright.cols - 1 - corner.y(), corner.x());
        }
      }
    }
  }
}

TEST(ArucoFamilyTest, CorrectsNoMoreThanIsSafe) {
  // Two wrong bits in DICT_4X4_50 may give another marker; one does not.
  constexpr int kModule = 12;
  constexpr int kSide = 4;
  const TagDetector detector({}, {"DICT_4X4_50"});
  for (int wrong = 0; wrong <= 2; ++wrong) {
    cv::Mat marker = drawnByOpenCv(cv::aruco::DICT_4X4_50, 5, kSide);
    for (int i = 0; i < wrong; ++i) {
      auto& module = marker.at<std::uint8_t>(1 + i, 2);
      module = module > 127 ? 0 : 255;
    }
    cv::resize(marker, marker, {}, kModule, kModule, cv::INTER_NEAREST);
    cv::copyMakeBorder(marker, marker, 36, 36, 36, 36, cv::BORDER_CONSTANT, cv::Scalar(255));
    const std::vector<TagDetection> found = detector.detect(marker);
    const bool is_found = !found.empty() && found.front().id == 5;
    EXPECT_EQ(is_found, wrong <= 1) << wrong << " wrong bits";
  }
}

TEST(AprilGridFamily, IsTheCodeOfTag36h11InABorderOfTwoModules) {
  EXPECT_EQ(tagCount("aprilgrid"), tagCount("tag36h11"));
  for (const int id : {0, 1, 35, 586}) {
    const TagPattern single("tag36h11", id);
    const TagPattern pattern("aprilgrid", id);
    ASSERT_EQ(pattern.widthBetweenCorners(), 10);
    ASSERT_EQ(pattern.width(), 12);
    for (int row = 0; row < 12; ++row) {
      for (int column = 0; column < 12; ++column) {
        const int from_edge = std::min({row, column, 11 - row, 11 - column});
        const double expected = from_edge == 0  ? 1.0
                                : from_edge < 3 ? 0.0
                                                : single.whiteAt(column - 1, row - 1);
        EXPECT_EQ(pattern.whiteAt(column, row), expected)
            << id << ": column " << column << ", row " << row;
      }
    }
  }
}

/// 3 x 3 tags as Kalibr draws them, with black squares between their corners, each pixel the mean
/// over its area. `module`: pixels.
cv::Mat aprilGrid(double module, double turn) {
  constexpr int kSide = 400;
  std::vector<TagPattern> tags;
  for (int id = 0; id < 9; ++id) tags.emplace_back("aprilgrid", id);
  const auto whiteAt = [&](double u, double v) {
    const double x = (std::cos(turn) * (u - 200.0) + std::sin(turn) * (v - 200.0)) / module + 18.0;
    const double y = (-std::sin(turn) * (u - 200.0) + std::cos(turn) * (v - 200.0)) / module + 18.0;
    if (std::min(x, y) < -3.0 || std::max(x, y) >= 39.0) return 1.0;
    const double in_x = std::fmod(x + 13.0, 13.0);
    const double in_y = std::fmod(y + 13.0, 13.0);
    if (in_x >= 10.0 && in_y >= 10.0) return 0.0;
    if (in_x >= 10.0 || in_y >= 10.0 || std::min(x, y) < 0.0) return 1.0;
    const int id = 3 * (2 - static_cast<int>(y / 13.0)) + static_cast<int>(x / 13.0);
    return tags[static_cast<std::size_t>(id)].whiteAt(1 + static_cast<int>(in_x),
                                                      1 + static_cast<int>(in_y));
  };
  cv::Mat image(kSide, kSide, CV_8UC1);
  test::supersample({0, 0, kSide, kSide}, {30.0, 220.0}, whiteAt, &image);
  return image;
}

TEST(AprilGridFamily, TagsAreReadThoughTheirCornersTouch) {
  const TagDetector detector({}, {"aprilgrid"});
  for (const double module : {3.0, 4.3, 6.0}) {
    for (const double turn : {0.0, 0.3}) {
      const std::vector<TagDetection> tags = detector.detect(aprilGrid(module, turn));
      ASSERT_EQ(tags.size(), 9U) << module << ", " << turn;
      const TagDetection& middle = tags[4];
      EXPECT_EQ(middle.id, 4);
      EXPECT_LT((middle.center - Eigen::Vector2d(200.0, 200.0)).norm(), 0.1) << module;
      // The lower left corner is 5 modules to the left of the middle and 5 below it.
      const Eigen::Vector2d off =
          5.0 * module *
          Eigen::Vector2d(-std::cos(turn) - std::sin(turn), -std::sin(turn) + std::cos(turn));
      EXPECT_LT((middle.corners[0] - Eigen::Vector2d(200.0, 200.0) - off).norm(), 0.15)
          << module << ", " << turn;
    }
  }
}

}  // namespace
}  // namespace omnitag
