"""build_map: maps of the shipped bag, and what it says if it cannot make one."""

import os
import re
import subprocess
import sys
import tempfile
import unittest

import numpy as np
import rosbag
import yaml
from tf2_msgs.msg import TFMessage

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from harness import BAG, PACKAGE, odometry, read_truth  # noqa: E402
from omnitag.marker_map import load_marker_map  # noqa: E402

CAMERA = os.path.join(PACKAGE, "config", "cameras", "paper.yaml")
MAP = os.path.join(PACKAGE, "maps", "paper.yaml")
SEED_IDS = (1, 4, 8, 10)
POSITION_TOLERANCE = 0.003  # m
ANGLE_TOLERANCE = np.radians(0.3)


def seed_text():
    """The shipped map with four of its markers, one of its comments at the end."""
    with open(MAP, encoding="utf-8") as file:
        lines = file.readlines()
    seeds = tuple("  - {{id: {},".format(marker_id) for marker_id in SEED_IDS)
    return "".join(line for line in lines
                   if not line.startswith("  - ") or line.startswith(seeds)) + "# the end\n"


def angle_of(rotation):
    """rad: angle of a rotation matrix."""
    return np.arccos(np.clip(0.5 * (np.trace(rotation) - 1.0), -1.0, 1.0))


class BuildMapTest(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.directory = directory.name

    def path(self, name):
        return os.path.join(self.directory, name)

    def run_tool(self, *arguments, **options):
        """Runs with the shipped files; an option that is None is left out."""
        values = {"camera": CAMERA, "bag": BAG, "output": self.path("map.yaml")}
        values.update(options)
        command = ["rosrun", "omnitag", "build_map", *arguments]
        for name, value in values.items():
            if value is not None:
                command += ["--" + name.replace("_", "-"), value]
        return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              universal_newlines=True, check=False)

    def seed(self):
        """The path of a map of four markers."""
        with open(self.path("seed.yaml"), "w", encoding="utf-8") as file:
            file.write(seed_text())
        return self.path("seed.yaml")

    def test_from_a_seed(self):
        result = self.run_tool(map=self.seed())
        self.assertEqual(result.returncode, 0, result.stderr)
        truth = {marker.id: marker for marker in load_marker_map(MAP).markers}
        built = load_marker_map(self.path("map.yaml")).markers
        self.assertEqual({marker.id for marker in built}, set(truth))
        for marker in built:
            true_marker = truth[marker.id]
            self.assertLess(np.linalg.norm(marker.position - true_marker.position),
                            POSITION_TOLERANCE, marker.id)
            turn = marker.map_from_marker[:3, :3].T @ true_marker.map_from_marker[:3, :3]
            self.assertLess(angle_of(turn), ANGLE_TOLERANCE, marker.id)
        # The seed's text is there as it was.
        with open(self.path("map.yaml"), encoding="utf-8") as file:
            lines = file.read().splitlines(True)
        self.assertEqual("".join(line for line in lines if "mapped:" not in line), seed_text())
        self.assertTrue(os.path.getsize(self.path("map.png")) > 10000)
        self.assertIn("worst residuals", result.stdout)
        for marker in built:
            if marker.id not in SEED_IDS:
                self.assertTrue(re.search(r"(?m)^ +{} .*\d\.\d".format(marker.id), result.stdout))

    def test_from_none(self):
        result = self.run_tool(size="0.75", trajectory=self.path("way.tum"))
        self.assertEqual(result.returncode, 0, result.stderr)
        truth = {marker.id: marker for marker in load_marker_map(MAP).markers}
        built = {marker.id: marker for marker in load_marker_map(self.path("map.yaml")).markers}
        self.assertEqual(set(built), set(truth))
        # In any frame, markers are equally far from each other.
        for a in built.values():
            for b in built.values():
                distance = np.linalg.norm(a.position - b.position)
                true_distance = np.linalg.norm(truth[a.id].position - truth[b.id].position)
                self.assertLess(abs(distance - true_distance), 2.0 * POSITION_TOLERANCE)
        first = min(built.values(), key=lambda m: np.hypot(*m.position[:2]))
        self.assertLess(np.hypot(*first.position[:2]), 1e-6)
        self.assertAlmostEqual(first.normal[1], 0.0, places=5)

    def test_into_another_localizers_frame(self):
        # As amcl would localize: to 3 cm, in another frame.
        turn, shift = 0.7, np.array([5.0, -3.0])
        rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
        random = np.random.default_rng(1)
        bag = self.path("localized.bag")
        with rosbag.Bag(bag, "w") as out:
            for topic, message, time in rosbag.Bag(BAG).read_messages():
                out.write(topic, message, time)
            for stamp, (x, y, yaw) in read_truth().items():
                place = rotation @ (x, y) + shift + random.normal(0.0, 0.03, 2)
                transform = odometry(stamp, (0.0, 0.0, 0.0))
                transform.header.frame_id = "building"
                transform.transform.translation.x = place[0]
                transform.transform.translation.y = place[1]
                transform.transform.rotation.z = np.sin(0.5 * (yaw + turn))
                transform.transform.rotation.w = np.cos(0.5 * (yaw + turn))
                out.write("/tf", TFMessage([transform]), stamp)
        result = self.run_tool("--max-images", "30", size="0.75", bag=bag, align_to="building")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertRegex(result.stdout, r"put into 'building' by \d+ of 30 poses")
        with open(self.path("map.yaml"), encoding="utf-8") as file:
            self.assertIn("frame_id: building\n", file.read())
        truth = {marker.id: marker for marker in load_marker_map(MAP).markers}
        for marker in load_marker_map(self.path("map.yaml")).markers:
            place = rotation @ truth[marker.id].position[:2] + shift
            self.assertLess(np.linalg.norm(marker.position[:2] - place), 0.04, marker.id)

        # By hand: two markers.
        points = []
        for marker_id in (5, 10):
            x, y = truth[marker_id].position[:2]
            points += ["--align-point", "{}:{},{}".format(marker_id, x, y)]
        result = self.run_tool("--max-images", "30", *points, size="0.75")
        self.assertEqual(result.returncode, 0, result.stderr)
        for marker in load_marker_map(self.path("map.yaml")).markers:
            self.assertLess(np.linalg.norm(marker.position - truth[marker.id].position),
                            2.0 * POSITION_TOLERANCE, marker.id)

    def test_finds_the_camera_too(self):
        with open(CAMERA, encoding="utf-8") as file:
            guess = file.read().replace("fx: 1195.0, fy: 1195.0, cx: 249.5, cy: 249.5",
                                        "fx: 1225.0, fy: 1225.0, cx: 253.5, cy: 246.0")
        self.assertIn("253.5", guess)
        with open(self.path("guess.yaml"), "w", encoding="utf-8") as file:
            file.write(guess)
        result = self.run_tool("--max-images", "40", map=self.seed(), camera=self.path("guess.yaml"),
                               output_camera=self.path("found.yaml"))
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(self.path("found.yaml"), encoding="utf-8") as file:
            lens = yaml.safe_load(file.read())["lens"]
        self.assertAlmostEqual(lens["cx"], 249.5, delta=0.1)
        self.assertAlmostEqual(lens["cy"], 249.5, delta=0.1)
        truth = {marker.id: marker for marker in load_marker_map(MAP).markers}
        built = load_marker_map(self.path("map.yaml")).markers
        self.assertGreater(len(built), len(SEED_IDS) + 5)
        for marker in built:
            self.assertLess(np.linalg.norm(marker.position - truth[marker.id].position), 0.01,
                            marker.id)

    def test_writes_nothing_where_it_cannot(self):
        cases = [
            ({"map": MAP}, "nothing to add"),
            ({}, "--size"),
            ({"size": "0.75", "family": "tagStandard41h12"}, "no marker was read"),
            ({"size": "0.75", "family": "tag99"}, "tag99"),
            ({"size": "-1"}, "--size"),
            ({"size": "0.75", "bag": "/no/such.bag"}, "/no/such.bag"),
            ({"size": "0.75", "output": BAG}, "--output"),
            ({"size": "0.75", "align_to": "nowhere", "bag": BAG}, "nowhere"),
            ({"size": "0.75", "align_point": "5:1.0"}, "--align-point"),
            ({"size": "0.75", "camera": None, "output_camera": "c.yaml"}, "--output-camera"),
        ]
        for options, line in cases:
            result = self.run_tool(**options)
            self.assertEqual(result.returncode, 1, options)
            last = result.stderr.splitlines()[-1]
            self.assertTrue(last.startswith("build_map: "), last)
            self.assertIn(line, last)
            self.assertEqual(os.listdir(self.directory), [], options)


if __name__ == "__main__":
    unittest.main()
