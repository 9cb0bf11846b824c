import unittest

from source_tree import FileTest

import numpy as np
from omnitag.command_line import InputError
from omnitag.map_merging import merge
from omnitag.marker_map import Marker, MarkerMap, load_marker_map, rotation_from_yaw_and_roll
from omnitag.rotation import rotation_from_vector, vector_from_rotation

DEVIATION = 0.01
TURN = np.radians(0.5)
YAW = 2.2
SHIFT = np.array([7.0, -3.0, 1.5])


def hung(marker_id, position, yaw, name=""):
    pose = np.eye(4)
    pose[:3, :3] = rotation_from_yaw_and_roll(yaw)
    pose[:3, 3] = position
    return Marker(marker_id, "tag36h11", name, 0.2, pose)


def building():
    """Twelve markers along two walls, as they are."""
    return [hung(i, (1.5 * i, 0.3 * (i % 3), 1.0 + 0.1 * (i % 4)), 1.2 + 0.2 * (i % 2))
            for i in range(12)]


def surveyed(markers, generator, deviation=DEVIATION, turn=TURN):
    """As a map has them that errs."""
    found = []
    for marker in markers:
        pose = marker.map_from_marker.copy()
        pose[:3, :3] = rotation_from_vector(turn * generator.normal(size=3)) @ pose[:3, :3]
        pose[:3, 3] += deviation * generator.normal(size=3)
        found.append(Marker(marker.id, marker.family, marker.name, marker.size, pose, deviation, turn))
    return MarkerMap(tuple(found))


def elsewhere(marker_map):
    """The same map in another frame."""
    other_from_map = np.eye(4)
    other_from_map[:3, :3] = rotation_from_vector((0, 0, YAW))
    other_from_map[:3, 3] = SHIFT
    return MarkerMap(tuple(
        Marker(m.id, m.family, m.name, m.size, other_from_map @ m.map_from_marker, m.deviation,
               m.orientation_deviation) for m in marker_map.markers))


class MergingTest(unittest.TestCase):
    def setUp(self):
        self.generator = np.random.default_rng(5)
        self.truth = building()

    def merged(self, first, second):
        """Of what one drive saw, which the frame is of, and what another one saw."""
        return merge(surveyed(first, self.generator),
                     elsewhere(surveyed(second, self.generator)))

    def test_deviations_are_those_of_the_errors(self):
        squares = {"both": [], "first": [], "second": []}
        turns = []
        for _ in range(150):
            for marker in self.merged(self.truth[:8], self.truth[5:]).marker_map.markers:
                true = self.truth[marker.id]
                part = "first" if marker.id < 5 else "both" if marker.id < 8 else "second"
                error = (marker.position - true.position) / marker.deviation
                squares[part].append(np.mean(error ** 2))
                turn = vector_from_rotation(marker.map_from_marker[:3, :3]
                                            @ true.map_from_marker[:3, :3].T)
                turns.append(np.mean((turn / marker.orientation_deviation) ** 2))
        for part, values in squares.items():
            self.assertGreater(np.mean(values), 0.6, part)
            self.assertLess(np.mean(values), 1.25, part)
        self.assertGreater(np.mean(turns), 0.6)
        self.assertLess(np.mean(turns), 1.25)

    def test_exact_maps_fit_exactly(self):
        for shared in (1, 2, 5):
            first = surveyed(self.truth[:6], self.generator, 0.0, 0.0)
            second = elsewhere(surveyed(self.truth[6 - shared:], self.generator, 0.0, 0.0))
            result = merge(first, second)
            self.assertEqual([marker.id for marker in result.marker_map.markers], list(range(12)))
            for marker in result.marker_map.markers:
                np.testing.assert_allclose(marker.map_from_marker,
                                           self.truth[marker.id].map_from_marker, atol=1e-9)

    def test_what_was_moved_between_is_named_and_misleads_nobody(self):
        for moved in range(4, 8):
            second = building()
            second[moved] = hung(moved, self.truth[moved].position + [0.4, 0.0, 0.0], 1.9)
            result = self.merged(self.truth[:8], second[4:])
            named = [remark for remark in result.remarks if "apart" in remark]
            self.assertEqual(len(named), 1)
            self.assertTrue(named[0].startswith("marker tag36h11 {}: ".format(moved)), named[0])
            self.assertAlmostEqual(float(named[0].split("have it ")[1].split(" m")[0]), 0.4, delta=0.05)
            for marker in result.marker_map.markers:
                error = np.linalg.norm(marker.position - self.truth[marker.id].position)
                self.assertLess(error, 5.0 * np.sqrt(3.0) * marker.deviation, marker.id)

    def test_what_is_exact_stays(self):
        first = surveyed(self.truth[:6], self.generator, 0.0, 0.0)
        result = merge(first, elsewhere(surveyed(self.truth[3:], self.generator)))
        for marker, before in zip(result.marker_map.markers, first.markers):
            self.assertEqual((marker.deviation, marker.orientation_deviation), (0.0, 0.0))
            np.testing.assert_allclose(marker.map_from_marker, before.map_from_marker, atol=1e-6)

    def test_ids_that_are_reused_tie_nothing(self):
        twice = self.truth[:4] + [hung(3, (20.0, 0.0, 1.0), 0.0)]
        result = self.merged(twice, self.truth[2:6])
        self.assertIn("fitted by 1 of 1 markers", result.remarks[0])
        with self.assertRaisesRegex(InputError, "both maps have once"):
            self.merged(twice, self.truth[3:6])

    def test_ids_that_are_reused_are_told_apart_by_place(self):
        again = [hung(3, (20.0, 0.0, 1.0), 0.0), hung(3, (30.0, 0.0, 1.0), 0.0)]
        result = self.merged(self.truth[:6] + again[:1], self.truth[1:] + again)
        threes = [marker for marker in result.marker_map.markers if marker.id == 3]
        for marker, true in zip(threes, [self.truth[3], *again]):
            error = np.linalg.norm(marker.position - true.position)
            self.assertLess(error, 5.0 * np.sqrt(3.0) * marker.deviation)
        self.assertEqual(len(threes), 3)
        self.assertEqual(len(result.marker_map.markers), 14)

    def test_names(self):
        first = MarkerMap((hung(0, (0, 0, 1), 0.0, name="door"), hung(1, (2, 0, 1), 0.0)))
        second = MarkerMap((hung(0, (0, 0, 1), 0.0, name="entrance"),
                            hung(2, (5, 0, 1), 0.0, name="door"),
                            hung(3, (6, 0, 1), 0.0, name="window")))
        result = merge(first, second)
        self.assertEqual([m.name for m in result.marker_map.markers], ["door", "", "", "window"])
        self.assertIn("marker door: the name is taken: it has none now", result.remarks)


