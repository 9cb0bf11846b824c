import json
import math
import unittest

from source_tree import FileTest

import numpy as np
from omnitag.marker_map import load_marker_map, rotation_from_yaw_and_roll
from omnitag.rotation import (quaternion_from_rotation, rotation_from_quaternion,
                              rotation_from_rpy, rotation_from_vector, rpy_from_rotation,
                              vector_from_rotation)

# A tag that hangs on a wall, upright, and faces along x: its viewer's right is y.
FACING_X = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])

# Everything that a map may have, each orientation another.
OWN = """\
frame_id: map
family: tag36h11
size: 0.2
markers:
  - {id: 3, position: [1.0, -2.5, 0.8], yaw: -1.25, roll: 0.4}
  - {id: 7, position: [4.0, 0.25, 1.1], yaw: 3.1416, deviation: 0.003}
  - {id: 20, position: [0.5, 0.5, 2.7], orientation: [1, 0, 0, 0], orientation_deviation: 0.05}
  - {id: 21, position: [-0.125, 3.5, 0.0], orientation: [0.5, -0.1, 0.7, 0.5]}
"""


class RotationTest(unittest.TestCase):
    def test_all_ways_lead_back(self):
        generator = np.random.default_rng(3)
        vectors = list(generator.uniform(-1.8, 1.8, (50, 3)))
        vectors += [(math.pi, 0, 0), (0, 0, -math.pi), (0, 0, 0), (0, math.pi / 2, 0),
                    (0, -math.pi / 2, 0), (1e-9, 0, 0)]
        for vector in vectors:
            rotation = rotation_from_vector(vector)
            np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-12)
            for again in (rotation_from_vector(vector_from_rotation(rotation)),
                          rotation_from_rpy(*rpy_from_rotation(rotation)),
                          rotation_from_quaternion(quaternion_from_rotation(rotation))):
                np.testing.assert_allclose(again, rotation, atol=1e-9)

    def test_quarter_turns(self):
        np.testing.assert_allclose(rotation_from_vector((0, 0, math.pi / 2)),
                                   [[0, -1, 0], [1, 0, 0], [0, 0, 1]], atol=1e-12)
        # First about x: y goes to z; then about z: x goes to y.
        np.testing.assert_allclose(rotation_from_rpy(math.pi / 2, 0, math.pi / 2),
                                   [[0, 0, 1], [1, 0, 0], [0, 1, 0]], atol=1e-12)


