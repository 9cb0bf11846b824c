#include "marker/pattern_picture.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <opencv2/core.hpp>
#include <random>
#include <string>
#include <vector>

#include "../support/sample_pictures.h"
#include "marker/tag_pattern.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

class PatternFileTest : public testing::Test {
 protected:
  ~PatternFileTest() override { std::remove(path_.c_str()); }

  PatternPicture load(const std::string& text) const {
    std::ofstream(path_) << text;
    return loadPatternPicture(path_);
  }

  /// The error for a file with this text.
  std::string refusal(const std::string& text) const {
    try {
      load(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  const std::string path_ = testing::TempDir() + "pattern_file_test.patt";
};

/// Four blocks with these three planes.
std::string blocks(const std::string& planes) { return planes + planes + planes + planes; }

TEST_F(PatternFileTest, TheFirstBlockIsThePictureInItsLuma) {
  const std::string blue = "255 0 0 0\n0 0 0 0\n0 0 0 0\n0 0 0 100\n";
  const std::string green = "0 255 0 0\n0 0 0 0\n0 0 0 0\n0 0 0 100\n";
  const std::string red = "0 0 255 0\n0 0 0 0\n0 0 0 0\n0 0 0 100\n\n";
  std::string turned;
  for (int i = 0; i < 3 * 3 * 16; ++i) turned += "7 ";
  const PatternPicture picture = load(blue + green + red + turned);
  EXPECT_EQ(picture.side, 4);
  EXPECT_NEAR(picture.whiteAt(0, 0), 0.114, 1e-12);
  EXPECT_NEAR(picture.whiteAt(1, 0), 0.587, 1e-12);
  EXPECT_NEAR(picture.whiteAt(2, 0), 0.299, 1e-12);
  EXPECT_NEAR(picture.whiteAt(3, 3), 100.0 / 255.0, 1e-12);
  EXPECT_EQ(picture.whiteAt(3, 0), 0.0);
}

TEST_F(PatternFileTest, WhatIsNoPatternIsRefusedByName) {
  EXPECT_NE(refusal("1 2 3\n").find(path_ + ": expected 4 blocks"), std::string::npos);
  EXPECT_NE(refusal("").find("found 0 numbers"), std::string::npos);
  EXPECT_NE(
      refusal("1 2\n3 three\n").find(path_ + ":2: expected numbers from 0 to 255, found 'three'"),
      std::string::npos);
  for (const char* word : {"0x1F", "1e2", "+5", "1.2.3", "nan"}) {
    EXPECT_NE(refusal(word).find(std::string("found '") + word + "'"), std::string::npos) << word;
  }
  EXPECT_NE(refusal("1 256\n").find("found '256'"), std::string::npos);
  EXPECT_NE(refusal("1 -1\n").find("found '-1'"), std::string::npos);
  std::string even;
  for (int i = 0; i < 3 * 16; ++i) even += i % 2 == 0 ? "120 " : "122 ";
  EXPECT_NE(refusal(blocks(even)).find("contrast"), std::string::npos);
  EXPECT_THROW(loadPatternPicture("/nowhere/pattern.patt"), InputError);
}

TEST(PatternPictureTest, CorrelatesWithItselfTurnedAlone) {
  for (const std::string& name : test::pictureNames()) {
    const PatternPicture upright = *test::picture(name);
    PatternPicture turned = upright;
    const int last = upright.side - 1;
    for (int row = 0; row < upright.side; ++row) {
      for (int column = 0; column < upright.side; ++column) {
        // A quarter clockwise: what was at the left is at the top.
        turned.white[static_cast<std::size_t>(row * upright.side + column)] =
            0.2 + 0.5 * upright.whiteAt(row, last - column);
      }
    }
    EXPECT_NEAR(correlationOf(upright, turned, 1), 1.0, 1e-9) << name;
    for (const int quarters : {0, 2, 3}) {
      EXPECT_LT(correlationOf(upright, turned, quarters), 0.7) << name;
    }
  }
}

TEST(PatternPictureTest, RandomPicturesOfItsSpectrumVaryInSoManyWays) {
  std::mt19937 generator(3);
  std::normal_distribution<double> normal;
  for (const std::string& name : test::pictureNames()) {
    const PatternPicture picture = *test::picture(name);
    cv::Mat cells(picture.side, picture.side, CV_64F,
                  const_cast<double*>(picture.white.data()));  // only read
    cells = cells - cv::mean(cells)[0];
    cv::Mat spectrum;
    cv::dft(cells, spectrum, cv::DFT_COMPLEX_OUTPUT);
    constexpr int kTrials = 4000;
    double products = 0.0;
    double norms = 0.0;
    for (int i = 0; i < kTrials; ++i) {
      // White noise filtered by the picture has its spectrum, but not its phase.
      cv::Mat noise(picture.side, picture.side, CV_64F);
      for (double& value : cv::Mat_<double>(noise)) value = normal(generator);
      cv::Mat filtered;
      cv::dft(noise, filtered, cv::DFT_COMPLEX_OUTPUT);
      cv::mulSpectrums(filtered, spectrum, filtered, 0);
      cv::dft(filtered, filtered, cv::DFT_INVERSE | cv::DFT_REAL_OUTPUT | cv::DFT_SCALE);
      products += std::pow(cells.dot(filtered), 2);
      norms += cells.dot(cells) * filtered.dot(filtered);
    }
    EXPECT_NEAR(products / norms * dimensionsOf(picture), 1.0, 0.1) << name;
  }
}

/// Average of a pattern, continued beyond its edge, over a Gaussian of this deviation (modules).
double gaussianAverage(const TagPattern& pattern, const Eigen::Vector2d& middle, double deviation) {
  constexpr int kSteps = 200;
  constexpr double kReach = 4.0;
  double sum = 0.0;
  double weights = 0.0;
  const auto module = [&pattern](double place) {
    return std::clamp(static_cast<int>(place), 0, pattern.width() - 1);
  };
  for (int row = -kSteps; row < kSteps; ++row) {
    for (int column = -kSteps; column < kSteps; ++column) {
      const Eigen::Vector2d off = kReach / kSteps * Eigen::Vector2d(column + 0.5, row + 0.5);
      const double weight = std::exp(-0.5 * off.squaredNorm());
      const Eigen::Vector2d place = middle + deviation * off;
      sum += weight * pattern.whiteAt(module(place.x()), module(place.y()));
      weights += weight;
    }
  }
  return sum / weights;
}

TEST(PatternPictureTest, BlurAveragesAllOfItsModules) {
  // 32, 80 and 160 modules, of which a blurred pixel of a small marker covers up to a third.
  for (const double border : {0.25, 0.2, 0.15}) {
    const TagPattern pattern(*test::picture("snake", border));
    for (const double edge : {12.0, 20.0, 40.0}) {
      const double pixel = pattern.widthBetweenCorners() / edge;
      const TagPattern::Window window({pixel, 0.0}, {0.0, pixel}, 0.8);
      const double deviation = pixel * std::sqrt(0.8 + 1.0 / 12.0);
      for (const double place : {0.3, 0.5, 0.62}) {
        const Eigen::Vector2d middle = pattern.width() * Eigen::Vector2d(place, 0.9 - place);
        const TagPattern::White white = pattern.averageOver(middle, window);
        EXPECT_NEAR(white.share, gaussianAverage(pattern, middle, deviation), 0.01)
            << border << ", " << edge << ", " << place;
        const Eigen::Vector2d step(0.05 * pixel, 0.0);
        const double slope = (pattern.averageOver(middle + step, window).share -
                              pattern.averageOver(middle - step, window).share) /
                             (2.0 * step.x());
        EXPECT_NEAR(white.by_position.x() * pixel, slope * pixel, 0.03);
        std::vector<TagPattern::DataShare> shares;
        pattern.appendDataShares(middle, window, &shares);
        double of_data = 0.0;
        for (const auto& [module, share] : shares) {
          of_data += share * 0.5 * (pattern.dataAt(module) + 1.0);
        }
        // The border is black, so all white near the middle is data.
        if (place == 0.5) {
          EXPECT_NEAR(of_data, white.share, 0.03) << border << ", " << edge;
        }
      }
    }
  }
}

}  // namespace
}  // namespace omnitag
