"""Errors of a map against the true one."""

import unittest

import numpy as np
from omnitag.map_evaluation import compare, table
from omnitag.marker_map import Marker, MarkerMap, rotation_from_yaw_and_roll


def marker(marker_id, position, yaw):
    """An upright marker."""
    pose = np.eye(4)
    pose[:3, :3] = rotation_from_yaw_and_roll(yaw)
    pose[:3, 3] = position
    return Marker(marker_id, "tag36h11", "", 0.3, pose)


PLACES = [(1, (2.0, 1.0, 1.2), 0.4), (2, (-3.0, 0.5, 1.0), 2.0), (5, (0.0, 4.0, 1.5), -1.5)]


class MapEvaluationTest(unittest.TestCase):
    def test_errors_of_each_marker(self):
        reference = MarkerMap(tuple(marker(*place) for place in PLACES))
        estimate = MarkerMap((marker(1, (2.003, 1.0, 1.204), 0.4),
                              marker(2, (-3.0, 0.5, 1.0), 2.0 + np.radians(0.5)),
                              marker(9, (0.0, 0.0, 0.0), 0.0)))
        errors = compare(estimate, reference, set(), False)
        self.assertEqual([error.label for error in errors], ["1", "2"])
        np.testing.assert_allclose([error.distance for error in errors], [0.005, 0.0], atol=1e-12)
        np.testing.assert_allclose(np.degrees([error.angle for error in errors]), [0.0, 0.5],
                                   atol=1e-9)
        self.assertEqual(len(compare(estimate, reference, {("tag36h11", 1)}, False)), 1)
        self.assertIn("5.00", table(errors))

    def test_another_frame(self):
        reference = MarkerMap(tuple(marker(*place) for place in PLACES))
        turn = np.eye(4)
        turn[:3, :3] = [[0.6, -0.8, 0.0], [0.8, 0.6, 0.0], [0.0, 0.0, 1.0]]
        turn[:2, 3] = [5.0, -2.0]
        moved = tuple(Marker(m.id, m.family, m.name, m.size, turn @ m.map_from_marker)
                      for m in reference.markers)
        for error in compare(MarkerMap(moved), reference, set(), True):
            self.assertLess(error.distance, 1e-12)
            self.assertLess(error.angle, 1e-12)


if __name__ == "__main__":
    unittest.main()
