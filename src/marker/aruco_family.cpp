#include "marker/aruco_family.h"

#include <opencv2/core/version.hpp>
// From OpenCV 4.7 on, the dictionaries are in the main modules.
#if __has_include(<opencv2/objdetect/aruco_dictionary.hpp>)
#include <opencv2/objdetect/aruco_dictionary.hpp>
#else
#include <opencv2/aruco/dictionary.hpp>
#endif

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "marker/code_family.h"

namespace omnitag {
namespace {

const std::map<std::string, int>& dictionaries() {
  using namespace cv::aruco;  // NOLINT(google-build-using-namespace): of nothing but these names
  static const std::map<std::string, int> by_name {
    {"DICT_4X4_50", DICT_4X4_50}, {"DICT_4X4_100", DICT_4X4_100}, {"DICT_4X4_250", DICT_4X4_250},
        {"DICT_4X4_1000", DICT_4X4_1000}, {"DICT_5X5_50", DICT_5X5_50},
        {"DICT_5X5_100", DICT_5X5_100}, {"DICT_5X5_250", DICT_5X5_250},
        {"DICT_5X5_1000", DICT_5X5_1000}, {"DICT_6X6_50", DICT_6X6_50},
        {"DICT_6X6_100", DICT_6X6_100}, {"DICT_6X6_250", DICT_6X6_250},
        {"DICT_6X6_1000", DICT_6X6_1000}, {"DICT_7X7_50", DICT_7X7_50},
        {"DICT_7X7_100", DICT_7X7_100}, {"DICT_7X7_250", DICT_7X7_250},
        {"DICT_7X7_1000", DICT_7X7_1000}, {"DICT_ARUCO_ORIGINAL", DICT_ARUCO_ORIGINAL},
        {"DICT_APRILTAG_16h5", DICT_APRILTAG_16h5}, {"DICT_APRILTAG_25h9", DICT_APRILTAG_25h9},
        {"DICT_APRILTAG_36h10", DICT_APRILTAG_36h10}, {"DICT_APRILTAG_36h11", DICT_APRILTAG_36h11},
#if CV_VERSION_MAJOR > 4 || CV_VERSION_MINOR >= 8
        {"DICT_ARUCO_MIP_36h12", DICT_ARUCO_MIP_36h12},
#endif
  };
  return by_name;
}

cv::aruco::Dictionary dictionaryOf(const std::string& name) {
  const int id = dictionaries().at(name);
#if CV_VERSION_MAJOR > 4 || CV_VERSION_MINOR >= 7
  return cv::aruco::getPredefinedDictionary(id);
#else
  return *cv::aruco::getPredefinedDictionary(id);
#endif
}

struct Cell {
  int column;
  int row;
};

/// The cells of a square with this many modules a side in the library's order: a quarter of them,
/// the same ones turned clockwise by a quarter, and so on, and last the middle one, if there is
/// one. A turn of the marker is thus a rotation of its bits.
std::vector<Cell> cellsInOrder(int side) {
  std::vector<Cell> cells;
  for (int ring = 0; ring < side / 2; ++ring) {
    for (int column = ring; column < side - 1 - ring; ++column) cells.push_back({column, ring});
  }
  const std::size_t quarter = cells.size();
  for (std::size_t i = 0; i < 3 * quarter; ++i) {
    const Cell before = cells[i];
    cells.push_back({side - 1 - before.row, before.column});
  }
  if (side % 2 == 1) cells.push_back({side / 2, side / 2});
  return cells;
}

}  // namespace

const std::set<std::string>& arucoDictionaries() {
  static const std::set<std::string> names = [] {
    std::set<std::string> result;
    for (const auto& [name, id] : dictionaries()) result.insert(name);
    return result;
  }();
  return names;
}

int arucoCount(const std::string& name) { return dictionaryOf(name).bytesList.rows; }

AprilTagFamily createArucoFamily(const std::string& name) {
  const cv::aruco::Dictionary dictionary = dictionaryOf(name);
  const int side = dictionary.markerSize;
  const std::vector<Cell> cells = cellsInOrder(side);

  CodeFamily family;
  family.name = name;
  for (int id = 0; id < dictionary.bytesList.rows; ++id) {
    const cv::Mat bits =
        cv::aruco::Dictionary::getBitsFromByteList(dictionary.bytesList.row(id), side);
    std::uint64_t code = 0;
    for (const Cell& cell : cells) {
      code = code << 1U | static_cast<std::uint64_t>(bits.at<std::uint8_t>(cell.row, cell.column));
    }
    family.codes.push_back(code);
  }
  for (const Cell& cell : cells) {
    // Counted from the corner of the black border.
    family.columns.push_back(static_cast<std::uint32_t>(cell.column + 1));
    family.rows.push_back(static_cast<std::uint32_t>(cell.row + 1));
  }
  family.border_width = side + 2;
  family.distance = 2 * dictionary.maxCorrectionBits + 1;
  return libraryFamily(std::move(family));
}

}  // namespace omnitag
