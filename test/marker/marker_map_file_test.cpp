#include "omnitag/marker/marker_map_file.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "marker/pattern_picture.h"
#include "omnitag/common/angle.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

using Eigen::Vector3d;

constexpr const char* kGood = R"(
frame_id: hall
family: tag36h11
size: 0.30
markers:
  - {id: 3, position: [1, 2.5, 0.8], yaw: 0}
  - {id: 7, name: door, position: [4.0, 0.0, 1.1], yaw: 3.141592653589793, roll: 1.5707963, size: 2}
  - {id: 3, position: [9.0, 0.0, 1.0], yaw: -1, family: tag16h5}
  - {id: 586, name: ceiling, position: [0, 0, 3], orientation: [1.0005, 0, 0, 0]}
)";

TEST(MarkerMapFile, ReadsDefaultsAndExceptions) {
  const MarkerMap map = parseMarkerMap(kGood, "good.yaml");
  EXPECT_EQ(map.frame_id, "hall");
  ASSERT_EQ(map.markers.size(), 4u);

  EXPECT_EQ(map.markers[0].id, 3);
  EXPECT_EQ(map.markers[0].family, "tag36h11");
  EXPECT_EQ(map.markers[0].name, "");
  EXPECT_EQ(map.markers[0].size, 0.3);
  EXPECT_EQ(map.markers[0].center(), Vector3d(1.0, 2.5, 0.8));
  EXPECT_LT((map.markers[0].normal() - Vector3d::UnitX()).norm(), 1e-12);

  EXPECT_EQ(map.markers[1].name, "door");
  EXPECT_EQ(map.markers[1].size, 2.0);
  EXPECT_LT((map.markers[1].normal() + Vector3d::UnitX()).norm(), 1e-12);
  // The viewer looks along +x, with -y to the right; after a quarter turn x is up.
  EXPECT_LT((map.markers[1].map_from_marker.linear().col(0) - Vector3d::UnitZ()).norm(), 1e-6);

  EXPECT_EQ(map.markers[2].id, 3);
  EXPECT_EQ(map.markers[2].family, "tag16h5");

  // Half a turn about x: the face looks down. The norm, 0.05 % off, is corrected.
  EXPECT_LT((map.markers[3].normal() + Vector3d::UnitZ()).norm(), 1e-12);
  EXPECT_NEAR(map.markers[3].map_from_marker.linear().determinant(), 1.0, 1e-12);
}

TEST(MarkerMapFile, OrientationIsMarkerToMap) {
  const double half = radians(45.0);
  const MarkerMap map = parseMarkerMap(
      "{family: tag16h5, size: 1, markers: [{id: 0, position: [0, 0, 0], orientation: [0, 0, " +
          std::to_string(std::sin(half)) + ", " + std::to_string(std::cos(half)) + "]}]}",
      "inline");
  const Eigen::Matrix3d axes = map.markers[0].map_from_marker.linear();
  EXPECT_LT((axes.col(0) - Vector3d::UnitY()).norm(), 1e-5);
  EXPECT_LT((axes.col(1) + Vector3d::UnitX()).norm(), 1e-5);
}

TEST(MarkerMapFile, FrameIsMapWhereNotGiven) {
  EXPECT_EQ(parseMarkerMap("markers: [{family: tag16h5, size: 1, id: 0, position: [0, 0, 0], "
                           "yaw: 0}]",
                           "inline")
                .frame_id,
            "map");
}

struct BadMap {
  const char* name;
  std::string text;
  /// All must be in the one line of the error.
  std::vector<std::string> fragments;
};

void PrintTo(const BadMap& bad, std::ostream* out) { *out << bad.name; }

/// A map with two markers, of which the second, on line 5, has these keys.
std::string secondMarker(const std::string& keys) {
  return "family: tag36h11\n"
         "size: 0.3\n"
         "markers:\n"
         "  - {id: 1, name: a, position: [0, 0, 1], yaw: 0}\n"
         "  - {" +
         keys + "}\n";
}

