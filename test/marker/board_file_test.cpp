#include "marker/board_file.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "omnitag/common/error.h"

namespace omnitag {
namespace {

TEST(BoardFile, AnAprilGridRunsFromTheLowerLeft) {
  const MarkerMap board = parseBoard(
      "target_type: 'aprilgrid'\ntagCols: 3\ntagRows: 2\ntagSize: 0.1\ntagSpacing: 0.3\n", "grid");
  EXPECT_EQ(board.frame_id, "board");
  ASSERT_EQ(board.markers.size(), 6u);
  for (int id = 0; id < 6; ++id) {
    const Marker& marker = board.markers[static_cast<std::size_t>(id)];
    EXPECT_EQ(marker.family, "aprilgrid");
    EXPECT_EQ(marker.id, id);
    EXPECT_EQ(marker.size, 0.1);
    EXPECT_EQ(marker.deviation, 0.0);
    EXPECT_EQ(marker.orientation_deviation, 0.0);
  }
  // Lower left of the border of tag 0 is the origin; 13 cm from tag to tag.
  EXPECT_LT((board.markers[0].center() - Eigen::Vector3d(0.05, 0.05, 0.0)).norm(), 1e-12);
  EXPECT_LT((board.markers[2].center() - Eigen::Vector3d(0.31, 0.05, 0.0)).norm(), 1e-12);
  EXPECT_LT((board.markers[3].center() - Eigen::Vector3d(0.05, 0.18, 0.0)).norm(), 1e-12);
  EXPECT_LT((board.markers[0].normal() - Eigen::Vector3d::UnitZ()).norm(), 1e-12);
}

/// Where a ChArUco board of 0.1 m squares has its markers, in squares from the upper left.
std::vector<Eigen::Vector2i> whiteSquares(const std::string& more) {
  const MarkerMap board = parseBoard(
      "{target_type: charuco, square_size: 0.1, marker_size: 0.07, dictionary: DICT_5X5_100, " +
          more + "}",
      "charuco");
  std::vector<Eigen::Vector2i> squares;
  const int rows = more.find("rows: 3") == std::string::npos ? 4 : 3;
  for (std::size_t i = 0; i < board.markers.size(); ++i) {
    EXPECT_EQ(board.markers[i].id, static_cast<int>(i));
    const Eigen::Vector3d center = board.markers[i].center() / 0.1;
    squares.emplace_back(static_cast<int>(center.x()), rows - 1 - static_cast<int>(center.y()));
  }
  return squares;
}

TEST(BoardFile, ACharucoBoardHasItsMarkersInWhiteSquares) {
  using Squares = std::vector<Eigen::Vector2i>;
  const Squares odd = {{1, 0}, {0, 1}, {2, 1}, {1, 2}};
  EXPECT_EQ(whiteSquares("columns: 3, rows: 3"), odd);
  EXPECT_EQ(whiteSquares("columns: 3, rows: 3, legacy: true"), odd);
  const Squares even = {{1, 0}, {0, 1}, {2, 1}, {1, 2}, {0, 3}, {2, 3}};
  EXPECT_EQ(whiteSquares("columns: 3, rows: 4"), even);
  const Squares legacy = {{0, 0}, {2, 0}, {1, 1}, {0, 2}, {2, 2}, {1, 3}};
  EXPECT_EQ(whiteSquares("columns: 3, rows: 4, legacy: true"), legacy);
}

std::string refusal(const std::string& text) {
  try {
    parseBoard(text, "board.yaml");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(BoardFile, WhatIsNoBoardIsRefusedByItsKey) {
  const auto expectRefused = [](const std::string& text, const std::string& words) {
    const std::string told = refusal(text);
    EXPECT_NE(told.find("board.yaml"), std::string::npos) << told;
    EXPECT_NE(told.find(words), std::string::npos) << told;
  };
  const std::string grid = "target_type: aprilgrid, tagCols: 6, tagSize: 0.1, tagSpacing: 0.3, ";
  expectRefused("{tagCols: 6}", "target_type");
  expectRefused("{target_type: checkerboard}", "target_type: expected aprilgrid or charuco");
  expectRefused("{" + grid + "tagRows: 0}", "tagRows");
  expectRefused("{" + grid + "tagRows: 100}", "tagRows: expected few enough");
  expectRefused("{" + grid + "tagRows: 6, columns: 3}", "columns");
  const std::string charuco = "target_type: charuco, columns: 5, rows: 7, square_size: 0.04, ";
  expectRefused("{" + charuco + "marker_size: 0.04, dictionary: DICT_4X4_50}", "marker_size");
  expectRefused("{" + charuco + "marker_size: 0.03, dictionary: tag36h11}", "dictionary");
  expectRefused(
      "{target_type: charuco, columns: 12, rows: 12, square_size: 0.04, marker_size: 0.03, "
      "dictionary: DICT_4X4_50}",
      "dictionary: expected one with 72 ids or more");
}

}  // namespace
}  // namespace omnitag
