"""Odometry of a rendered route, and the route's jumps."""

import unittest

from source_tree import FileTest

import numpy as np
from omnitag.rendering.odometry import Odometry, odometry_samples, read_odometry
from omnitag.rendering.poses import upright_transform
from omnitag.rendering.route import Frame, read_route, write_route
from omnitag.yaml_file import read_yaml

QUARTER = 250000000


def straight(count: int) -> list:
    """Along the map's diagonal, 0.1 m each."""
    step = 0.1 * np.sqrt(0.5)
    return [Frame(10**12 + QUARTER * index, 2.0 + step * index, step * index, np.pi / 4.0)
            for index in range(count)]


def turning(count: int) -> list:
    """In place, 0.2 rad each."""
    return [Frame(10**12 + QUARTER * index, 2.0, 1.0, 0.2 * index) for index in range(count)]


def at_frames(odometry: Odometry, frames: list, first_row: int = 0) -> np.ndarray:
    rows = range(first_row, first_row + len(frames))
    return np.array([samples[-1][1:4] for samples in odometry_samples(odometry, frames, rows)])


def motions(poses: np.ndarray) -> np.ndarray:
    """x, y and yaw of each pose in the one before."""
    transforms = [upright_transform([x, y, 0.0], yaw) for x, y, yaw in poses]
    relative = [np.linalg.inv(before) @ after
                for before, after in zip(transforms, transforms[1:])]
    return np.array([(t[0, 3], t[1, 3], np.arctan2(t[1, 0], t[0, 0])) for t in relative])