class ConvertMapTest(FileTest):
    def convert(self, name, text, *arguments):
        result = self.run_tool("convert_map", self.write(name, text), self.path("out"), *arguments)
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(self.path("out"), encoding="utf-8") as file:
            return file.read(), result.stdout

    def converted(self, name, text, *arguments):
        self.convert(name, text, *arguments)
        return load_marker_map(self.path("out")).markers

    def test_wpilib(self):
        # Of 2024-crescendo.json: tag 7 hangs at the speaker of the blue side and looks along x, tag
        # 3 at the red side and looks back; tag 9 looks to 60 degrees.
        layout = {"tags": [
            {"ID": 7, "pose": {"translation": {"x": -0.0381, "y": 5.547868, "z": 1.451102},
                               "rotation": {"quaternion": {"W": 1.0, "X": 0.0, "Y": 0.0,
                                                           "Z": 0.0}}}},
            {"ID": 3, "pose": {"translation": {"x": 16.579342, "y": 4.982718, "z": 1.451102},
                               "rotation": {"quaternion": {"W": 6.123233995736766e-17, "X": 0.0,
                                                           "Y": 0.0, "Z": 1.0}}}},
            {"ID": 9, "pose": {"translation": {"x": 0.356108, "y": 0.883666, "z": 1.355852},
                               "rotation": {"quaternion": {"W": 0.8660254037844387, "X": 0.0,
                                                           "Y": 0.0, "Z": 0.49999999999999994}}}}],
            "field": {"length": 16.451, "width": 8.211}}
        markers = self.converted("field.json", json.dumps(layout, indent=2))
        self.assertEqual([marker.id for marker in markers], [7, 3, 9])
        self.assertEqual({(marker.family, marker.size) for marker in markers},
                         {("tag36h11", 0.1651)})
        np.testing.assert_allclose(markers[0].position, [-0.0381, 5.547868, 1.451102], atol=1e-6)
        np.testing.assert_allclose(markers[0].map_from_marker[:3, :3], FACING_X, atol=1e-9)
        np.testing.assert_allclose(markers[1].normal, [-1, 0, 0], atol=1e-9)
        np.testing.assert_allclose(markers[2].map_from_marker[:3, :3],
                                   rotation_from_yaw_and_roll(math.radians(60)), atol=1e-9)
        # Who looks at a tag sees its upper right corner to the right, and above.
        np.testing.assert_allclose(markers[0].corners[2] - markers[0].position,
                                   [0, 0.08255, 0.08255], atol=1e-6)
        text, said = self.convert("field.json", json.dumps(layout), "--size", "0.15",
                                  "--family", "tag16h5")
        self.assertIn("family: tag16h5\nsize: 0.15\n", text)
        self.assertNotIn("taken as", said)

    def test_tagslam(self):
        # A body that is turned to the left and moved, with the tag of the documentation's drawing
        # on it: x right, y up, z toward who looks at it. A third of a turn about (1, 1, 1) takes
        # x to y, y to z and z to x.
        third = 2.0 * math.pi / 3.0 / math.sqrt(3.0)
        pose = ("{indent}position: {{x: {p[0]}, y: {p[1]}, z: {p[2]}}}\n"
                "{indent}rotation: {{x: {r[0]}, y: {r[1]}, z: {r[2]}}}\n")
        text = ("tagslam_parameters:\n  optimizer_mode: fast\ndefault_body: lab\nbodies:\n"
                " - lab:\n     is_static: true\n     type: simple\n     default_tag_size: 0.125\n"
                "     pose:\n"
                + pose.format(indent="       ", p=(10, 0, 0), r=(0, 0, math.pi / 2)) +
                "     tags:\n       - id: 44\n         size: 0.15\n         pose:\n"
                + pose.format(indent="           ", p=(4, 0, 1), r=(third, third, third)) +
                "           position_noise: {x: 0.003, y: 0.003, z: 0.003}\n"
                "           rotation_noise: {x: 0.02, y: 0.02, z: 0.02}\n"
                "       - id: 45\n"
                "       - id: 46\n         pose:\n"
                + pose.format(indent="           ", p=(0, 0, 0), r=(0, 0, 0)) +
                " - rig:\n     is_static: false\n     type: simple\n     tags:\n"
                "       - id: 9\n         pose:\n"
                + pose.format(indent="           ", p=(0, 0, 0), r=(0, 0, 0)))
        markers = self.converted("tagslam.yaml", text)
        self.assertEqual([(marker.id, marker.size) for marker in markers],
                         [(44, 0.15), (46, 0.125)])
        np.testing.assert_allclose(markers[0].position, [10, 4, 1], atol=1e-6)
        # It faced along the body's x, which is the map's y.
        np.testing.assert_allclose(markers[0].normal, [0, 1, 0], atol=1e-9)
        np.testing.assert_allclose(markers[0].map_from_marker[:3, 1], [0, 0, 1], atol=1e-9)
        self.assertAlmostEqual(markers[0].deviation, 0.003)
        self.assertAlmostEqual(markers[0].orientation_deviation, 0.02)
        self.assertIsNone(markers[1].deviation)
        _, said = self.convert("tagslam.yaml", text)
        self.assertIn("tag 45, which has no pose", said)
        self.assertIn("tags of 'rig', which moves", said)

    def test_fiducial_slam(self):
        # The marker that init_map.py begins a map with, under the ceiling, face down; one upright
        # on a wall that faces along x.
        text = ("112 0.0 0.0 2.5 180.0 0 180.0 0 1\n"
                "7 4 0.5 1.0 90 0 90 0.0004 30 112 9\n")
        markers = self.converted("map.txt", text, "--family", "tag36h11", "--size", "0.14")
        self.assertEqual([(marker.id, marker.size) for marker in markers], [(112, 0.14), (7, 0.14)])
        np.testing.assert_allclose(markers[0].normal, [0, 0, -1], atol=1e-9)
        np.testing.assert_allclose(markers[0].map_from_marker[:3, 0], [-1, 0, 0], atol=1e-9)
        np.testing.assert_allclose(markers[1].map_from_marker[:3, :3], FACING_X, atol=1e-9)
        np.testing.assert_allclose(markers[1].position, [4, 0.5, 1.0], atol=1e-6)
        self.assertAlmostEqual(markers[1].deviation, 0.02)
        written, _ = self.convert("map.txt", text, "--family", "DICT_5X5_1000", "--size", "0.14")
        self.assertIn("family: DICT_5X5_1000\n", written)

    def test_apriltag_ros(self):
        text = ("standalone_tags:\n  [\n    {id: 10, size: 0.05, name: dock},\n  ]\n"
                "tag_bundles:\n  [\n    {\n      name: 'wall',\n      layout:\n        [\n"
                "          {id: 0, size: 1},\n"
                "          {id: 5, size: 0.15, x: 4, y: 0.5, z: 1.0, qw: 0.5, qx: 0.5, qy: 0.5, "
                "qz: 0.5},\n        ]\n    },\n"
                "    {name: other, layout: [{id: 1, size: 0.1}]}\n  ]\n")
        self.assert_refused(
            self.run_tool("convert_map", self.write("tags.yaml", text), self.path("out")),
            "tags.yaml:6: tag_bundles: expected one of its bundles", "#wall", "wall, other")
        path = self.write("tags.yaml", text)
        result = self.run_tool("convert_map", path + "#wall", self.path("out"))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("left out: 1 standalone tags", result.stdout)
        markers = load_marker_map(self.path("out")).markers
        self.assertEqual([(marker.id, marker.size) for marker in markers], [(0, 1.0), (5, 0.15)])
        np.testing.assert_allclose(markers[0].map_from_marker, np.eye(4), atol=1e-9)
        np.testing.assert_allclose(markers[1].map_from_marker[:3, :3], FACING_X, atol=1e-9)
        np.testing.assert_allclose(markers[1].position, [4, 0.5, 1.0], atol=1e-6)

    def test_what_others_read(self):
        # Facing along x, upright, in the words of each.
        own = ("frame_id: map\nfamily: tag36h11\nsize: 0.15\nmarkers:\n"
               "  - {id: 5, position: [4, 0.5, 1], yaw: 0, deviation: 0.02}\n")
        layout = json.loads(self.convert("map.yaml", own, "--to", "wpilib")[0])
        self.assertEqual(layout["tags"], [
            {"ID": 5, "pose": {"translation": {"x": 4.0, "y": 0.5, "z": 1.0},
                               "rotation": {"quaternion": {"W": 1.0, "X": 0.0, "Y": 0.0,
                                                           "Z": 0.0}}}}])
        self.assertEqual(layout["field"], {"length": 4.0, "width": 0.5})
        line, = self.convert("map.yaml", own, "--to", "fiducial_slam")[0].splitlines()
        np.testing.assert_allclose([float(word) for word in line.split()],
                                   [5, 4, 0.5, 1, 90, 0, 90, 0.0004, 1], atol=1e-8)
        self.assertIn("{id: 5, size: 0.150000000, x: 4.000000000, y: 0.500000000, z: 1.000000000, "
                      "qw: 0.500000000, qx: 0.500000000, qy: 0.500000000, qz: 0.500000000}",
                      self.convert("map.yaml", own, "--to", "apriltag_ros")[0])
        third = "{:.9f}".format(2.0 * math.pi / 3.0 / math.sqrt(3.0))
        self.assertIn("rotation:\n           x: {0}\n           y: {0}\n           z: {0}\n".format(
            third), self.convert("map.yaml", own, "--to", "tagslam")[0])

    def test_all_lead_back(self):
        original = load_marker_map(self.write("map.yaml", OWN)).markers
        for name, arguments in (("wpilib", ("--size", "0.2")), ("tagslam", ()),
                                ("fiducial_slam", ("--size", "0.2", "--family", "tag36h11")),
                                ("apriltag_ros", ())):
            with self.subTest(name):
                text, _ = self.convert("map.yaml", OWN, "--to", name)
                again = self.converted("foreign", text, *arguments)
                self.assertEqual([(marker.id, marker.family, marker.size) for marker in again],
                                 [(marker.id, marker.family, marker.size) for marker in original])
                for marker, expected in zip(again, original):
                    np.testing.assert_allclose(marker.map_from_marker, expected.map_from_marker,
                                               atol=2e-6)
                if name == "tagslam":
                    self.assertAlmostEqual(again[1].deviation, 0.003)
                    self.assertAlmostEqual(again[2].orientation_deviation, 0.05)

    def test_bad_input(self):
        def refused(name, text, *parts, arguments=()):
            self.assert_refused(self.run_tool("convert_map", self.write(name, text),
                                              self.path("none"), *arguments), *parts)
            with self.assertRaises(FileNotFoundError):
                open(self.path("none"), "rb")

        refused("map.yaml", OWN, "--to: expected one of wpilib, tagslam")
        refused("map.yaml", OWN, "--size: expected none",
                arguments=("--size", "1", "--to", "tagslam"))
        refused("map.yaml", OWN.replace("id: 7", "id: 3"), "map.yaml: expected each id once",
                "tagslam", "3 twice", arguments=("--to", "tagslam"))
        refused("map.yaml", OWN.replace("id: 7", "id: 7, size: 0.3"),
                "expected markers of one size", "0.2, 0.3", arguments=("--to", "wpilib"))
        refused("map.yaml", OWN.replace("id: 7", "id: 7, family: tag16h5"),
                "expected markers of one family", arguments=("--to", "apriltag_ros"))
        refused("x.yaml", "eyes: 2\n", "x.yaml:1", "'tag_bundles' (apriltag_ros)")
        refused("map.txt", "1 0 0 0 0 0 0 0 1\n", "map.txt: --family: expected")
        refused("map.txt", "1 0 0 0 0 0 0 0 1\n2 0 0 0\n", "map.txt:2: expected id, x, y, z",
                "found '2 0 0 0'", arguments=("--size", "1", "--family", "tag36h11"))
        refused("map.txt", "999 0 0 0 0 0 0 0 1\n", "map.txt:1: expected an id of tag36h11, 0 to",
                arguments=("--size", "1", "--family", "tag36h11"))
        refused("map.txt", "1 0 0 0 0 0 0 0 1\n", "--family: expected one of", "found 'aruco'",
                arguments=("--size", "1", "--family", "aruco"))
        refused("field.json", '{"tags": [\n{"ID": 1, "pose": {"translation": {"x": 1, "y": 2, '
                '"z": 3},\n"rotation": {"quaternion": {"W": 1, "X": 1, "Y": 0, "Z": 0}}}}]}',
                "field.json:3: tags[0].pose.rotation.quaternion: expected a quaternion of length 1")
        refused("field.json", '{"tags": [{"ID": 1}]}', "field.json:1: tags[0]", "'pose'")
        refused("tagslam.yaml", "bodies:\n - lab:\n     is_static: true\n     tags:\n"
                "       - {id: 1, size: 1}\n", "tagslam.yaml:3: bodies[0].lab", "'pose'")
        refused("tags.yaml", "standalone_tags: [{id: 1, size: 1}]\n", "tags.yaml:1",
                "'tag_bundles'")
        path = self.write("map.yaml", OWN)
        self.assert_refused(self.run_tool("convert_map", path, path, "--to", "tagslam"),
                            "is the input")
        self.assertEqual(self.run_tool("convert_map", path).returncode, 2)


if __name__ == "__main__":
    unittest.main()
