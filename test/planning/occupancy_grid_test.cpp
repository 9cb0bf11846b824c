#include "planning/occupancy_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <random>

#include "building.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

/// Blocks at random places of a floor that is turned and displaced.
OccupancyGrid randomGrid(std::mt19937* generator) {
  cv::Mat image(60, 80, CV_8UC1, cv::Scalar(254));
  std::uniform_int_distribution<int> place(0, 59);
  for (int i = 0; i < 25; ++i) {
    const int column = place(*generator) + 15;
    const int row = place(*generator);
    const double grey = i % 3 == 0 ? 205.0 : 0.0;
    cv::rectangle(image, {column, row}, {column + i % 4, row + i % 5}, grey, cv::FILLED);
  }
  return {image, test::gridFileAt(-2.3, 0.7, 0.6)};
}

TEST(OccupancyGrid, TellsFreeFromOccupiedAsMapServerDoes) {
  cv::Mat image(2, 3, CV_8UC1, cv::Scalar(254));
  image.at<std::uint8_t>(0, 0) = 0;    // upper left
  image.at<std::uint8_t>(1, 2) = 205;  // lower right: 0.196 is not below itself
  image.at<std::uint8_t>(1, 1) = 206;
  const OccupancyGrid grid(image, test::gridFileAt(1.0, 2.0));
  EXPECT_EQ(grid.at(0, 1), Cell::kOccupied);
  EXPECT_EQ(grid.at(2, 0), Cell::kUnknown);
  EXPECT_EQ(grid.at(1, 0), Cell::kFree);
  EXPECT_EQ(grid.at(3, 0), Cell::kUnknown);
  EXPECT_EQ(grid.at(Eigen::Vector2d(1.01, 2.06)), Cell::kOccupied);
  EXPECT_EQ(grid.at(Eigen::Vector2d(0.99, 2.06)), Cell::kUnknown);
  GridFile negated = test::gridFileAt(1.0, 2.0);
  negated.negate = true;
  EXPECT_EQ(OccupancyGrid(image, negated).at(0, 1), Cell::kFree);
}

TEST(OccupancyGrid, TurnsWithItsOrigin) {
  cv::Mat image(4, 4, CV_8UC1, cv::Scalar(0));
  image.at<std::uint8_t>(3, 2) = 254;  // third column of the lowest row
  const OccupancyGrid grid(image, test::gridFileAt(1.0, 1.0, 1.5707963267948966));
  // The rows run along the map's y.
  EXPECT_EQ(grid.at(Eigen::Vector2d(0.975, 1.125)), Cell::kFree);
  EXPECT_LT((grid.middleOf(2, 0) - Eigen::Vector2d(0.975, 1.125)).norm(), 1e-12);
}

TEST(OccupancyGrid, SightIsWhatSamplesAlongTheLineSay) {
  std::mt19937 generator(3);
  const OccupancyGrid grid = randomGrid(&generator);
  std::uniform_real_distribution<double> column(0.0, 80.0);
  std::uniform_real_distribution<double> row(0.0, 60.0);
  int clear = 0;
  for (int i = 0; i < 3000; ++i) {
    const Eigen::Vector2d from = grid.mapFromCells({column(generator), row(generator)});
    const Eigen::Vector2d to = grid.mapFromCells({column(generator), row(generator)});
    constexpr int kSamples = 4000;
    bool is_clear = true;
    for (int k = 0; k <= kSamples && is_clear; ++k) {
      is_clear = grid.at(Eigen::Vector2d(from + k * (to - from) / kSamples)) == Cell::kFree;
    }
    const bool answer = grid.isClear(from, to);
    clear += answer ? 1 : 0;
    // Samples may miss the corner of a cell.
    if (answer) {
      EXPECT_TRUE(is_clear) << i;
    } else if (is_clear) {
      const Eigen::Vector2d aside =
          1e-3 * Eigen::Vector2d(from.y() - to.y(), to.x() - from.x()).normalized();
      EXPECT_FALSE(grid.isClear(from + aside, to + aside) && grid.isClear(from - aside, to - aside))
          << i;
    }
  }
  EXPECT_GT(clear, 300);
  EXPECT_LT(clear, 2700);
}

TEST(OccupancyGrid, ClearanceIsTheDistanceToWhatIsNotFree) {
  std::mt19937 generator(4);
  const OccupancyGrid grid = randomGrid(&generator);
  const std::vector<double> clearances = grid.clearances();
  for (int row = 0; row < grid.rows(); row += 7) {
    for (int column = 0; column < grid.columns(); column += 5) {
      double nearest = 1e9;
      for (int v = -1; v <= grid.rows(); ++v) {
        for (int u = -1; u <= grid.columns(); ++u) {
          if (grid.at(u, v) == Cell::kFree) continue;
          nearest = std::min(nearest, std::hypot(u - column, v - row));
        }
      }
      EXPECT_NEAR(clearances[gridIndex(column, row, grid.columns())], nearest * grid.resolution(),
                  1e-3);
    }
  }
}

class GridFileTest : public testing::Test {
 protected:
  static GridFile load(const std::string& text) {
    const std::string path =
        (std::filesystem::temp_directory_path() / "omnitag_grid_file_test.yaml").string();
    std::ofstream(path) << text;
    return loadGridFile(path);
  }

  static std::string refusalOf(const std::string& text) {
    try {
      load(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
};

TEST_F(GridFileTest, IsReadAsMapServerWritesIt) {
  const GridFile file = load(
      "image: floor.pgm\nresolution: 0.05\norigin: [-10, -5.5, 0.1]\nnegate: 0\n"
      "occupied_thresh: 0.65\nfree_thresh: 0.196\n");
  EXPECT_EQ(std::filesystem::path(file.image).filename(), "floor.pgm");
  EXPECT_TRUE(std::filesystem::path(file.image).is_absolute());
  EXPECT_EQ(file.resolution, 0.05);
  EXPECT_EQ(file.origin, Eigen::Vector3d(-10.0, -5.5, 0.1));
  EXPECT_FALSE(file.negate);
}

TEST_F(GridFileTest, ErrorsNameTheKey) {
  const std::string rest = "origin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\n";
  EXPECT_NE(refusalOf("resolution: 0.05\n" + rest).find("image"), std::string::npos);
  EXPECT_NE(refusalOf("image: a.png\nresolution: 0\n" + rest).find("resolution: expected"),
            std::string::npos);
  EXPECT_NE(refusalOf("image: a.png\nresolution: 1\n" + rest + "free_thresh: 0.7\n")
                .find("free_thresh: expected a number <= occupied_thresh"),
            std::string::npos);
  EXPECT_NE(refusalOf("image: a.png\nresolution: 1\n" + rest + "free_thresh: 0.2\nmode: raw\n")
                .find("mode: expected trinary or scale, found 'raw'"),
            std::string::npos);
}

}  // namespace
}  // namespace omnitag