class OdometryTest(unittest.TestCase):
    """Poses in the odometry frame."""

    def test_straight_without_errors(self):
        poses = at_frames(Odometry(), straight(6))
        np.testing.assert_allclose(poses[:, 0], 0.1 * np.arange(6), atol=1e-12)
        np.testing.assert_allclose(poses[:, 1:], 0.0, atol=1e-12)

    def test_curve_without_errors_is_the_truth_seen_from_the_first_pose(self):
        frames = [Frame(QUARTER * i, np.sin(0.9 * i), 0.3 * i, 3.0 + 0.4 * i) for i in range(8)]
        odom_from_map = np.linalg.inv(frames[0].map_from_base)
        for pose, frame in zip(at_frames(Odometry(), frames), frames):
            np.testing.assert_allclose(upright_transform([pose[0], pose[1], 0.0], pose[2]),
                                       odom_from_map @ frame.map_from_base, atol=1e-12)

    def test_scale_is_of_distances(self):
        poses = at_frames(Odometry(scale=1.1), straight(4))
        np.testing.assert_allclose(poses[:, 0], 0.11 * np.arange(4), atol=1e-12)
        poses = at_frames(Odometry(scale=1.1), turning(4))
        np.testing.assert_allclose(poses[:, 2], 0.2 * np.arange(4), atol=1e-12)

    def test_noise_is_as_strong_as_asked_for(self):
        noise = {"rotation_per_rotation": 0.1, "rotation_per_metre": 0.05,
                 "translation_per_metre": 0.03, "translation_per_rotation": 0.02}
        for frames, truth, expected in (
                (straight(4001), (0.1, 0.0, 0.0), 0.1 * np.array([0.03, 0.03, 0.05])),
                (turning(4001), (0.0, 0.0, 0.2), 0.2 * np.array([0.02, 0.02, 0.1]))):
            errors = motions(at_frames(Odometry(**noise), frames)) - truth
            # Four standard deviations of what 4000 samples tell.
            np.testing.assert_allclose(errors.std(axis=0), expected, rtol=4.0 / np.sqrt(8000.0))
            self.assertTrue(np.all(np.abs(errors.mean(axis=0)) < 4.0 * expected / np.sqrt(4000.0)))

    def test_noise_belongs_to_the_row_and_the_seed(self):
        odometry = Odometry(translation_per_metre=0.1, rotation_per_metre=0.1, seed=5)
        frames = straight(6)
        whole = motions(at_frames(odometry, frames))
        part = motions(at_frames(odometry, frames[2:], 2))
        np.testing.assert_allclose(part, whole[2:], atol=1e-12)
        other = motions(at_frames(odometry._replace(seed=6), frames))
        self.assertTrue(np.all(other != whole))
        faster = odometry._replace(rate=100.0)
        np.testing.assert_array_equal(at_frames(faster, frames), at_frames(odometry, frames))

    def test_jump_is_not_seen(self):
        frames = straight(2) + [Frame(10**12 + 2 * QUARTER, -3.0, 1.0, 0.0, True),
                                Frame(10**12 + 3 * QUARTER, -2.8, 1.0, 0.0)]
        noisy = Odometry(translation_per_metre=0.1, rotation_per_rotation=0.1)
        samples = odometry_samples(noisy, frames, range(4))[2]
        self.assertEqual(len({sample[1:] for sample in samples}), 1)
        poses = at_frames(Odometry(), frames)
        np.testing.assert_allclose(poses[:, 0], [0.0, 0.1, 0.1, 0.3], atol=1e-12)

    def test_samples_lie_between_the_images(self):
        samples = odometry_samples(Odometry(rate=10.0), straight(3), range(3))
        self.assertEqual([[sample.stamp - 10**12 for sample in between] for between in samples],
                         [[0], [100000000, 200000000, QUARTER],
                          [350000000, 450000000, 2 * QUARTER]])
        np.testing.assert_allclose([sample.x for sample in samples[2]], [0.14, 0.18, 0.2])

    def test_turns_take_the_shorter_way(self):
        frames = [Frame(0, 0.0, 0.0, 3.1), Frame(QUARTER, 0.0, 0.0, -3.1)]
        turn = 2.0 * np.pi - 6.2
        middle, = [sample for sample in odometry_samples(Odometry(rate=8.0), frames, range(2))[1]
                   if sample.stamp == QUARTER // 2]
        self.assertAlmostEqual(middle.yaw, 0.5 * turn)


class OdometryKeysTest(FileTest):
    """The mapping of the world file."""

    def read(self, text: str) -> Odometry:
        root = read_yaml(self.write("world.yaml", "odometry: " + text)).mapping(("odometry",))
        return read_odometry(root["odometry"])

    def test_all_keys(self):
        self.assertEqual(self.read("{}"), Odometry())
        self.assertEqual(
            self.read("{frame_id: wheels, rotation_per_rotation: 0.1, rotation_per_metre: 0.2, "
                      "translation_per_metre: 0.3, translation_per_rotation: 0.4, scale: 1.02, "
                      "rate: 50, seed: 3}"),
            Odometry("wheels", 0.1, 0.2, 0.3, 0.4, 1.02, 50.0, 3))

    def test_wrong_values(self):
        for text, parts in (
                ("{rotation_per_metre: -1}", ("odometry.rotation_per_metre", "at least 0", "-1")),
                ("{rate: 0}", ("odometry.rate", "positive", "0")),
                ("{seed: 1.5}", ("odometry.seed", "integer", "1.5")),
                ("{seed: -1}", ("odometry.seed", "from 0", "-1")),
                ("{alpha1: 0.1}", ("odometry.alpha1", "unknown"))):
            with self.assert_error("world.yaml:1:", *parts):
                self.read(text)


class JumpColumnTest(FileTest):
    """The route's optional fifth column."""

    def test_jumps(self):
        path = self.write("route.csv", "stamp,x,y,yaw,jump\n0,1,2,3,0\n0.25,4,5,-1,1\n")
        self.assertEqual(read_route(path, 10), [Frame(10, 1.0, 2.0, 3.0, False),
                                                Frame(QUARTER + 10, 4.0, 5.0, -1.0, True)])

    def test_written_route_is_read(self):
        frames = [Frame(0, 1.25, -2.0, 3.0, False), Frame(QUARTER, 0.0, 0.5, -3.14159, True)]
        write_route(self.path("route.csv"), frames)
        self.assertEqual(read_route(self.path("route.csv"), 0), frames)

    def test_wrong_jumps(self):
        for text, parts in (
                ("stamp,x,y,yaw,jump\n0,1,2,3,yes\n", (":2: jump", "0 or 1", "yes")),
                ("stamp,x,y,yaw,jump\n0,1,2,3\n", (":2:", "5 fields", "found 4")),
                ("stamp,x,y,yaw,hop\n0,1,2,3,0\n", (":1:", "stamp,x,y,yaw,jump", "hop"))):
            path = self.write("route.csv", text)
            with self.assert_error("route.csv", *parts):
                read_route(path, 0)


if __name__ == "__main__":
    unittest.main()
