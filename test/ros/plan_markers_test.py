"""plan_markers: what it writes, and what it says about bad input."""

import csv
import os
import subprocess
import sys
import tempfile
import unittest

import cv2
import numpy as np
import yaml

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from harness import PACKAGE  # noqa: E402

CAMERA = os.path.join(PACKAGE, "config", "cameras", "paper.yaml")
MAP = os.path.join(PACKAGE, "maps", "rooms.yaml")
FLOOR = os.path.join(PACKAGE, "worlds", "rooms_floor.yaml")
MOUNTING = "0.10,0.02,1.10,0.965925826,0.258819045,0,0"


class PlanMarkersTest(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.directory = directory.name
        self.output = os.path.join(directory.name, "plan")

    def run_tool(self, *arguments, **changed):
        options = {"camera": CAMERA, "map": MAP, "floor": FLOOR, "mounting": MOUNTING,
                   "output": self.output, "step": "0.6", "headings": "2"}
        options.update(changed)
        given = [text for key, value in options.items() for text in ("--" + key, value)]
        return subprocess.run(["rosrun", "omnitag", "plan_markers", *given, *arguments],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              universal_newlines=True, check=False)

    def plan(self, *arguments, **changed):
        result = self.run_tool(*arguments, **changed)
        self.assertEqual(result.returncode, 0, result.stderr)
        return result.stdout

    def file(self, name):
        return os.path.join(self.output, name)

    def write(self, name, text):
        path = os.path.join(self.directory, name)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return path

    def rows(self, name):
        with open(self.file(name), encoding="utf-8", newline="") as file:
            return list(csv.DictReader(file))

    def assert_refused(self, part, *arguments, **changed):
        result = self.run_tool(*arguments, **changed)
        self.assertEqual(result.returncode, 1)
        self.assertEqual(result.stdout, "")
        self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
        self.assertIn(part, result.stderr)
        self.assertFalse(os.path.exists(self.output))

    def test_a_table_and_a_picture(self):
        said = self.plan()
        self.assertIn("floor with three markers or more", said)
        self.assertEqual(sorted(os.listdir(self.output)), ["plan.csv", "plan.png"])
        self.assertGreater(cv2.imread(self.file("plan.png")).shape[0], 400)
        rows = self.rows("plan.csv")
        self.assertEqual(list(rows[0]), ["x", "y", "markers", "position_deviation",
                                         "heading_deviation"])
        self.assertGreater(len(rows), 100)
        for row in rows:
            self.assertEqual(row["position_deviation"] == "", row["markers"] == "0")
            x, y = float(row["x"]), float(row["y"])
            self.assertFalse(x < 0.0 and y > 2.5, "the robot does not get there")

    def test_new_markers(self):
        said = self.plan("--count", "2", "--size", "0.25", "--height", "1.4")
        self.assertIn("with 2 more", said)
        with open(self.file("planned.yaml"), encoding="utf-8") as file:
            planned = yaml.safe_load(file)["markers"]
        with open(MAP, encoding="utf-8") as file:
            before = yaml.safe_load(file)["markers"]
        self.assertEqual(planned[:-2], before)
        for marker in planned[-2:]:
            self.assertNotIn(marker["id"], [other["id"] for other in before])
            self.assertEqual((marker["size"], marker["position"][2]), (0.25, 1.4))
            self.assertEqual((marker["deviation"], marker["orientation_deviation"]),
                             (0.005, 0.0175))
        printed = os.path.join(self.directory, "markers.pdf")
        subprocess.run(["rosrun", "omnitag", "print_markers", "--map", self.file("planned.yaml"),
                        "--output", printed, "--paper", "a2"], check=True,
                       stdout=subprocess.DEVNULL)
        self.assertTrue(os.path.exists(printed))

    def test_families(self):
        said = self.plan("--compare", "--size", "0.2")
        self.assertIn("tag36h11", said)
        families = {row["family"]: row for row in self.rows("compare.csv")}
        self.assertIn("DICT_4X4_50", families)
        for row in families.values():
            self.assertGreater(float(row["recognized_distance"]), float(row["read_distance"]))
        # Fewer modules, which are wider.
        self.assertGreater(float(families["tag16h5"]["read_distance"]),
                           float(families["tag36h11"]["read_distance"]))

    def test_both_ways_to_give_a_mounting(self):
        self.plan()
        quaternion = self.rows("plan.csv")
        # Half a turn about x, then 30 degrees about z.
        self.plan(mounting="0.10,0.02,1.10,3.14159265,0,0.523598776")
        for one, other in zip(quaternion, self.rows("plan.csv")):
            self.assertEqual(one["markers"], other["markers"])

    def test_bad_input(self):
        self.assert_refused("none.yaml", camera="none.yaml")
        self.assert_refused("none.yaml", map="none.yaml")
        self.assert_refused("none.yaml", floor="none.yaml")
        self.assert_refused("--mounting: expected", mounting="1,2,3")
        self.assert_refused("--mounting: expected", mounting="0,0,1,1,1,0,0")
        self.assert_refused("--count: expected a number from 1", "--count", "0")
        self.assert_refused("--size: expected a number from", "--size", "-1")
        self.assert_refused("--family: expected", "--family", "tag99", "--count", "1")
        self.assert_refused("--over-headings: expected worst or mean, found 'best'",
                            "--over-headings", "best")
        self.assert_refused("tag16h5 has 30 ids", "--family", "tag16h5", "--count", "31")
        self.assert_refused("--output: expected a directory", output=MAP)

    def test_a_bad_floor(self):
        grid = ("image: {}\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\n"
                "occupied_thresh: 0.65\nfree_thresh: 0.196\n")
        path = self.write("floor.yaml", grid.format("missing.png"))
        self.assert_refused("image: expected a PGM or PNG image", floor=path)
        path = self.write("floor.yaml", grid.format("floor.yaml"))
        self.assert_refused("image: expected a PGM or PNG image", floor=path)
        cv2.imwrite(os.path.join(self.directory, "full.png"), np.zeros((9, 9), np.uint8))
        path = self.write("floor.yaml", grid.format("full.png"))
        self.assert_refused("expected a free cell with a clearance", floor=path)
        path = self.write("floor.yaml", "image: full.png\n")
        self.assert_refused("floor.yaml:1: resolution: expected", floor=path)


if __name__ == "__main__":
    unittest.main()