const std::vector<BadMap> kBadMaps = {
    {"Empty", "", {"bad.yaml", "mapping", "empty"}},
    {"List", "- 1\n- 2\n", {"bad.yaml:1", "mapping", "list"}},
    {"Syntax", "family: tag36h11\nmarkers: [\n", {"bad.yaml:3"}},
    {"Tab", "family: tag36h11\nmarkers:\n\t- 1\n", {"bad.yaml:3"}},
    {"NoMarkers", "family: tag36h11\nsize: 1\n", {"bad.yaml:1", "markers", "found nothing"}},
    {"EmptyMarkers", "size: 1\nmarkers: []\n", {"bad.yaml:2", "markers", "at least one marker"}},
    {"BlankMarkers", "size: 1\nmarkers:\n", {"bad.yaml:2", "markers", "list", "empty value"}},
    {"MarkersIsMapping", "size: 1\nmarkers: {id: 1}\n", {"bad.yaml:2", "markers", "list"}},
    {"MarkerIsNumber", "size: 1\nmarkers: [7]\n", {"bad.yaml:2", "markers[0]", "mapping", "'7'"}},
    {"UnknownTopKey", "sizes: 1\nmarkers: []\n", {"bad.yaml:1", "sizes", "unknown key", "size"}},
    {"DuplicateTopKey", "size: 1\nsize: 2\nmarkers: []\n", {"bad.yaml:2", "size", "again"}},
    {"EmptyFrame", "frame_id: ''\nmarkers: []\n", {"bad.yaml:1", "frame_id", "frame"}},
    {"FrameIsList", "frame_id: [map]\nmarkers: []\n", {"bad.yaml:1", "frame_id", "text", "list"}},
    {"UnknownDefaultFamily",
     "family: tag36h12\nmarkers: []\n",
     {"bad.yaml:1", "family", "tag36h11", "tagStandard41h12", "'tag36h12'"}},
    {"NegativeDefaultSize", "size: -0.3\nmarkers: []\n", {"bad.yaml:1", "size", "> 0", "'-0.3'"}},
    {"BlankDefaultSize", "size:\nmarkers: []\n", {"bad.yaml:1", "size", "> 0", "empty value"}},
    {"NoSize",
     "family: tag36h11\nmarkers:\n  - {id: 1, position: [0, 0, 1], yaw: 0}\n",
     {"bad.yaml:3", "markers[0].size", "default", "found nothing"}},
    {"NoFamily",
     "size: 1\nmarkers:\n  - {id: 1, position: [0, 0, 1], yaw: 0}\n",
     {"bad.yaml:3", "markers[0].family", "default", "found nothing"}},
    {"NoId",
     secondMarker("position: [0, 0, 1], yaw: 0"),
     {"bad.yaml:5", "markers[1].id", "integer", "found nothing"}},
    {"NegativeId",
     secondMarker("id: -1, position: [0, 0, 1], yaw: 0"),
     {"bad.yaml:5", "markers[1].id", ">= 0", "'-1'"}},
    {"FractionalId",
     secondMarker("id: 1.5, position: [0, 0, 1], yaw: 0"),
     {"bad.yaml:5", "markers[1].id", "integer", "'1.5'"}},
    {"OctalId",
     secondMarker("id: 010, position: [0, 0, 1], yaw: 0"),
     {"bad.yaml:5", "markers[1].id", "integer", "'010'"}},
    {"IdNotInFamily",
     secondMarker("id: 587, position: [0, 0, 1], yaw: 0"),
     {"bad.yaml:5", "markers[1].id", "tag36h11", "0 to 586", "'587'"}},
    {"IdNotInItsOwnFamily",
     secondMarker("id: 30, family: tag16h5, position: [0, 0, 1], yaw: 0"),
     {"bad.yaml:5", "markers[1].id", "tag16h5", "0 to 29", "'30'"}},
    {"UnknownFamily",
     secondMarker("id: 2, family: aruco, position: [0, 0, 1], yaw: 0"),
     {"bad.yaml:5", "markers[1].family", "tag36h11", "'aruco'"}},
    {"ZeroSize",
     secondMarker("id: 2, size: 0, position: [0, 0, 1], yaw: 0"),
     {"bad.yaml:5", "markers[1].size", "> 0", "'0'"}},
    {"BlankSize",
     secondMarker("id: 2, size: , position: [0, 0, 1], yaw: 0"),
     {"bad.yaml:5", "markers[1].size", "> 0", "empty value"}},
    {"NanSize",
     secondMarker("id: 2, size: .nan, position: [0, 0, 1], yaw: 0"),
     {"bad.yaml:5", "markers[1].size", "> 0", "'.nan'"}},
    {"NoPosition",
     secondMarker("id: 2, yaw: 0"),
     {"bad.yaml:5", "markers[1].position", "3 numbers", "found nothing"}},
    {"ShortPosition",
     secondMarker("id: 2, position: [0, 1], yaw: 0"),
     {"bad.yaml:5", "markers[1].position", "3 numbers", "list of 2"}},
    {"WordInPosition",
     secondMarker("id: 2, position: [0, zero, 1], yaw: 0"),
     {"bad.yaml:5", "markers[1].position", "3 numbers", "'zero'"}},
    {"InfinitePosition",
     secondMarker("id: 2, position: [0, .inf, 1], yaw: 0"),
     {"bad.yaml:5", "markers[1].position", "3 numbers", "'.inf'"}},
    {"NoOrientation",
     secondMarker("id: 2, position: [0, 0, 1]"),
     {"bad.yaml:5", "markers[1]", "yaw", "orientation"}},
    {"YawIsWord",
     secondMarker("id: 2, position: [0, 0, 1], yaw: north"),
     {"bad.yaml:5", "markers[1].yaw", "number", "'north'"}},
    {"RollIsList",
     secondMarker("id: 2, position: [0, 0, 1], yaw: 0, roll: [1]"),
     {"bad.yaml:5", "markers[1].roll", "number", "list"}},
    {"YawBesideOrientation",
     secondMarker("id: 2, position: [0, 0, 1], yaw: 0, orientation: [0, 0, 0, 1]"),
     {"bad.yaml:5", "markers[1]", "yaw", "orientation", "both"}},
    {"RollBesideOrientation",
     secondMarker("id: 2, position: [0, 0, 1], roll: 0, orientation: [0, 0, 0, 1]"),
     {"bad.yaml:5", "markers[1]", "roll", "yaw", "orientation"}},
    {"RollAlone",
     secondMarker("id: 2, position: [0, 0, 1], roll: 0"),
     {"bad.yaml:5", "markers[1]", "yaw", "orientation"}},
    {"ShortOrientation",
     secondMarker("id: 2, position: [0, 0, 1], orientation: [0, 0, 1]"),
     {"bad.yaml:5", "markers[1].orientation", "4 numbers", "list of 3"}},
    {"ZeroOrientation",
     secondMarker("id: 2, position: [0, 0, 1], orientation: [0, 0, 0, 0]"),
     {"bad.yaml:5", "markers[1]", "orientation", "norm 1", "norm 0"}},
    {"LongOrientation",
     secondMarker("id: 2, position: [0, 0, 1], orientation: [0, 0, 0.1, 1]"),
     {"bad.yaml:5", "markers[1]", "orientation", "norm 1", "found norm 1.00"}},
    {"UnknownKey",
     secondMarker("id: 2, position: [0, 0, 1], Yaw: 0"),
     {"bad.yaml:5", "markers[1].Yaw", "unknown key", "yaw"}},
    {"DuplicateKey",
     secondMarker("id: 2, id: 3, position: [0, 0, 1], yaw: 0"),
     {"bad.yaml:5", "markers[1].id", "again"}},
    {"DuplicateName",
     secondMarker("id: 2, name: a, position: [0, 0, 1], yaw: 0"),
     {"bad.yaml:5", "markers[1].name", "no other marker", "'a'"}},
    {"EmptyName",
     secondMarker("id: 2, name: '', position: [0, 0, 1], yaw: 0"),
     {"bad.yaml:5", "markers[1].name", "''"}},
};

