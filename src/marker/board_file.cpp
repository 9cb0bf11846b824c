#include "marker/board_file.h"

#include "common/yaml_reader.h"
#include "marker/aprilgrid_family.h"
#include "marker/tag_family.h"

namespace omnitag {
namespace {

/// Columns or rows.
constexpr Interval kTags{1.0, 600.0};
constexpr Interval kSquares{2.0, 600.0};

Marker markerAt(const std::string& family, int id, double size, const Eigen::Vector2d& center) {
  Marker marker;
  marker.family = family;
  marker.id = id;
  marker.size = size;
  marker.map_from_marker.translation().head<2>() = center;
  return marker;
}

bool hasEnoughIds(const MarkerMap& board) {
  return board.markers.back().id < tagCount(board.markers.back().family);
}

/// As Kalibr's kalibr_create_target_pdf draws it: ids run from the lower left to the right, row by
/// row upward.
MarkerMap readAprilGrid(const YamlReader& reader) {
  reader.allowOnly({"target_type", "tagCols", "tagRows", "tagSize", "tagSpacing"});
  const int columns = reader.integer("tagCols", kTags);
  const int rows = reader.integer("tagRows", kTags);
  const double size = reader.number("tagSize", kPositive);
  constexpr Interval kSpacing{0.0, 1.0, false};
  const double step = size * (1.0 + reader.number("tagSpacing", kSpacing));
  MarkerMap board;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const Eigen::Vector2d lower_left(column * step, row * step);
      board.markers.push_back(markerAt(kAprilGridFamily, row * columns + column, size,
                                       lower_left + Eigen::Vector2d::Constant(0.5 * size)));
    }
  }
  if (!hasEnoughIds(board)) {
    reader.refuse("tagRows", "few enough for the " + std::to_string(tagCount(kAprilGridFamily)) +
                                 " ids of the tags");
  }
  return board;
}

/// As OpenCV's CharucoBoard draws it: ids run over the white squares from the upper left to the
/// right, row by row downward. The upper left square is black; on a legacy board it is white if
/// there is an even number of rows.
MarkerMap readCharuco(const YamlReader& reader) {
  reader.allowOnly(
      {"target_type", "columns", "rows", "square_size", "marker_size", "dictionary", "legacy"});
  const int columns = reader.integer("columns", kSquares);
  const int rows = reader.integer("rows", kSquares);
  const double square = reader.number("square_size", kPositive);
  const double size = reader.number("marker_size", kPositive);
  if (size >= square) reader.refuse("marker_size", "less than square_size");
  const std::string dictionary = reader.text("dictionary");
  if (dictionary.rfind("DICT_", 0) != 0 || tagFamilies().count(dictionary) == 0) {
    reader.refuse("dictionary", "one of OpenCV's, such as DICT_5X5_100");
  }
  bool is_legacy = false;
  reader.read("legacy", &is_legacy);
  const int first_white = is_legacy && rows % 2 == 0 ? 0 : 1;
  MarkerMap board;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      if ((row + column) % 2 != first_white) continue;
      const Eigen::Vector2d center((column + 0.5) * square, (rows - row - 0.5) * square);
      const auto id = static_cast<int>(board.markers.size());
      board.markers.push_back(markerAt(dictionary, id, size, center));
    }
  }
  if (!hasEnoughIds(board)) {
    reader.refuse("dictionary",
                  "one with " + std::to_string(board.markers.size()) + " ids or more");
  }
  return board;
}

MarkerMap readBoard(const YamlReader& reader) {
  const std::string type = reader.text("target_type");
  if (type != "aprilgrid" && type != "charuco") {
    reader.refuse("target_type", "aprilgrid or charuco");
  }
  MarkerMap board = type == "aprilgrid" ? readAprilGrid(reader) : readCharuco(reader);
  board.frame_id = "board";
  return board;
}

}  // namespace

MarkerMap loadBoard(const std::string& path) { return readBoard(YamlReader::fromFile(path)); }

MarkerMap parseBoard(const std::string& text, const std::string& origin) {
  return readBoard(YamlReader::fromText(text, origin));
}

}  // namespace omnitag
