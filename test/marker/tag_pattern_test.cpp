#include "omnitag/marker/tag_pattern.h"

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "../support/panorama_renderer.h"
#include "omnitag/common/error.h"
#include "omnitag/marker/tag_family.h"

namespace omnitag {
namespace {

TEST(TagPatternTest, IsTheTagAsTheLibraryDrawsIt) {
  for (const char* family : {"tag36h11", "tag16h5", "tagCircle21h7", "tagStandard41h12"}) {
    for (const int id : {0, 3, 17, 29}) {
      const test::TagBitmap bitmap = test::tagBitmap(family, id);
      const TagPattern pattern(family, id);
      ASSERT_EQ(pattern.width(), bitmap.total_width);
      EXPECT_EQ(pattern.widthBetweenCorners(), bitmap.width_at_border);
      for (int row = 0; row < bitmap.total_width; ++row) {
        for (int column = 0; column < bitmap.total_width; ++column) {
          const auto index = static_cast<std::size_t>(row * bitmap.total_width + column);
          EXPECT_EQ(pattern.isWhite(column, row), bitmap.white[index])
              << family << " " << id << ": column " << column << ", row " << row;
        }
      }
    }
  }
}

/// Share of white among evenly spaced points of a rectangle.
double sampledAverage(const test::TagBitmap& bitmap, const Eigen::Vector2d& position,
                      const Eigen::Vector2d& size) {
  constexpr int kSamples = 300;
  int white = 0;
  for (int i = 0; i < kSamples; ++i) {
    for (int j = 0; j < kSamples; ++j) {
      const double x = position.x() + size.x() * ((i + 0.5) / kSamples - 0.5);
      const double y = position.y() + size.y() * ((j + 0.5) / kSamples - 0.5);
      const int index = static_cast<int>(y) * bitmap.total_width + static_cast<int>(x);
      white += bitmap.white[static_cast<std::size_t>(index)] ? 1 : 0;
    }
  }
  return static_cast<double>(white) / (kSamples * kSamples);
}

TEST(TagPatternTest, AveragesOverAnyRectangle) {
  const test::TagBitmap bitmap = test::tagBitmap("tag36h11", 42);
  const TagPattern pattern("tag36h11", 42);
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (int i = 0; i < 40; ++i) {
    const Eigen::Vector2d size(0.05 + 3.0 * share(generator), 0.05 + 3.0 * share(generator));
    const Eigen::Vector2d room = Eigen::Vector2d::Constant(bitmap.total_width) - size;
    const Eigen::Vector2d position =
        0.5 * size + Eigen::Vector2d(share(generator) * room.x(), share(generator) * room.y());
    EXPECT_NEAR(pattern.average(position, size).share, sampledAverage(bitmap, position, size),
                0.01);
  }
}

TEST(TagPatternTest, AveragesOverModulesAndTheWholeDrawingAreExact) {
  const test::TagBitmap bitmap = test::tagBitmap("tag36h11", 7);
  const TagPattern pattern("tag36h11", 7);
  double white = 0.0;
  for (int row = 0; row < bitmap.total_width; ++row) {
    for (int column = 0; column < bitmap.total_width; ++column) {
      const auto index = static_cast<std::size_t>(row * bitmap.total_width + column);
      const double module = bitmap.white[index] ? 1.0 : 0.0;
      EXPECT_NEAR(pattern.average({column + 0.5, row + 0.5}, {1.0, 1.0}).share, module, 1e-12);
      white += module;
    }
  }
  const double width = bitmap.total_width;
  EXPECT_NEAR(pattern.average({0.5 * width, 0.5 * width}, {width, width}).share,
              white / (width * width), 1e-12);
}

TEST(TagPatternTest, DerivativesAreThoseOfTheAverage) {
  const TagPattern pattern("tag36h11", 42);
  constexpr double kStep = 1e-6;
  std::mt19937 generator(2);
  std::uniform_real_distribution<double> coordinate(2.0, pattern.width() - 2.0);
  std::uniform_real_distribution<double> edge(0.1, 3.0);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector2d position(coordinate(generator), coordinate(generator));
    const Eigen::Vector2d size(edge(generator), edge(generator));
    const TagPattern::White white = pattern.average(position, size);
    for (int axis = 0; axis < 2; ++axis) {
      const Eigen::Vector2d step = kStep * Eigen::Vector2d::Unit(axis);
      const double difference = pattern.average(position + step, size).share -
                                pattern.average(position - step, size).share;
      EXPECT_NEAR(white.by_position[axis], difference / (2.0 * kStep), 1e-5);
    }
  }
}

TEST(TagPatternTest, EveryFamilyHasPatterns) {
  for (const std::string& family : tagFamilies()) {
    for (const int id : {0, tagCount(family) - 1}) {
      const TagPattern pattern(family, id);
      EXPECT_GE(pattern.width(), pattern.widthBetweenCorners()) << family;
      EXPECT_GT(pattern.widthBetweenCorners(), 0) << family;
      const double width = pattern.width();
      const double share = pattern.average({0.5 * width, 0.5 * width}, {width, width}).share;
      EXPECT_GT(share, 0.1) << family;
      EXPECT_LT(share, 0.9) << family;
    }
  }
}

std::string refusal(const std::string& family, int id) {
  try {
    TagPattern(family, id);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(TagPatternTest, RefusesWhatTheLibraryDoesNotHaveByName) {
  EXPECT_NE(refusal("tag99h99", 0).find("'tag99h99'"), std::string::npos);
  for (const int id : {-1, 587}) {
    const std::string message = refusal("tag36h11", id);
    EXPECT_NE(message.find("tag36h11"), std::string::npos);
    EXPECT_NE(message.find("0 to 586"), std::string::npos);
    EXPECT_NE(message.find("found " + std::to_string(id)), std::string::npos);
  }
}

}  // namespace
}  // namespace omnitag
