"""build_map: maps of the shipped bag, and what it says where it cannot make one."""

import os
import re
import subprocess
import sys
import tempfile
import unittest

import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from harness import BAG, PACKAGE  # noqa: E402
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
    """rad, of a rotation matrix."""
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
        # Whatever the frame, markers are as far from each other.
        for a in built.values():
            for b in built.values():
                distance = np.linalg.norm(a.position - b.position)
                true_distance = np.linalg.norm(truth[a.id].position - truth[b.id].position)
                self.assertLess(abs(distance - true_distance), 2.0 * POSITION_TOLERANCE)
        first = min(built.values(), key=lambda m: np.hypot(*m.position[:2]))
        self.assertLess(np.hypot(*first.position[:2]), 1e-6)
        self.assertAlmostEqual(first.normal[1], 0.0, places=5)

    def test_writes_nothing_where_it_cannot(self):
        cases = [
            ({"map": MAP}, "nothing to add"),
            ({}, "--size"),
            ({"size": "0.75", "family": "tagStandard41h12"}, "no marker was read"),
            ({"size": "0.75", "family": "tag99"}, "tag99"),
            ({"size": "-1"}, "--size"),
            ({"size": "0.75", "bag": "/no/such.bag"}, "/no/such.bag"),
            ({"size": "0.75", "output": BAG}, "--output"),
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
