import math
import unittest

from source_tree import FileTest

import numpy as np
from omnitag.trajectory import (format_stamp, parse_stamp, planar_trajectory, read_trajectory,
                                write_trajectory)


class TrajectoryTest(FileTest):
    def test_reads_poses_and_skips_comments(self):
        half = math.sqrt(0.5)
        path = self.write("a.tum", "# stamp x y z qx qy qz qw\n\n"
                          "10.5 1 -2 0 0 0 0 1\n"
                          "  11 4.0 5e-1 0.25 0 0 {0} {0}\n".format(half))
        trajectory = read_trajectory(path)
        self.assertEqual(trajectory.stamps.tolist(), [10_500_000_000, 11_000_000_000])
        np.testing.assert_array_equal(trajectory.positions, [[1, -2, 0], [4, 0.5, 0.25]])
        np.testing.assert_allclose(trajectory.yaw, [0.0, math.pi / 2], atol=1e-15)

    def test_stamps_of_today_survive_to_the_nanosecond(self):
        # Doubles are 238 ns apart there.
        self.assertEqual(parse_stamp("1700000000.123456789"), 1700000000123456789)
        self.assertEqual(format_stamp(1700000000123456789), "1700000000.123456789")
        self.assertEqual(format_stamp(5), "0.000000005")
        self.assertEqual(parse_stamp("1.7e9"), 1700000000000000000)

    def test_round_trip_through_a_file(self):
        stamps = np.array([1700000000000000001, 1700000000000000002])
        written = planar_trajectory(stamps, np.array([1.25, -3.0]), np.array([0.0, 7.5]),
                                    np.array([3.0, -1.0]))
        write_trajectory(self.path("a.tum"), written)
        with open(self.path("a.tum"), encoding="utf-8") as file:
            self.assertTrue(file.readline().startswith("1700000000.000000001 1.25"))
        read = read_trajectory(self.path("a.tum"))
        np.testing.assert_array_equal(read.stamps, stamps)
        np.testing.assert_allclose(read.positions, written.positions, atol=1e-9)
        np.testing.assert_allclose(read.yaw, [3.0, -1.0], atol=1e-8)

    def test_nearly_unit_quaternions_are_normalized(self):
        path = self.write("a.tum", "1 0 0 0 0 0 0 1.0009\n")
        np.testing.assert_array_equal(read_trajectory(path).orientations, [[0, 0, 0, 1]])

    def test_bad_lines_are_named(self):
        good = "1 0 0 0 0 0 0 1\n"
        for line, *parts in (
                ("2 0 0 0 0 0 0", "8 fields", "found 7"),
                ("2 0 0 0 0 0 0 1 9", "8 fields", "found 9"),
                ("2 0 zero 0 0 0 0 1", "y", "'zero'"),
                ("2 nan 0 0 0 0 0 1", "x", "'nan'"),
                ("2 0 0 inf 0 0 0 1", "z", "'inf'"),
                ("soon 0 0 0 0 0 0 1", "stamp", "'soon'"),
                ("nan 0 0 0 0 0 0 1", "stamp", "'nan'"),
                ("-2 0 0 0 0 0 0 1", "stamp", "'-2'"),
                ("1 0 0 0 0 0 0 1", "after 1.000000000"),
                ("0.5 0 0 0 0 0 0 1", "found 0.500000000"),
                ("2 0 0 0 0 0 0 1.0011", "length 1", "1.0011"),
                ("2 0 0 0 0 0 0 0", "length 1", "length 0")):
            with self.subTest(line), self.assert_error("a.tum:2: ", *parts):
                read_trajectory(self.write("a.tum", good + line + "\n"))

    def test_bad_files_are_named(self):
        with self.assert_error("none.tum", "No such file"):
            read_trajectory(self.path("none.tum"))
        with self.assert_error("empty.tum", "found none"):
            read_trajectory(self.write("empty.tum", "# nothing\n"))
        with open(self.path("binary.tum"), "wb") as file:
            file.write(b"\xff\xfe\x00")
        with self.assert_error("binary.tum", "UTF-8"):
            read_trajectory(self.path("binary.tum"))


if __name__ == "__main__":
    unittest.main()
