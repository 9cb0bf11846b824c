import json
import math
import os
import unittest

from source_tree import FileTest

import numpy as np
from omnitag.detections import COLUMNS, read_detections
from omnitag.evaluation import evaluate, match_stamps, mean_range
from omnitag.marker_map import load_marker_map
from omnitag.trajectory import Trajectory, planar_trajectory, write_trajectory

MAP = """\
frame_id: map
family: tag36h11
size: 0.3
markers:
  - {id: 3, position: [4, 0, 1], yaw: 3.14159}
  - {id: 7, name: door, position: [0, 3, 1], yaw: -1.5708}
"""
HEADER = ",".join(COLUMNS) + "\n"
DETECTIONS = (HEADER
              + "1.000000000,3,tag36h11,,0,1,,0.01,4.0,0.1,1,2,3,2,3,1,1,1\n"
              "1.000000000,7,tag36h11,door,1,1,,1.57,3.0,0.2,1,2,3,2,3,1,1,1\n"
              "2.000000000,3,tag36h11,,0,1,,0.02,2.0,0.3,1,2,3,2,3,1,1,1\n"
              "2.000000000,9,tag36h11,,-1,0,not in the map,,,,,,,,,,,\n")


def seconds(*values):
    return np.array([round(1e9 * value) for value in values], dtype=np.int64)


def trajectory(*poses):
    stamps, x, y, yaw = np.array(poses, dtype=float).T
    return planar_trajectory(seconds(*stamps), x, y, yaw)


class MatchingTest(unittest.TestCase):
    def match(self, first, second, tolerance):
        first, second = match_stamps(np.array(first), np.array(second), tolerance)
        return list(zip(first.tolist(), second.tolist()))

    def test_nearest_within_the_tolerance(self):
        self.assertEqual(self.match([10, 20, 30], [9, 12, 25, 31], 4), [(0, 0), (2, 3)])
        self.assertEqual(self.match([10, 20, 30], [9, 12, 25, 31], 5), [(0, 0), (1, 2), (2, 3)])

    def test_each_is_used_once(self):
        self.assertEqual(self.match([10, 12], [11, 20], 3), [(0, 0)])
        self.assertEqual(self.match([10, 12], [12], 3), [(1, 0)])
        self.assertEqual(self.match([11], [10, 12], 3), [(0, 0)])

    def test_none(self):
        self.assertEqual(self.match([10], [20], 3), [])


