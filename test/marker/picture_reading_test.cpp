#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <string>
#include <vector>

#include "../support/sample_pictures.h"
#include "../support/supersampling.h"
#include "../support/sweep.h"
#include "marker/tag_detector.h"
#include "omnitag/common/angle.h"

namespace omnitag {
namespace {

MarkerFamilies allPictures() {
  MarkerFamilies families;
  int id = 0;
  for (const std::string& name : test::pictureNames())
    families.pictures[id++] = test::picture(name);
  return families;
}

/// Where the corners of a square are in an image, from the lower left of the upright picture on,
/// counter-clockwise.
Corners<Eigen::Vector2d> square(double edge, double turn, double slant) {
  Corners<Eigen::Vector2d> corners{Eigen::Vector2d(-1, 1), {1, 1}, {1, -1}, {-1, -1}};
  for (Eigen::Vector2d& corner : corners) {
    // Turned counter-clockwise on an image whose y points down, then seen from the side.
    const Eigen::Vector2d turned = Eigen::Rotation2Dd(-turn) * corner;
    const double depth = 1.0 + 0.15 * std::sin(slant) * turned.x();
    corner = Eigen::Vector2d(100.3, 99.6) +
             0.5 * edge / depth * Eigen::Vector2d(std::cos(slant) * turned.x(), turned.y());
  }
  return corners;
}

/// A picture's square on a white sheet before grey, each pixel the mean over its area.
cv::Mat drawn(const PatternPicture& picture, const Corners<Eigen::Vector2d>& corners) {
  constexpr int kSide = 200;
  const double cells = picture.side / (1.0 - 2.0 * picture.border);
  const double border = picture.border * cells;
  std::vector<cv::Point2f> seen;
  for (const Eigen::Vector2d& corner : corners) {
    seen.emplace_back(static_cast<float>(corner.x()), static_cast<float>(corner.y()));
  }
  const auto edge = static_cast<float>(cells);
  const std::vector<cv::Point2f> flat{{0.0F, edge}, {edge, edge}, {edge, 0.0F}, {0.0F, 0.0F}};
  const cv::Matx33d flat_from_image = cv::Matx33d(cv::getPerspectiveTransform(seen, flat));
  const auto whiteAt = [&](double u, double v) {
    const cv::Vec3d place = flat_from_image * cv::Vec3d(u, v, 1.0);
    const double x = place[0] / place[2];
    const double y = place[1] / place[2];
    if (std::min(x, y) < -0.5 * border || std::max(x, y) > cells + 0.5 * border) return 0.5;
    if (std::min(x, y) < 0.0 || std::max(x, y) > cells) return 1.0;
    const int column = static_cast<int>(std::floor(x - border));
    const int row = static_cast<int>(std::floor(y - border));
    const bool is_inside = std::min(column, row) >= 0 && std::max(column, row) < picture.side;
    return is_inside ? picture.whiteAt(column, row) : 0.0;
  };
  cv::Mat image(kSide, kSide, CV_8UC1, cv::Scalar(120));
  const cv::Rect square = cv::boundingRect(seen);
  const int around = cvRound(0.25 * square.width) + 3;  // more than the sheet around the border
  const cv::Rect sheet =
      cv::Rect(square.tl() - cv::Point(around, around), square.br() + cv::Point(around, around)) &
      cv::Rect(0, 0, kSide, kSide);
  test::supersample(sheet, {20.0, 220.0}, whiteAt, &image);
  return image;
}

void expectRead(const TagDetector& detector, const cv::Mat& image, int id,
                const Corners<Eigen::Vector2d>& corners, double tolerance) {
  const std::vector<TagDetection> found = detector.detect(image);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found.front().family, kPictureFamily);
  EXPECT_EQ(found.front().id, id);
  for (std::size_t k = 0; k < corners.size(); ++k) {
    EXPECT_LT((found.front().corners[k] - corners[k]).norm(), tolerance) << "corner " << k;
  }
}

TEST(PictureReadingTest, TellsEachPictureInAllTurns) {
  const MarkerFamilies families = allPictures();
  const TagDetector detector({}, families);
  for (const auto& [id, picture] : families.pictures) {
    for (const double turn : {0.0, 0.4, kPi / 2, kPi, 2.0, -kPi / 2}) {
      SCOPED_TRACE(picture->path + " turned by " + std::to_string(turn));
      const Corners<Eigen::Vector2d> corners = square(70.0, turn, radians(25.0));
      expectRead(detector, drawn(*picture, corners), id, corners, 0.25);
    }
  }
}

TEST(PictureReadingTest, ReadsSmallAndSlantedOnes) {
  const MarkerFamilies families = allPictures();
  const TagDetector detector({}, families);
  for (const auto& [id, picture] : families.pictures) {
    SCOPED_TRACE(picture->path);
    const Corners<Eigen::Vector2d> small = square(28.0, 0.2, 0.0);
    expectRead(detector, drawn(*picture, small), id, small, 0.4);
    const Corners<Eigen::Vector2d> slanted = square(60.0, 0.1, radians(55.0));
    expectRead(detector, drawn(*picture, slanted), id, slanted, 0.4);
  }
}

TEST(PictureReadingTest, ReducedImagesAreReadInPlace) {
  const MarkerFamilies families = allPictures();
  TagDetectorConfig config;
  config.quad_decimate = 2.0;
  const TagDetector detector(config, families);
  for (const auto& [id, picture] : families.pictures) {
    SCOPED_TRACE(picture->path);
    const Corners<Eigen::Vector2d> corners = square(90.0, 0.3, radians(15.0));
    expectRead(detector, drawn(*picture, corners), id, corners, 0.3);
  }
}

TEST(PictureReadingTest, BordersOfAnyWidthAreFound) {
  for (const double border : {0.1, 0.4}) {
    MarkerFamilies families;
    families.pictures[3] = test::picture("snake", border);
    families.pictures[5] = test::picture("road", border);
    const TagDetector detector({}, families);
    for (const auto& [id, picture] : families.pictures) {
      SCOPED_TRACE(picture->path + ", border " + std::to_string(border));
      const Corners<Eigen::Vector2d> corners = square(80.0, 0.3, radians(20.0));
      expectRead(detector, drawn(*picture, corners), id, corners, 0.25);
    }
  }
}

TEST(PictureReadingTest, TheImageIsNotBlurredInPlace) {
  const MarkerFamilies families = allPictures();
  TagDetectorConfig config;
  config.quad_sigma = 0.8;
  const TagDetector detector(config, families);
  const Corners<Eigen::Vector2d> corners = square(60.0, 0.0, 0.0);
  const cv::Mat image = drawn(*families.pictures.at(0), corners);
  const cv::Mat before = image.clone();
  expectRead(detector, image, 0, corners, 0.4);
  EXPECT_EQ(cv::norm(image, before), 0.0);
}

TEST(PictureReadingTest, OtherPicturesAreNotTakenForThem) {
  for (const auto& [left_out, picture] : allPictures().pictures) {
    MarkerFamilies others = allPictures();
    others.pictures.erase(left_out);
    const TagDetector detector({}, others);
    for (const double edge : {25.0, 40.0, 80.0}) {
      EXPECT_TRUE(detector.detect(drawn(*picture, square(edge, 0.3, 0.3))).empty())
          << picture->path << ", " << edge << " pixels wide";
    }
  }
}

TEST(PictureReadingTest, RandomSquaresAreNotTakenForAPicture) {
  const TagDetector detector({}, allPictures());
  std::mt19937 generator(11);
  std::uniform_real_distribution<double> uniform;
  int accepted = 0;
  const int trials = 300 / test::kSweepStride;
  for (int i = 0; i < trials; ++i) {
    PatternPicture random = *test::picture("crown");
    // Coarse blots: squares in the world show these rather than fine grain.
    cv::Mat blots(4, 4, CV_64F);
    for (double& blot : cv::Mat_<double>(blots)) blot = uniform(generator);
    cv::Mat cells;
    cv::resize(blots, cells, {random.side, random.side}, 0.0, 0.0, cv::INTER_CUBIC);
    random.white.assign(cells.begin<double>(), cells.end<double>());
    accepted += detector.detect(drawn(random, square(50.0, 0.0, 0.0))).empty() ? 0 : 1;
  }
  EXPECT_EQ(accepted, 0);
}

TEST(PictureReadingTest, APictureThatLooksAlikeWhenTurnedIsNotTold) {
  PatternPicture cross = *test::picture("crown");
  for (int row = 0; row < cross.side; ++row) {
    for (int column = 0; column < cross.side; ++column) {
      const bool is_dark =
          std::abs(2 * row - cross.side + 1) < 6 || std::abs(2 * column - cross.side + 1) < 6;
      cross.white[static_cast<std::size_t>(row * cross.side + column)] = is_dark ? 0.0 : 1.0;
    }
  }
  MarkerFamilies families;
  families.pictures[4] = std::make_shared<PatternPicture>(cross);
  const TagDetector detector({}, families);
  EXPECT_TRUE(detector.detect(drawn(cross, square(80.0, 0.0, 0.0))).empty());
}

TEST(PictureReadingTest, CodesAndPicturesAreReadSideBySide) {
  MarkerFamilies families = allPictures();
  families.codes.insert("tag36h11");
  const TagDetector detector({}, families);
  const auto& [id, picture] = *families.pictures.begin();
  const Corners<Eigen::Vector2d> corners = square(60.0, 0.0, 0.0);
  expectRead(detector, drawn(*picture, corners), id, corners, 0.25);
}

}  // namespace
}  // namespace omnitag
