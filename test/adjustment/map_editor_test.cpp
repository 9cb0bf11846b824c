#include "adjustment/map_editor.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>

#include "omnitag/common/error.h"
#include "omnitag/marker/marker_map_file.h"

namespace omnitag {
namespace {

const std::string kFile =
    "# my hall\nfamily: tag36h11\nsize: 0.30   # m\nmarkers:\n"
    "  - {id: 3, position: [1.0, 2.5, 0.8], yaw: -1.5708}   # by the window\n"
    "  - {id: 7, name: door, position: [4, 0, 1.1], yaw: 3.1416, size: 0.20}  # oak\n"
    "  - {id: 7, position: [0, 0, 1.0], yaw: 0}\n";

class MapEditorTest : public testing::Test {
 protected:
  MapEditorTest() { write(kFile); }
  ~MapEditorTest() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& text) const { std::ofstream(path_) << text; }
  std::string read() const {
    std::ostringstream text;
    text << std::ifstream(path_).rdbuf();
    return text.str();
  }
  static std::string refusal(const std::function<void()>& work) {
    try {
      work();
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  static Marker marker(int id, const std::string& name) {
    Marker marker;
    marker.id = id;
    marker.name = name;
    marker.map_from_marker = Eigen::Translation3d(2.0, 1.0, 0.5) * uprightOrientation(0.3, 0.0);
    return marker;
  }
  static std::vector<std::string> names(const MarkerMap& map) {
    std::vector<std::string> names;
    for (const Marker& marker : map.markers) names.push_back(displayName(marker));
    return names;
  }

  using Names = std::vector<std::string>;
  std::filesystem::path folder_ = [] {
    std::string name = (std::filesystem::temp_directory_path() / "map_editor_XXXXXX").string();
    return std::filesystem::path(mkdtemp(name.data()));
  }();
  std::string path_ = (folder_ / "map.yaml").string();
};

TEST_F(MapEditorTest, TakesAnEditedFileAndSaysWhatChanged) {
  MapEditor editor(path_);
  write(kFile + "  - {id: 9, position: [0, 3, 1], yaw: 0}\n");
  EXPECT_EQ(editor.reload(), path_ + ": 1 added (tag36h11:9); 4 markers");
  EXPECT_EQ(editor.map().markers.size(), 4U);
  std::string moved = kFile;
  moved.replace(moved.find("[4, 0, 1.1]"), 11, "[4, 3, 1.1]");
  write(moved);
  EXPECT_EQ(editor.reload(), path_ +
                                 ": 1 removed (tag36h11:9), 1 changed, moved by up to 3.000 m "
                                 "(door); 3 markers");
  EXPECT_EQ(editor.reload(), path_ + ": nothing changed; 3 markers");
}

TEST_F(MapEditorTest, RefusesAWrongFileWithItsLineAndChangesNothing) {
  MapEditor editor(path_);
  editor.add(marker(20, "new"));
  write(kFile + "  - {id: 9, position: [0, 3], yaw: 0}\n");
  const std::string why = refusal([&] { editor.reload(); });
  EXPECT_NE(why.find(path_ + ":8: markers[3]"), std::string::npos) << why;
  EXPECT_EQ(editor.map().markers.size(), 4U);
  EXPECT_EQ(editor.unsavedChanges(), 1U);
  EXPECT_NE(refusal([&] { editor.change(path_ + ".none", false); }), "");
  EXPECT_EQ(editor.path(), path_);
}

TEST_F(MapEditorTest, KeepsUnsavedChangesWhereItReloads) {
  MapEditor editor(path_);
  editor.add(marker(20, "new"));
  editor.remove(MarkerSelection("tag36h11:3"));
  const Eigen::Isometry3d place(Eigen::Translation3d(4.0, 0.5, 1.1) * uprightOrientation(3.0, 0.0));
  editor.move(0, place);
  EXPECT_EQ(editor.unsavedChanges(), 3U);
  write(kFile + "  - {id: 9, position: [0, 3, 1], yaw: 0}\n");
  const std::string words = editor.reload();
  EXPECT_NE(words.find("1 added (tag36h11:9)"), std::string::npos) << words;
  EXPECT_NE(words.find("3 unsaved changes kept"), std::string::npos) << words;
  EXPECT_EQ(names(editor.map()), (Names{"door", "tag36h11:7", "tag36h11:9", "new"}));
  EXPECT_TRUE(editor.map().markers[0].map_from_marker.isApprox(place));
}

TEST_F(MapEditorTest, SavesChangesAndLeavesTheRestByteForByte) {
  MapEditor editor(path_);
  editor.add(marker(20, "new"));
  editor.remove(MarkerSelection("3"));
  editor.move(
      0, Eigen::Isometry3d(Eigen::Translation3d(4.0, 0.5, 1.1) * uprightOrientation(3.0, 0.0)));
  EXPECT_NE(editor.save().find("3 changes saved"), std::string::npos);
  EXPECT_EQ(editor.unsavedChanges(), 0U);
  EXPECT_EQ(read(),
            "# my hall\nfamily: tag36h11\nsize: 0.30   # m\nmarkers:\n"
            "  - {id: 7, name: \"door\", size: 0.2, position: [4, 0.5, 1.1], yaw: 3}  # oak\n"
            "  - {id: 7, position: [0, 0, 1.0], yaw: 0}\n"
            "  - {id: 20, name: \"new\", position: [2, 1, 0.5], yaw: 0.3}\n");
  EXPECT_EQ(names(loadMarkerMap(path_)), names(editor.map()));
}

TEST_F(MapEditorTest, SavesIntoAFileThatWasEditedMeanwhile) {
  MapEditor editor(path_);
  editor.remove(MarkerSelection("door"));
  write("# another remark\n" + kFile + "  - {id: 9, position: [0, 3, 1], yaw: 0}\n");
  editor.save();
  EXPECT_EQ(read().rfind("# another remark\n", 0), 0U);
  EXPECT_EQ(names(editor.map()), (Names{"tag36h11:3", "tag36h11:7", "tag36h11:9"}));
}

TEST_F(MapEditorTest, RefusesMarkersThatCannotBe) {
  MapEditor editor(path_);
  EXPECT_NE(refusal([&] { editor.add(marker(20, "door")); }).find("door"), std::string::npos);
  EXPECT_NE(refusal([&] { editor.add(marker(587, "")); }).find("0 to 586"), std::string::npos);
  Marker large = marker(20, "");
  large.size = -1.0;
  EXPECT_NE(refusal([&] { editor.add(large); }).find("size"), std::string::npos);
  large.family = "tag99";
  EXPECT_NE(refusal([&] { editor.add(large); }).find("tag99"), std::string::npos);
  EXPECT_NE(refusal([&] { editor.remove(MarkerSelection("window")); }).find("window"),
            std::string::npos);
  EXPECT_EQ(editor.unsavedChanges(), 0U);
  editor.remove(MarkerSelection("7"));
  EXPECT_NE(refusal([&] { editor.remove(MarkerSelection("3")); }), "");
}

TEST_F(MapEditorTest, AddsWithTheDefaultsOfTheMap) {
  MapEditor editor(path_);
  editor.add(marker(20, ""));
  const Marker& added = editor.map().markers.back();
  EXPECT_EQ(added.family, "tag36h11");
  EXPECT_EQ(added.size, 0.3);
  EXPECT_EQ(added.deviation, 0.005);
  EXPECT_EQ(added.orientation_deviation, 0.0175);
}

TEST_F(MapEditorTest, StaysInTheFrameOfItsMap) {
  MapEditor editor(path_);
  const std::string other = (folder_ / "other.yaml").string();
  std::ofstream(other) << "frame_id: cellar\n" << kFile;
  EXPECT_NE(refusal([&] { editor.change(other, false); }).find("frame_id"), std::string::npos);
  editor.add(marker(20, "new"));
  const std::string words = editor.change(other, true);
  EXPECT_NE(words.find("1 unsaved change of " + path_ + " dropped"), std::string::npos) << words;
  EXPECT_EQ(editor.path(), other);
}

TEST(MarkerSelectionTest, MeansNamesIdsAndFamilies) {
  Marker door;
  door.family = "tag36h11";
  door.id = 7;
  door.name = "door";
  EXPECT_TRUE(MarkerSelection("door").matches(door));
  EXPECT_TRUE(MarkerSelection("7").matches(door));
  EXPECT_TRUE(MarkerSelection("tag36h11:7").matches(door));
  EXPECT_FALSE(MarkerSelection("tag25h9:7").matches(door));
  EXPECT_FALSE(MarkerSelection("8").matches(door));
  EXPECT_FALSE(MarkerSelection("window").matches(door));
  EXPECT_TRUE(MarkerSelection("window").isName());
  EXPECT_FALSE(MarkerSelection("door").matches("tag36h11", 7));
  EXPECT_THROW(MarkerSelection(""), InputError);
  EXPECT_THROW(MarkerSelection("tag36h11:587"), InputError);
}

}  // namespace
}  // namespace omnitag