class FiguresTest(FileTest):
    def test_position_errors_by_hand(self):
        reference = trajectory((1, 0, 0, 0), (2, 1, 0, 0), (3, 2, 0, 0), (4, 3, 0, 0))
        # Errors of 3-4-5, none, and 5-12-13 cm; nothing at 4 s; one estimate too many.
        estimate = trajectory((1, 0.03, 0.04, 0), (2.004, 1, 0, 0), (3, 2.05, -0.12, 0),
                              (3.5, 9, 9, 0))
        figures = evaluate(estimate, reference, 0.005).figures()
        self.assertAlmostEqual(figures["position_rmse"], math.sqrt((0.0025 + 0.0169) / 3))
        self.assertAlmostEqual(figures["position_mean"], 0.06)
        self.assertAlmostEqual(figures["position_median"], 0.05)
        self.assertAlmostEqual(figures["position_max"], 0.13)
        self.assertEqual(figures["reference_frames"], 4)
        self.assertEqual(figures["matched_frames"], 3)
        self.assertEqual(figures["matched_share"], 0.75)
        self.assertEqual(figures["unmatched_estimates"], 1)
        self.assertIsNone(figures["mean_range"])
        self.assertIsNone(figures["position_rmse_percent_of_range"])

    def test_a_common_offset_is_an_error(self):
        reference = trajectory((1, 0, 0, 0), (2, 1, 0, 0))
        estimate = trajectory((1, 0, 2, 0), (2, 1, 2, 0))
        self.assertAlmostEqual(evaluate(estimate, reference, 0.005).figures()["position_rmse"], 2.0)

    def test_heading_errors_wrap(self):
        reference = trajectory((1, 0, 0, math.radians(179)), (2, 0, 0, math.radians(-177)))
        estimate = trajectory((1, 0, 0, math.radians(-178)), (2, 0, 0, math.radians(179)))
        evaluation = evaluate(estimate, reference, 0.005)
        np.testing.assert_allclose(np.degrees(evaluation.heading_errors), [3, -4])
        self.assertAlmostEqual(evaluation.figures()["heading_rmse_deg"], math.sqrt(12.5))
        self.assertAlmostEqual(evaluation.figures()["heading_max_deg"], 4.0)

    def test_what_leaves_the_floor_is_compared_in_height_and_lean(self):
        # Rz(yaw) Ry(pitch) Rx(roll) by hand: about one axis at a time.
        def leaning(z, roll, pitch):
            half = 0.5 * np.radians([roll, pitch])
            lean = [math.sin(half[0]), math.sin(half[1]), 0.0]
            return [0.0, 0.0, z], lean + [math.cos(half[0]) * math.cos(half[1])]

        def track(*poses):
            positions, orientations = zip(*poses)
            return Trajectory(seconds(1, 2), np.array(positions), np.array(orientations))

        reference = track(leaning(1.0, 20, 0), leaning(1.0, 0, -10))
        figures = evaluate(track(leaning(1.03, 21, 0), leaning(0.96, 0, -12)), reference,
                           0.005).figures()
        self.assertAlmostEqual(figures["height_rmse"], math.sqrt((0.0009 + 0.0016) / 2))
        self.assertAlmostEqual(figures["height_max"], 0.04)
        self.assertAlmostEqual(figures["roll_rmse_deg"], math.sqrt(0.5))
        self.assertAlmostEqual(figures["roll_max_deg"], 1.0)
        self.assertAlmostEqual(figures["pitch_rmse_deg"], math.sqrt(2.0))
        self.assertAlmostEqual(figures["pitch_max_deg"], 2.0)
        on_floor = evaluate(trajectory((1, 0, 0, 0), (2, 0, 0, 0)), reference, 0.005).figures()
        self.assertIsNone(on_floor["height_rmse"])
        self.assertIsNone(on_floor["roll_max_deg"])

    def test_the_mean_range_is_over_the_markers_used(self):
        marker_map = load_marker_map(self.write("map.yaml", MAP))
        detections = read_detections(self.write("d.csv", DETECTIONS), marker_map)
        self.assertAlmostEqual(mean_range(detections), 3.0)
        reference = trajectory((1, 0, 0, 0), (2, 1, 0, 0))
        estimate = trajectory((1, 0.03, 0, 0), (2, 1, 0.03, 0))
        figures = evaluate(estimate, reference, 0.005, detections).figures()
        self.assertAlmostEqual(figures["position_rmse_percent_of_range"], 1.0)

    def test_no_marker_used_leaves_the_range_unknown(self):
        self.assertIsNone(mean_range([]))

    def test_trajectories_of_different_times(self):
        with self.assert_error("within 5 ms", "1.000000000 to 2.000000000", "found 7.000000000"):
            evaluate(trajectory((7, 0, 0, 0)), trajectory((1, 0, 0, 0), (2, 0, 0, 0)), 0.005)


class DetectionsTest(FileTest):
    def read(self, text):
        return read_detections(self.write("d.csv", text),
                               load_marker_map(self.write("map.yaml", MAP)))

    def test_fields(self):
        first, _, _, rejected = self.read(DETECTIONS)
        self.assertEqual((first.stamp, first.id, first.map_entry, first.accepted),
                         (1_000_000_000, 3, 0, True))
        self.assertEqual((first.bearing, first.range, first.residual), (0.01, 4.0, 0.1))
        self.assertEqual(first.corners.tolist(), [[1, 2], [3, 2], [3, 1], [1, 1]])
        self.assertEqual((rejected.accepted, rejected.reason), (False, "not in the map"))
        self.assertTrue(math.isnan(rejected.range))

    def test_bad_lines_are_named(self):
        good = "1,3,tag36h11,,0,1,,0.1,4.0,0.1,1,2,3,2,3,1,1,1"
        for line, *parts in (
                (good[:-2], "18 fields", "found 17"),
                (good.replace("1,3,", "soon,3,", 1), "stamp", "'soon'"),
                (good.replace(",3,tag", ",three,tag"), "id", "'three'"),
                (good.replace(",0,1,,", ",0,yes,,"), "accepted", "'yes'"),
                (good.replace(",4.0,", ",nan,"), "range", "'nan'"),
                (good.replace(",4.0,", ",-4.0,"), "range", "'-4.0'"),
                (good.replace(",4.0,", ",,"), "range", "''"),
                (good.replace(",0,1,,", ",2,1,,"), "map_entry", "0 to 1", "'2'"),
                (good.replace(",0,1,,", ",1,1,,"), "id", "tag36h11 7", "tag36h11 3")):
            with self.subTest(line), self.assert_error("d.csv:2: ", *parts):
                self.read(HEADER + line + "\n")

    def test_bad_headers_are_named(self):
        with self.assert_error("d.csv:1: ", "no column stamp"):
            self.read("")
        with self.assert_error("d.csv:1: ", "no column residual"):
            self.read(HEADER.replace("residual,", ""))


