import math
import unittest

from source_tree import FileTest

import numpy as np
from omnitag.marker_map import load_marker_map

HEAD = "frame_id: map\nfamily: tag36h11\nsize: 0.30\nmarkers:\n"


class MarkerMapTest(FileTest):
    def load(self, text):
        return load_marker_map(self.write("map.yaml", text))

    def marker(self, text):
        return self.load(HEAD + "  - {" + text + "}\n").markers[0]

    def test_defaults_and_overrides(self):
        marker_map = self.load(
            HEAD + "  - {id: 3, position: [1, 2.5, 8e-1], yaw: 0}\n"
            "  - {id: 3, name: door, family: tag16h5, size: 1, position: [0, 0, 0], yaw: 1}\n")
        first, second = marker_map.markers
        self.assertEqual(marker_map.frame_id, "map")
        self.assertEqual((first.id, first.family, first.size, first.label),
                         (3, "tag36h11", 0.3, "3"))
        self.assertEqual(first.position.tolist(), [1.0, 2.5, 0.8])
        self.assertEqual((second.family, second.size, second.label), ("tag16h5", 1.0, "door"))

    def test_frame_id_is_map_by_default(self):
        entry = "  - {id: 1, position: [0, 0, 0], yaw: 0}\n"
        self.assertEqual(self.load(HEAD.replace("frame_id: map\n", "") + entry).frame_id, "map")
        self.assertEqual(self.load(HEAD.replace(": map", ": hall") + entry).frame_id, "hall")

    def test_upright_marker_that_faces_along_x(self):
        # Who looks at it looks along -x: right is +y, up is +z.
        marker = self.marker("id: 0, position: [4, 0, 1], yaw: 0, size: 2")
        np.testing.assert_allclose(marker.normal, [1, 0, 0], atol=1e-15)
        np.testing.assert_allclose(
            marker.corners, [[4, -1, 0], [4, 1, 0], [4, 1, 2], [4, -1, 2]], atol=1e-15)

    def test_yaw_is_the_heading_of_the_normal(self):
        marker = self.marker("id: 0, position: [0, 0, 0], yaw: {}".format(math.radians(120)))
        np.testing.assert_allclose(marker.normal, [-0.5, math.sqrt(0.75), 0], atol=1e-15)

    def test_roll_is_counter_clockwise_as_seen(self):
        # The lower left corner (y = -1, z = 0) goes to the lower right (y = 1, z = 0).
        marker = self.marker("id: 0, position: [4, 0, 1], yaw: 0, roll: {}, size: 2".format(
            math.pi / 2))
        np.testing.assert_allclose(marker.corners[0], [4, 1, 0], atol=1e-15)
        np.testing.assert_allclose(marker.corners[1], [4, 1, 2], atol=1e-15)

    def test_orientation_of_a_marker_on_the_floor_and_on_a_wall(self):
        floor = self.marker("id: 0, position: [0, 0, 0], orientation: [0, 0, 0, 1], size: 2")
        np.testing.assert_allclose(floor.corners[2], [1, 1, 0], atol=1e-15)
        # 120 degrees about (1, 1, 1) takes x to y, y to z and z to x: an upright marker of yaw 0.
        wall = self.marker("id: 0, position: [0, 0, 0], orientation: [0.5, 0.5, 0.5, 0.5]")
        upright = self.marker("id: 0, position: [0, 0, 0], yaw: 0")
        np.testing.assert_allclose(wall.map_from_marker, upright.map_from_marker, atol=1e-15)

    def test_bad_entries_are_named(self):
        for entry, *parts in (
                ("position: [0, 0, 0], yaw: 0", "markers[0]", "'id'"),
                ("id: 1, yaw: 0", "markers[0]", "'position'"),
                ("id: 1, position: [0, 0, 0]", "'yaw' or 'orientation'", "neither"),
                ("id: 1, position: [0, 0, 0], roll: 0", "'yaw' or 'orientation'"),
                ("id: 1, position: [0, 0, 0], yaw: 0, orientation: [0, 0, 0, 1]",
                 "markers[0].yaw", "both"),
                ("id: 1, position: [0, 0, 0], roll: 0, orientation: [0, 0, 0, 1]",
                 "markers[0].roll", "both"),
                ("id: 1, position: [0, 0, 0], orientation: [0, 0, 0, 2]", "length 2"),
                ("id: 1, position: [0, 0, 0], orientation: [0, 0, 1]", "4 numbers", "3 values"),
                ("id: 1, position: [0, 0], yaw: 0", "markers[0].position", "3 numbers"),
                ("id: 1, position: [0, .nan, 0], yaw: 0", "markers[0].position[1]", "'.nan'"),
                ("id: 1, position: [0, nan, 0], yaw: 0", "markers[0].position[1]", "'nan'"),
                ("id: 1, position: [0, 0, 0], yaw: .inf", "markers[0].yaw", "'.inf'"),
                ("id: 1, position: [0, 0, 0], yaw: east", "markers[0].yaw", "'east'"),
                ("id: 1, position: [0, 0, 0], yaw: ", "markers[0].yaw", "nothing"),
                ("id: 1, position: here, yaw: 0", "a list", "'here'"),
                ("id: 1.0, position: [0, 0, 0], yaw: 0", "markers[0].id", "an integer", "'1.0'"),
                ("id: 010, position: [0, 0, 0], yaw: 0", "markers[0].id", "an integer", "'010'"),
                ("id: 1, position: [010, 0, 0], yaw: 0", "markers[0].position[0]", "'010'"),
                ("id: 1, position: [1_0, 0, 0], yaw: 0", "markers[0].position[0]", "'1_0'"),
                ("id: -1, position: [0, 0, 0], yaw: 0", "markers[0].id", "0 to 586", "'-1'"),
                ("id: 587, position: [0, 0, 0], yaw: 0", "markers[0].id", "0 to 586", "'587'"),
                ("id: 1, size: -0.1, position: [0, 0, 0], yaw: 0", "markers[0].size", "positive"),
                ("id: 1, size: 0, position: [0, 0, 0], yaw: 0", "markers[0].size", "positive"),
                ("id: 1, family: tag36h12, position: [0, 0, 0], yaw: 0", "markers[0].family",
                 "tag36h11", "'tag36h12'"),
                ("id: 1, pitch: 0, position: [0, 0, 0], yaw: 0", "markers[0].pitch", "unknown"),
                ("id: 1, id: 2, position: [0, 0, 0], yaw: 0", "markers[0].id", "once"),
                ("id: 1, name: [a], position: [0, 0, 0], yaw: 0", "markers[0].name", "a list")):
            with self.subTest(entry), self.assert_error("map.yaml:5: ", *parts):
                self.marker(entry)

    def test_a_name_given_twice(self):
        with self.assert_error("map.yaml:7: ", "markers[2].name", "'door'", "markers[0]"):
            self.load(HEAD + "  - {id: 1, name: door, position: [0, 0, 0], yaw: 0}\n"
                      "  - {id: 1, position: [0, 0, 0], yaw: 0}\n"
                      "  - {id: 2, name: door, position: [0, 0, 0], yaw: 0}\n")

    def test_bad_files_are_named(self):
        entry = "  - {id: 1, position: [0, 0, 0], yaw: 0}\n"
        for text, *parts in (
                ("", "empty file"),
                ("[1, 2]\n", "map.yaml:1: ", "mapping", "a list"),
                ("frame_id: map\n  family: [\n", "map.yaml:2: ", "YAML"),
                (HEAD + "  []\n", "map.yaml:5: ", "at least one marker"),
                (HEAD, "map.yaml:4: ", "a list of markers", "nothing"),
                (HEAD.replace("frame_id: map", "frame_id:") + entry, "map.yaml:1: ", "frame_id"),
                (HEAD.replace("size: 0.30\n", "") + entry, "map.yaml:4: ", "'size'"),
                (HEAD.replace("family: tag36h11\n", "") + entry, "map.yaml:4: ", "'family'"),
                ("unit: m\n" + HEAD + entry, "map.yaml:1: ", "unit", "unknown"),
                ("size: 1\n" + HEAD + entry, "map.yaml:4: ", "size", "once")):
            with self.subTest(text), self.assert_error("map.yaml:", *parts):
                self.load(text)
        with self.assert_error("none.yaml", "No such file"):
            load_marker_map(self.path("none.yaml"))


if __name__ == "__main__":
    unittest.main()
