#include "marker/marker_map_writer.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "common/file_replacement.h"
#include "marker/pattern_picture.h"
#include "omnitag/common/angle.h"
#include "omnitag/common/error.h"
#include "omnitag/marker/marker_map_file.h"

namespace omnitag {
namespace {

MapEntry entry(int id, double yaw, double tilt) {
  Marker marker;
  marker.family = "tag36h11";
  marker.id = id;
  marker.size = 0.3;
  marker.map_from_marker =
      Eigen::Translation3d(1.234567, -2.5, 0.8) *
      (Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitY()) * uprightOrientation(yaw, 0.25));
  marker.deviation = 0.0031;
  marker.orientation_deviation = 0.02;
  return {marker, "mapped"};
}

const std::vector<std::string> kFiles = {
    // A list on its own lines, with comments, and no newline at the end.
    "# my hall\nfamily: tag36h11\nsize: 0.30   # m\nmarkers:\n"
    "  - {id: 3, position: [1.0, 2.5, 0.8], yaw: -1.5708}   # by the window\n"
    "  - {id: 7, name: \"a # b\", position: [4, 0, 1.1], yaw: 3.1416, size: 0.20}\n\n# the end",
    // Not indented, entries over several lines, followed by other keys.
    "markers:\n- id: 3\n  position: [1, 2, 3]\n  yaw: 0\n- id: 4\n  position: [1, 2, 3]\n"
    "  orientation: [0, 0, 0, 1]\n  # about the size\nsize: 0.4\nfamily: tag36h11\n",
    // In brackets, on one line or several.
    "family: tag36h11\nsize: 0.3\nmarkers: [{id: 3, position: [1, 2, 3], yaw: 0}]  # one\n",
    "family: tag36h11\nsize: 0.3\nmarkers: [\n  {id: 3, name: 'it''s [', position: [1, 2, 3], "
    "yaw: 0},  # ] first\n  {id: 5, position: [1, 2, 3], yaw: 0},\n]\n",
    "size: 0.3\nmarkers: [{family: tag36h11, id: 3, name: Bob's door, position: [1, 2, 3], yaw: "
    "0}, {family: tag36h11, id: 5, name: \"a \\\"]\", position: [1, 2, 3], yaw: 0}]\nfamily: "
    "tag36h11\n",
    // From another system.
    "family: tag36h11\r\nsize: 0.3\r\nmarkers:\r\n  - {id: 3, position: [1, 2, 3], yaw: 0}\r\n"};

TEST(MarkerMapWriterTest, MovesEachMarkerInItsPlace) {
  for (const std::string& file : kFiles) {
    const MarkerMap before = parseMarkerMap(file, "before");
    for (std::size_t i = 0; i < before.markers.size(); ++i) {
      std::vector<EntryChange> changes(before.markers.size());
      changes[i].moved = before.markers[i];
      changes[i].moved->map_from_marker.pretranslate(Eigen::Vector3d(0.5, 0.25, -0.125));
      const MarkerMap after = parseMarkerMap(withChanges(file, changes, {}, "map.yaml"), "after");
      ASSERT_EQ(after.markers.size(), before.markers.size()) << file;
      for (std::size_t k = 0; k < after.markers.size(); ++k) {
        const Eigen::Vector3d way = after.markers[k].center() - before.markers[k].center();
        const Eigen::Vector3d expected =
            k == i ? Eigen::Vector3d(0.5, 0.25, -0.125) : Eigen::Vector3d::Zero();
        EXPECT_LT((way - expected).norm(), 2e-6) << file;
        EXPECT_EQ(after.markers[k].name, before.markers[k].name);
      }
    }
  }
}

TEST(MarkerMapWriterTest, RemovesEachMarkerAndLeavesAllElseByteForByte) {
  for (const std::string& file : kFiles) {
    const MarkerMap before = parseMarkerMap(file, "before");
    if (before.markers.size() < 2) continue;
    for (std::size_t i = 0; i < before.markers.size(); ++i) {
      std::vector<EntryChange> changes(before.markers.size());
      changes[i].is_removed = true;
      const std::string text = withChanges(file, changes, {}, "map.yaml");
      const MarkerMap after = parseMarkerMap(text, "after");
      ASSERT_EQ(after.markers.size(), before.markers.size() - 1) << file;
      EXPECT_EQ(after.markers.front().id, before.markers[i == 0 ? 1 : 0].id);
      // What is left is the old text with something taken out.
      std::size_t same = 0;
      while (same < text.size() && text[same] == file[same]) ++same;
      const std::string rest = text.substr(same);
      EXPECT_EQ(file.substr(file.size() - rest.size()), rest) << text;
    }
  }
}

TEST(MarkerMapWriterTest, AddsMarkersAndLeavesAllElseByteForByte) {
  const std::vector<MapEntry> added = {entry(10, 0.7, 0.0), entry(11, -2.0, 0.3)};
  for (const std::string& file : kFiles) {
    const std::string text = withEntries(file, added, "map.yaml");
    // What was there, in its order: the new text is the old one with something inserted.
    std::size_t same = 0;
    while (same < file.size() && text[same] == file[same]) ++same;
    const std::string rest = file.substr(same);
    EXPECT_EQ(text.substr(text.size() - rest.size()), rest) << file;

    const MarkerMap before = parseMarkerMap(file, "before");
    const MarkerMap after = parseMarkerMap(text, "after");
    ASSERT_EQ(after.markers.size(), before.markers.size() + 2) << text;
    for (std::size_t i = 0; i < before.markers.size(); ++i) {
      EXPECT_EQ(after.markers[i].id, before.markers[i].id);
      EXPECT_EQ(after.markers[i].name, before.markers[i].name);
      EXPECT_TRUE(after.markers[i].map_from_marker.isApprox(before.markers[i].map_from_marker));
    }
    for (std::size_t i = 0; i < added.size(); ++i) {
      const Marker& marker = after.markers[before.markers.size() + i];
      EXPECT_EQ(marker.id, added[i].marker.id);
      EXPECT_DOUBLE_EQ(marker.size, 0.3);
      EXPECT_NEAR(marker.deviation, 0.0031, 1e-9);
      EXPECT_NEAR(marker.orientation_deviation, 0.02, 1e-9);
      EXPECT_LT((marker.center() - added[i].marker.center()).norm(), 1e-6);
      EXPECT_LT((marker.map_from_marker.linear() - added[i].marker.map_from_marker.linear()).norm(),
                3e-6);
    }
  }
}

TEST(MarkerMapWriterTest, UprightMarkersHaveAYawAndARoll) {
  const std::string text =
      withEntries(kFiles[0], {entry(10, 0.7, 0.0), entry(11, 0.7, 0.1)}, "map.yaml");
  EXPECT_NE(text.find("{id: 10, position: [1.234567, -2.5, 0.8], yaw: 0.7, roll: 0.25, "
                      "deviation: 0.0031, orientation_deviation: 0.02}  # mapped\n"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("{id: 11, position: [1.234567, -2.5, 0.8], orientation: ["),
            std::string::npos);
}

TEST(MarkerMapWriterTest, WritesANewMap) {
  MapEntry named = entry(2, 1.0, 0.0);
  named.marker.name = "door: \"left\"";
  named.marker.size = 0.5;
  const MarkerMap map =
      parseMarkerMap(newMapText("hall", {entry(1, 0.5, 0.2), named}, "new"), "new");
  EXPECT_EQ(map.frame_id, "hall");
  ASSERT_EQ(map.markers.size(), 2U);
  EXPECT_EQ(map.markers[1].name, named.marker.name);
  EXPECT_DOUBLE_EQ(map.markers[1].size, 0.5);
  EXPECT_DOUBLE_EQ(map.markers[0].size, 0.3);
}

TEST(MarkerMapWriterTest, RefusesWhatItCannotAddTo) {
  const std::string odd =
      "family: tag36h11\nsize: 0.3\nmarkers:\n  -\n    id: 3\n"
      "    position: [1, 2, 3]\n    yaw: 0\n";
  for (const std::string& text : {std::string("nothing"), odd}) {
    try {
      withEntries(text, {entry(10, 0.0, 0.0)}, "map.yaml");
      ADD_FAILURE() << text;
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).rfind("map.yaml", 0), 0U) << error.what();
    }
  }
}

class ReplaceFileTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (std::filesystem::temp_directory_path() / "omnitagXXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  static std::string textOf(const std::string& path) {
    std::ifstream stream(path);
    return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  }

  std::filesystem::path folder_;
};

TEST_F(ReplaceFileTest, KeepsTheOldFileAsBackupAndItsPermissions) {
  replaceFile(path("m.yaml"), "one\n");
  EXPECT_FALSE(std::filesystem::exists(path("m.yaml~")));
  std::filesystem::permissions(path("m.yaml"), std::filesystem::perms::owner_all);
  replaceFile(path("m.yaml"), "two\n");
  EXPECT_EQ(textOf(path("m.yaml")), "two\n");
  EXPECT_EQ(textOf(path("m.yaml~")), "one\n");
  EXPECT_EQ(std::filesystem::status(path("m.yaml")).permissions(),
            std::filesystem::perms::owner_all);
  EXPECT_FALSE(std::filesystem::exists(path("m.yaml.new")));
}

TEST_F(ReplaceFileTest, FollowsALink) {
  replaceFile(path("real.yaml"), "one\n");
  std::filesystem::create_symlink("real.yaml", path("link.yaml"));
  replaceFile(path("link.yaml"), "two\n");
  EXPECT_TRUE(std::filesystem::is_symlink(path("link.yaml")));
  EXPECT_EQ(textOf(path("real.yaml")), "two\n");
}