class ToolTest(FileTest):
    def setUp(self):
        super().setUp()
        self.reference = self.path("reference.tum")
        self.estimate = self.path("estimate.tum")
        write_trajectory(self.reference, trajectory((1, 0, 0, 0), (2, 1, 0, 0), (3, 2, 0, 0)))
        write_trajectory(self.estimate, trajectory((1, 0.03, 0, 0), (2, 1, 0.03, 0)))
        self.files = ("--estimate", self.estimate, "--reference", self.reference)
        self.markers = ("--map", self.write("map.yaml", MAP),
                        "--detections", self.write("d.csv", DETECTIONS))

    def evaluate(self, *arguments):
        return self.run_tool("evaluate_trajectory", *arguments)

    def test_json(self):
        result = self.evaluate(*self.files, *self.markers, "--json")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        figures = json.loads(result.stdout)
        self.assertAlmostEqual(figures["position_rmse"], 0.03)
        self.assertAlmostEqual(figures["mean_range"], 3.0)
        self.assertAlmostEqual(figures["position_rmse_percent_of_range"], 1.0)
        # The manual names every key.
        manual = self.evaluate("--help").stdout
        for key in figures:
            self.assertIn(key, manual)

    def test_table(self):
        result = self.evaluate(*self.files, *self.markers)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        for part in ("2 of 3", "66.7 %", "30.000 mm", "3.000 m", "1.0000 %", "0.8 %", "70 units"):
            self.assertIn(part, result.stdout)
        self.assertNotIn("0.8 %", self.evaluate(*self.files).stdout)

    def test_report(self):
        directory = self.path("new/report")
        result = self.evaluate(*self.files, *self.markers, "--report", directory)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        for name in ("route.png", "errors.png", "residuals.png"):
            with open(os.path.join(directory, name), "rb") as file:
                self.assertEqual(file.read(8), b"\x89PNG\r\n\x1a\n")
            self.assertIn(os.path.join(directory, name), result.stdout)

    def test_report_of_a_single_pose_without_error(self):
        write_trajectory(self.reference, trajectory((1, 0, 0, 0)))
        result = self.evaluate("--estimate", self.reference, "--reference", self.reference,
                               "--report", self.path("report"))
        self.assertEqual((result.returncode, result.stderr), (0, ""))

    def test_bad_input(self):
        self.assert_refused(self.evaluate("--estimate", "none.tum", *self.files[2:]), "none.tum")
        broken = self.write("broken.tum", "1 2 3\n")
        self.assert_refused(self.evaluate("--estimate", broken, *self.files[2:]), "broken.tum:1: ")
        other = self.write("other.tum", "50 0 0 0 0 0 0 1\n")
        self.assert_refused(self.evaluate("--estimate", other, *self.files[2:]),
                            "other.tum", "50.000000000")
        self.assert_refused(self.evaluate(*self.files, "--report", broken), "broken.tum")
        self.assert_refused(
            self.evaluate(*self.files, *self.markers[:2], "--detections", broken), "broken.tum:1: ")

    def test_bad_arguments(self):
        for arguments in ((), self.files[:2], self.files + self.markers[:2],
                          self.files + self.markers[2:], self.files + ("--tolerance", "-1"),
                          self.files + ("--tolerance", "nan"), self.files + ("--align",)):
            with self.subTest(arguments):
                result = self.evaluate(*arguments)
                self.assertEqual((result.returncode, result.stdout), (2, ""))
                self.assertIn("error:", result.stderr)


if __name__ == "__main__":
    unittest.main()