class MergeMapsTest(FileTest):
    FIRST = ("frame_id: map\nfamily: tag36h11\nsize: 0.2\nmarkers:\n"
             "  - {id: 1, position: [0, 0, 1], yaw: 0.5}\n  - {id: 2, position: [4, 0, 1], yaw: 0.5}\n")
    SECOND = ("family: tag36h11\nsize: 0.2\nmarkers:\n"
              "  - {id: 2, position: [0, 4, 1], yaw: 2.0707963}\n"
              "  - {id: 3, position: [0, 9, 1], yaw: 0.5}\n")
    THIRD = ("family: tag36h11\nsize: 0.2\nmarkers:\n"
             "  - {id: 3, position: [1, 1, 1], yaw: -1.0707963}\n"
             "  - {id: 4, position: [1, 3, 1], yaw: 0.0}\n"
             "constraints:\n  - {height: 3, is: 1.0}\n")

    def test_chain(self):
        paths = [self.write(name, text) for name, text in
                 (("a.yaml", self.FIRST), ("b.yaml", self.SECOND), ("c.yaml", self.THIRD))]
        result = self.run_tool("merge_maps", *paths, "--output", self.path("out.yaml"))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("4 markers", result.stdout)
        self.assertIn("c.yaml: its constraints are not taken along", result.stdout)
        merged = load_marker_map(self.path("out.yaml"))
        positions = {marker.id: marker.position for marker in merged.markers}
        # The second map is turned by a quarter; the third hangs on it by one marker.
        for marker_id, position in ((1, (0, 0, 1)), (2, (4, 0, 1)), (3, (9, 0, 1)), (4, (9, 2, 1))):
            np.testing.assert_allclose(positions[marker_id], position, atol=1e-5)

    def test_bad_input(self):
        first, second = self.write("a.yaml", self.FIRST), self.write("b.yaml", self.SECOND)
        larger = self.write("c.yaml", self.SECOND.replace("0.2", "0.25"))
        third = self.write("d.yaml", self.THIRD)
        for arguments, error in (
                ((first, third), "d.yaml: expected a marker that both maps have once; found none"),
                ((first, larger), "c.yaml: marker tag36h11 2: expected one size; found 0.2 m and "
                                  "0.25 m"),
                ((first, self.path("none.yaml")), "none.yaml: cannot be read")):
            result = self.run_tool("merge_maps", *arguments, "--output", self.path("out.yaml"))
            self.assertEqual(result.returncode, 1)
            self.assertIn(error, result.stderr)
            self.assertEqual(len(result.stderr.splitlines()), 1)
        result = self.run_tool("merge_maps", first, second, "--output", second)
        self.assertIn("would be overwritten", result.stderr)
        with open(second, encoding="utf-8") as file:
            self.assertEqual(file.read(), self.SECOND)


if __name__ == "__main__":
    unittest.main()