TEST_F(ReplaceFileTest, LeavesTheFileWhereItCannotBeReplaced) {
  replaceFile(path("m.yaml"), "one\n");
  std::filesystem::create_directory(path("m.yaml.new"));
  EXPECT_THROW(replaceFile(path("m.yaml"), "two\n"), InputError);
  EXPECT_EQ(textOf(path("m.yaml")), "one\n");
  EXPECT_THROW(replaceFile(path("missing/m.yaml"), "two\n"), InputError);
}

TEST(MarkerMapWriter, PatternsAreWrittenRelativeToTheNewFile) {
  const std::string maps = std::string(PACKAGE_DIR) + "/maps/";
  const MarkerMap map = parseMarkerMap(
      "{family: artoolkit, size: 0.5, markers: ["
      "{pattern: patterns/moon.patt, position: [1, 0, 1], yaw: 0},"
      "{pattern: patterns/snake.patt, border: 0.2, position: [2, 0, 1], yaw: 0}]}",
      maps + "seed.yaml");
  const std::string path = maps + "patterns/new.yaml";
  const std::string text = newMapText("map", {{map.markers[0], ""}, {map.markers[1], ""}}, path);
  EXPECT_NE(text.find("pattern: \"moon.patt\""), std::string::npos) << text;
  const MarkerMap again = parseMarkerMap(text, path);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(again.markers[i].picture->white, map.markers[i].picture->white);
    EXPECT_EQ(again.markers[i].picture->border, map.markers[i].picture->border);
  }
}

TEST(MarkerMapWriter, PatternsKeepTheirPathsWhenTheirEntriesChange) {
  const std::string origin = std::string(PACKAGE_DIR) + "/maps/seed.yaml";
  const std::string text =
      "family: artoolkit\nsize: 0.5\nborder: 0.2\nmarkers:\n"
      "  - {pattern: patterns/moon.patt, position: [1, 0, 1], yaw: 0}\n"
      "  - {pattern: patterns/snake.patt, position: [2, 0, 1], yaw: 0}\n"
      "  - {pattern: patterns/moon.patt, position: [3, 0, 1], yaw: 0}\n";
  MarkerMap map = parseMarkerMap(text, origin);
  Marker moved = map.markers[2];
  moved.map_from_marker.translation().x() = 3.5;
  // Without the first entry, its pattern gets another id.
  const std::string changed =
      withChanges(text, {{true, std::nullopt}, {}, {false, moved}}, {{map.markers[0], ""}}, origin);
  const MarkerMap after = parseMarkerMap(changed, origin);
  ASSERT_EQ(after.markers.size(), 3u);
  EXPECT_EQ(after.markers[1].picture->name, "patterns/moon.patt");
  EXPECT_EQ(after.markers[1].center().x(), 3.5);
  EXPECT_EQ(after.markers[1].id, 1);
  EXPECT_EQ(after.markers[2].id, 1);
}

TEST(MarkerMapWriter, AMovedMapFindsItsPatterns) {
  const std::string origin = std::string(PACKAGE_DIR) + "/maps/seed.yaml";
  const std::string text =
      "# a map\nfamily: artoolkit\nsize: 0.5\nborder: 0.1428571\nmarkers:\n"
      "  - {pattern: patterns/moon.patt, position: [1, 0, 1], yaw: 0}\n"
      "  - {family: tag36h11, id: 3, position: [2, 0, 1], yaw: 0}\n";
  EXPECT_EQ(movedMapText(text, origin, std::string(PACKAGE_DIR) + "/maps/other.yaml"), text);
  // A file in the current folder, as users name it.
  const MarkerMap map = parseMarkerMap(movedMapText(text, origin, "moved.yaml"), "moved.yaml");
  ASSERT_EQ(map.markers.size(), 2u);
  EXPECT_NEAR(map.markers[0].picture->border, 0.1428571, 1e-6);
  EXPECT_EQ(map.markers[1].id, 3);
}

}  // namespace
}  // namespace omnitag