class BadMarkerMapFile : public testing::TestWithParam<BadMap> {};

TEST_P(BadMarkerMapFile, IsRefusedInOneLineThatNamesThePlace) {
  try {
    parseMarkerMap(GetParam().text, "bad.yaml");
    FAIL() << "accepted";
  } catch (const InputError& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    for (const std::string& fragment : GetParam().fragments) {
      EXPECT_NE(message.find(fragment), std::string::npos) << fragment << " in: " << message;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, BadMarkerMapFile, testing::ValuesIn(kBadMaps),
                         [](const auto& info) { return std::string(info.param.name); });

TEST(MarkerMapFile, LoadsAFile) {
  const std::string path = testing::TempDir() + "omnitag_marker_map_file_test.yaml";
  std::ofstream(path) << kGood;
  EXPECT_EQ(loadMarkerMap(path).markers.size(), 4u);
  std::remove(path.c_str());
}

TEST(MarkerMapFile, MissingFileIsNamed) {
  try {
    loadMarkerMap("/nowhere/map.yaml");
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("/nowhere/map.yaml"), std::string::npos);
  }
}

TEST(MarkerMapFileTest, MarkersHangAboutWhereItSays) {
  const std::string markers =
      "family: tag36h11\nsize: 0.3\nmarkers:\n"
      "  - {id: 3, position: [1, 2, 3], yaw: 0}\n"
      "  - {id: 4, position: [1, 2, 3], yaw: 0, deviation: 0, orientation_deviation: 0.1}\n";
  const MarkerMap usual = parseMarkerMap(markers, "map.yaml");
  EXPECT_EQ(usual.markers[0].deviation, 0.005);
  EXPECT_EQ(usual.markers[0].orientation_deviation, 0.0175);
  EXPECT_EQ(usual.markers[1].deviation, 0.0);
  EXPECT_EQ(usual.markers[1].orientation_deviation, 0.1);
  const MarkerMap stated =
      parseMarkerMap("deviation: 0.02\norientation_deviation: 0.05\n" + markers, "map.yaml");
  EXPECT_EQ(stated.markers[0].deviation, 0.02);
  EXPECT_EQ(stated.markers[0].orientation_deviation, 0.05);
  EXPECT_EQ(stated.markers[1].deviation, 0.0);
  EXPECT_THROW(parseMarkerMap("deviation: -1\n" + markers, "map.yaml"), InputError);
  EXPECT_THROW(parseMarkerMap("orientation_deviation: 3\n" + markers, "map.yaml"), InputError);
}

/// The text of a map in the package's folder of maps.
std::string patternMap(const std::string& entries, const std::string& defaults = "") {
  return "{family: artoolkit, size: 0.5, " + defaults + " markers: [" + entries + "]}";
}

MarkerMap parsePatternMap(const std::string& text) {
  return parseMarkerMap(text, std::string(PACKAGE_DIR) + "/maps/patterns.yaml");
}

constexpr const char* kMoon = "{pattern: patterns/moon.patt, position: [1, 0, 1], yaw: 0}";

TEST(MarkerMapFile, APatternsIdIsTheFirstEntryThatHasIt) {
  const std::string snake = "{pattern: patterns/snake.patt, position: [0, 0, 1], yaw: 0}";
  const std::string thin =
      "{pattern: patterns/moon.patt, border: 0.1, position: [2, 0, 1], yaw: 0}";
  const std::string code = "{family: tag36h11, id: 7, position: [3, 0, 1], yaw: 0}";
  const MarkerMap map = parsePatternMap(
      patternMap(code + ", " + snake + ", " + kMoon + ", " + snake + ", " + thin + ", " + kMoon));
  ASSERT_EQ(map.markers.size(), 6u);
  std::vector<int> ids;
  for (const Marker& marker : map.markers) ids.push_back(marker.id);
  EXPECT_EQ(ids, (std::vector<int>{7, 1, 2, 1, 4, 2}));
  EXPECT_EQ(map.markers[0].picture, nullptr);
  EXPECT_EQ(map.markers[1].picture, map.markers[3].picture);
  EXPECT_EQ(map.markers[2].picture->border, 0.25);
  EXPECT_EQ(map.markers[4].picture->border, 0.1);
  EXPECT_EQ(map.markers[4].picture->white, map.markers[2].picture->white);
  EXPECT_EQ(map.markers[2].family, "artoolkit");
}

TEST(MarkerMapFile, APatternIsTheSameHoweverItsPathIsSpelt) {
  const MarkerMap map = parsePatternMap(
      patternMap(std::string(kMoon) +
                 ", {pattern: patterns/../patterns/moon.patt, position: [1, 2, 1], yaw: 0}"));
  EXPECT_EQ(map.markers[1].id, 0);
}

TEST(MarkerMapFile, TheBorderOfAllPatternsMayBeSaidOnce) {
  const MarkerMap map = parsePatternMap(patternMap(kMoon, "border: 0.2,"));
  EXPECT_EQ(map.markers[0].picture->border, 0.2);
}

TEST(MarkerMapFile, PatternsAndIdsAreNotMixedUp) {
  const auto refusal = [](const std::string& text) -> std::string {
    try {
      parsePatternMap(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const std::string place = "position: [0, 0, 1], yaw: 0}";
  const auto expectRefused = [&](const std::string& entry, const std::string& words) {
    const std::string told = refusal(patternMap(entry));
    EXPECT_NE(told.find(words), std::string::npos) << told;
  };
  expectRefused("{id: 3, " + place, "id: expected a pattern instead");
  expectRefused("{pattern: patterns/moon.patt, id: 3, " + place, "id: expected a pattern instead");
  expectRefused("{" + place, "pattern: expected the path of a pattern file");
  expectRefused("{family: tag36h11, id: 3, pattern: patterns/moon.patt, " + place,
                "pattern: expected none");
  expectRefused("{family: tag36h11, id: 3, border: 0.2, " + place, "border: expected none");
  expectRefused("{pattern: patterns/moon.patt, border: 0.5, " + place, "border: expected");
  expectRefused("{pattern: nowhere.patt, " + place, "nowhere.patt: cannot be read");
}

}  // namespace
}  // namespace omnitag
