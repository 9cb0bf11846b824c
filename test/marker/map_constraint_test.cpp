#include "marker/map_constraint.h"

#include <gtest/gtest.h>

#include <string>

#include "omnitag/common/error.h"
#include "omnitag/marker/marker_map_file.h"

namespace omnitag {
namespace {

const std::string kMarkers =
    "family: tag36h11\nsize: 0.3\nmarkers:\n"
    "  - {id: 3, position: [1, 2, 1], yaw: 0}\n"
    "  - {id: 7, name: door, position: [4, 0, 1], yaw: 1}\n";

std::vector<MapConstraint> constraintsOf(const std::string& text) {
  return readConstraints(YamlReader::fromText(kMarkers + text, "map.yaml"));
}

/// The error of loading a whole map with these constraints; empty if it loads.
std::string refusal(const std::string& text) {
  try {
    parseMarkerMap(kMarkers + text, "map.yaml");
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(MapConstraintTest, ReadsAllKinds) {
  const auto constraints = constraintsOf(
      "constraints:\n"
      "  - {distance: [door, 3], value: 3.215, deviation: 0.003}\n"
      "  - {plane: [3, 7, 12, 13], deviation: 0.005}\n"
      "  - {vertical: [3], deviation: 0.01}\n"
      "  - {height: 12, value: 1.2, deviation: 0.003}\n");
  ASSERT_EQ(constraints.size(), 4U);
  EXPECT_EQ(constraints[0].kind, MapConstraint::Kind::kDistance);
  EXPECT_EQ(constraints[0].markers[0].name, "door");
  EXPECT_EQ(constraints[0].markers[1].id, 3);
  EXPECT_EQ(constraints[0].value, 3.215);
  EXPECT_EQ(constraints[0].deviation, 0.003);
  EXPECT_EQ(constraints[0].text(), "distance of door, 3");
  EXPECT_EQ(constraints[1].kind, MapConstraint::Kind::kPlane);
  EXPECT_EQ(constraints[1].markers.size(), 4U);
  EXPECT_EQ(constraints[2].kind, MapConstraint::Kind::kVertical);
  EXPECT_EQ(constraints[3].kind, MapConstraint::Kind::kHeight);
  EXPECT_EQ(constraints[3].markers[0].id, 12);
  EXPECT_TRUE(constraintsOf("").empty());
}

TEST(MapConstraintTest, RefusesWhatIsNone) {
  EXPECT_EQ(refusal("constraints: [{height: 3, value: 1, deviation: 0.1}]\n"), "");
  const std::pair<const char*, const char*> cases[] = {
      {"{distance: [3], value: 1, deviation: 0.1}", "distance"},
      {"{distance: [3, 3], value: 1, deviation: 0.1}", "once"},
      {"{distance: [3, 7], value: -1, deviation: 0.1}", "value"},
      {"{distance: [3, 7], deviation: 0.1}", "value"},
      {"{distance: [3, 7], value: 1, deviation: 0}", "deviation"},
      {"{plane: [3, 7], deviation: 0.1}", "plane"},
      {"{plane: [3, 7, 9], value: 1, deviation: 0.1}", "value"},
      {"{vertical: 3, deviation: 0.1}", "vertical"},
      {"{angle: [3, 7], deviation: 0.1}", "distance, plane, vertical or height"}};
  for (const auto& [entry, part] : cases) {
    const std::string message = refusal("constraints:\n  - " + std::string(entry) + "\n");
    EXPECT_EQ(message.rfind("map.yaml:", 0), 0U) << entry << ": " << message;
    EXPECT_NE(message.find(part), std::string::npos) << entry << ": " << message;
  }
}

}  // namespace
}  // namespace omnitag
