"""A robot that moves while rows are exposed: its path, its odometry and its images."""

import unittest

from source_tree import FileTest

import numpy as np
from omnitag.marker_map import rotation_from_quaternion
from omnitag.rendering.camera import FisheyeCamera, Lens
from omnitag.rendering.odometry import Odometry, odometry_samples, samples_after
from omnitag.rendering.path import SmoothPath
from omnitag.rendering.poses import leaning_quaternion, leaning_transform, upright_transform
from omnitag.rendering.route import Frame, read_route, trajectory_of, write_route
from omnitag.rendering.sequence import render_frames
from omnitag.rendering.shutter import Shutter, read_shutter
from omnitag.rendering.world import load_world
from omnitag.yaml_file import read_yaml
from test_render_changes import START, WORLD, WorldTest

MILLISECOND = 10**6
QUARTER = 250 * MILLISECOND


def curve(count: int, jumps: tuple = ()) -> list:
    """A winding way that leans, with jumps to these rows."""
    return [Frame(START + QUARTER * i, np.sin(0.9 * i), 0.3 * i, np.angle(np.exp(1j * 0.4 * i)),
                  i in jumps, 0.1 * np.cos(i), 0.05 * np.sin(2.0 * i), 0.03 * i)
            for i in range(count)]


class LeaningPoseTest(FileTest):
    """Six numbers."""

    def test_turns_about_x_then_y_then_z(self):
        # One at a time, by hand: the roll lifts y, the pitch lowers x.
        np.testing.assert_allclose(leaning_transform([1, 2, 3], 0.0, 0.3, 0.0)[:3, 1],
                                   [0.0, np.cos(0.3), np.sin(0.3)])
        np.testing.assert_allclose(leaning_transform([1, 2, 3], 0.0, 0.0, 0.3)[:3, 0],
                                   [np.cos(0.3), 0.0, -np.sin(0.3)])
        whole = (leaning_transform([1, 2, 3], 0.7, 0.0, 0.0)
                 @ leaning_transform([0, 0, 0], 0.0, 0.0, -0.4)
                 @ leaning_transform([0, 0, 0], 0.0, 0.2, 0.0))
        np.testing.assert_allclose(leaning_transform([1, 2, 3], 0.7, 0.2, -0.4), whole, atol=1e-15)
        np.testing.assert_allclose(rotation_from_quaternion(leaning_quaternion(0.7, 0.2, -0.4)),
                                   whole[:3, :3], atol=1e-15)

    def test_route_with_six_numbers(self):
        path = self.write("route.csv", "stamp,x,y,yaw,z,roll,pitch,jump\n0,1,2,3,4,0.5,0.6,1\n")
        frame, = read_route(path, 10)
        self.assertEqual(frame, Frame(10, 1.0, 2.0, 3.0, True, 4.0, 0.5, 0.6))
        write_route(path, [frame])
        self.assertEqual(read_route(path, 0), [frame])
        trajectory = trajectory_of([frame])
        self.assertEqual(trajectory.positions.tolist(), [[1.0, 2.0, 4.0]])
        np.testing.assert_allclose(rotation_from_quaternion(trajectory.orientations[0]),
                                   frame.map_from_base[:3, :3], atol=1e-15)

    def test_wrong_lean(self):
        path = self.write("route.csv", "stamp,x,y,yaw,z,roll,pitch\n0,1,2,3,4,much,0\n")
        with self.assert_error("route.csv:2: roll", "finite", "much"):
            read_route(path, 0)
        path = self.write("route.csv", "stamp,x,y,yaw,roll\n")
        with self.assert_error("route.csv:1:", "stamp,x,y,yaw,z,roll,pitch,jump", "yaw,roll"):
            read_route(path, 0)


class SmoothPathTest(unittest.TestCase):
    """Splines through the route."""

    def derivatives(self, path: SmoothPath, frame: Frame, stamp: int) -> tuple:
        """Velocity before and after `stamp`, and accelerations, from differences."""
        step = 2 * MILLISECOND
        poses = np.array([path.pose(frame, stamp + k * step) for k in (-2, -1, 0, 1, 2)])
        before, after = poses[2] - poses[1], poses[3] - poses[2]
        bends = poses[2:] - 2.0 * poses[1:-1] + poses[:-2]
        return before / 0.002, after / 0.002, bends / 0.002**2

    def test_goes_through_the_rows(self):
        frames = curve(8)
        path = SmoothPath(frames)
        for frame in frames:
            np.testing.assert_allclose(path.pose(frame, frame.stamp).map_from_base,
                                       frame.map_from_base, atol=1e-12)

    def test_velocity_and_acceleration_are_continuous(self):
        frames = curve(8)
        path = SmoothPath(frames)
        for frame in frames:
            before, after, bends = self.derivatives(path, frame, frame.stamp)
            np.testing.assert_allclose(before, after, atol=0.08)
            # Linear in time on both sides: no step.
            np.testing.assert_allclose(bends[0] - bends[1], bends[1] - bends[2], atol=1.5)

    def test_straight_beyond_the_ends(self):
        frames = curve(5)
        path = SmoothPath(frames)
        for frame, direction in ((frames[0], -1), (frames[-1], 1)):
            poses = np.array([path.pose(frame, frame.stamp + direction * k * 20 * MILLISECOND)
                              for k in range(4)])
            np.testing.assert_allclose(np.diff(poses[1:], axis=0)[1], poses[3] - poses[2])
            inward = np.array(path.pose(frame, frame.stamp - direction * 10**5)) - poses[0]
            np.testing.assert_allclose(poses[1] - poses[0], -200.0 * inward, atol=1e-4)

    def test_stretches_between_jumps_are_apart(self):
        frames = curve(8, (3, 4))
        whole, part = SmoothPath(frames), SmoothPath(frames[4:])
        for stamp in range(frames[4].stamp, frames[7].stamp, 30 * MILLISECOND):
            np.testing.assert_array_equal(whole.pose(frames[5], stamp), part.pose(frames[5], stamp))
        np.testing.assert_allclose(whole.pose(frames[3], frames[4].stamp).map_from_base,
                                   frames[3].map_from_base)


class SmoothOdometryTest(unittest.TestCase):
    """Odometry between the images."""

    def test_lies_on_the_path(self):
        frames = curve(6)
        path = SmoothPath(frames)
        samples = odometry_samples(Odometry(rate=100.0, lean=True), frames, range(6))
        samples = sum(samples, [])
        odom_from_map = np.linalg.inv(upright_transform([frames[0].x, frames[0].y, 0.0],
                                                        frames[0].yaw))
        self.assertEqual(len(samples), 126)
        for sample in samples:
            found = leaning_transform([sample.x, sample.y, sample.z], sample.yaw, sample.roll,
                                      sample.pitch)
            truth = path.pose(frames[0], sample.stamp).map_from_base
            np.testing.assert_allclose(found, odom_from_map @ truth, atol=1e-9)

    def test_planar_by_default(self):
        for samples in odometry_samples(Odometry(), curve(4), range(4)):
            for sample in samples:
                self.assertEqual(sample[4:], (0.0, 0.0, 0.0))

    def test_errors_grow_evenly_between_the_images(self):
        frames = curve(3)
        exact, erring = (odometry_samples(Odometry(translation_per_metre=error, rate=100.0),
                                          frames, range(3))[1] for error in (0.0, 0.2))
        errors = np.array(erring)[:, 1:3] - np.array(exact)[:, 1:3]
        self.assertGreater(np.abs(errors[-1]).max(), 0.01)
        times = np.array([sample.stamp - frames[0].stamp for sample in exact]) / QUARTER
        np.testing.assert_allclose(errors, times[:, None] * errors[-1], atol=1e-9)

    def test_covers_all_exposures(self):
        frames = curve(3)
        path = SmoothPath(frames)
        lead, tail = 15 * MILLISECOND, 35 * MILLISECOND
        odometry = Odometry(rate=100.0)
        first, *_, last = odometry_samples(odometry, frames, range(3), path, lead, tail)
        self.assertEqual([(sample.stamp - START) // MILLISECOND for sample in first], [-15, -10, 0])
        self.assertEqual(first[-1][1:4], (0.0, 0.0, 0.0))
        after = samples_after(odometry, frames[-1], last[-1], path, tail)
        self.assertEqual([(sample.stamp - frames[-1].stamp) // MILLISECOND for sample in after],
                         [10, 20, 30, 35])
        odom_from_map = np.linalg.inv(upright_transform([frames[0].x, frames[0].y, 0.0],
                                                        frames[0].yaw))
        for sample in first + after:
            truth = path.pose(frames[0], sample.stamp)
            np.testing.assert_allclose(
                upright_transform([sample.x, sample.y, 0.0], sample.yaw),
                odom_from_map @ upright_transform([truth.x, truth.y, 0.0], truth.yaw), atol=1e-9)

    def test_is_carried_between_exposures_alone(self):
        frames = curve(6, (3,))
        path = SmoothPath(frames)
        lead, tail = 20 * MILLISECOND, 40 * MILLISECOND
        samples = sum(odometry_samples(Odometry(rate=100.0, lean=True), frames, range(6), path,
                                       lead, tail), [])
        poses = {(s.stamp - frames[2].stamp) // MILLISECOND:
                 upright_transform([s.x, s.y, 0.0], s.yaw) for s in samples}
        for times, frame in (((0, 10, 40), frames[2]), ((230, 240, 250), frames[3])):
            for before, after in zip(times, times[1:]):
                truths = [path.pose(frame, frames[2].stamp + time * MILLISECOND)
                          for time in (before, after)]
                truths = [upright_transform([t.x, t.y, 0.0], t.yaw) for t in truths]
                np.testing.assert_allclose(np.linalg.inv(poses[before]) @ poses[after],
                                           np.linalg.inv(truths[0]) @ truths[1], atol=1e-9)
        for time in (50, 150, 220, 230):
            np.testing.assert_allclose(poses[time], poses[40], atol=1e-12)
        leans = {(s.stamp - frames[2].stamp) // MILLISECOND: s[4:] for s in samples}
        self.assertEqual(leans[220], leans[40])


class ShutterTest(FileTest):
    """When rows are exposed, and to what."""

    def test_instant_by_default(self):
        np.testing.assert_array_equal(Shutter().moments(5), [0.0])
        np.testing.assert_array_equal(Shutter().weights(5), np.ones((5, 1)))

    def test_weights_are_the_mean_over_the_exposure(self):
        for shutter in (Shutter(0.0, 0.0007, 0.002), Shutter(0.0053, -0.0004, 0.0, 0.0021),
                        Shutter(0.004, 0.0, -0.01), Shutter(0.0003, 0.0004, 0.0, 0.0021)):
            moments, weights = shutter.moments(9), shutter.weights(9)
            self.assertLessEqual(np.diff(moments).max(), shutter.sub_frame_interval + 1e-12)
            np.testing.assert_allclose(weights.sum(axis=1), 1.0)
            values = np.sin(300.0 * moments)
            for row in range(9):
                middle = shutter.image_time_offset + row * shutter.row_readout_time
                times = middle + shutter.exposure_time * (np.arange(4000) / 3999.0 - 0.5)
                self.assertAlmostEqual(weights[row] @ values,
                                       np.interp(times, moments, values).mean(), delta=1e-3)

    def test_keys(self):
        keys = ("exposure_time", "row_readout_time", "image_time_offset", "sub_frame_interval")

        def read(text: str) -> Shutter:
            return read_shutter(read_yaml(self.write("world.yaml", text)).mapping(keys))

        self.assertEqual(read("{}"), Shutter())
        self.assertEqual(read("{exposure_time: 0.01, row_readout_time: -0.00002, "
                              "image_time_offset: -0.03, sub_frame_interval: 0.002}"),
                         Shutter(0.01, -0.00002, -0.03, 0.002))
        for text, parts in (("{exposure_time: -1}", ("exposure_time", "at least 0")),
                            ("{row_readout_time: soon}", ("row_readout_time", "finite")),
                            ("{sub_frame_interval: 0}", ("sub_frame_interval", "positive"))):
            with self.assert_error("world.yaml:1: ", *parts):
                read(text)


class RenderedMotionTest(WorldTest):
    """A fisheye that looks ahead, turning before the vertical edge of a dark box."""

    CAMERA = FisheyeCamera(61, 61, Lens(40.0, 40.0, 30.0, 30.0), 0.9)
    TURN_RATE = 1.2  # rad/s
    SETTINGS = (
        "camera.orientation=[-0.5, 0.5, -0.5, 0.5]",
        "materials=[{name: paint, grey: 0.5}, {name: coal, grey: 0.1}]",
        "furniture=[{shape: box, position: [1.5, 1, 0], size: [0.1, 2, 3], material: coal}]",
        "missing_markers=[0, 1, 2]", "images.sub_frame_interval=0.01")

    def render(self, *settings: str, turn_rate: float = TURN_RATE) -> np.ndarray:
        """The image at a yaw of 0."""
        world = load_world(self.write("world.yaml", WORLD), None, self.SETTINGS + settings)
        route = [Frame(START + k * QUARTER, 0.0, 0.0, turn_rate * 0.25 * (k - 1))
                 for k in range(3)]
        return list(render_frames(world, self.CAMERA, route[1:2], 6, samples=9,
                                  path=SmoothPath(route)))[0]

    def edges(self, image: np.ndarray) -> np.ndarray:
        """Where each row between 15 and 46 has its edge, from the light beside it."""
        part = image[15:46, 15:46]
        dark, light = part[:, :3].mean(), part[:, -3:].mean()
        return 15.0 + ((light - part) / (light - dark)).sum(axis=1) - 0.5

    def test_rows_are_displaced_by_the_turn(self):
        rows = np.arange(15, 46)
        for settings, times in (
                (("images.row_readout_time=0.001",), 0.001 * rows),
                (("images.row_readout_time=-0.001",), -0.001 * rows),
                (("images.image_time_offset=-0.05",), -0.05 + 0.0 * rows),
                (("images.row_readout_time=0.001", "images.image_time_offset=-0.03",
                  "images.exposure_time=0.01"), 0.001 * (rows - 30))):
            # Turning left, the world goes to the right, above and below the horizon by less.
            elevation = np.maximum(np.abs(rows - 30.0), 1e-9) / 40.0
            expected = 30.0 + 40.0 * self.TURN_RATE * times * elevation / np.tan(elevation)
            edges = self.edges(self.render(*settings))
            # Half of what lies between two of an edge's rays.
            np.testing.assert_allclose(edges, expected, atol=0.5 / 9.0 + 0.02)

    def test_exposure_spreads_an_edge(self):
        image = self.render("images.exposure_time=0.12", "images.sub_frame_interval=0.005")
        profile = (image[30] - image[30, 18]) / (image[30, 42] - image[30, 18])
        width = 40.0 * self.TURN_RATE * 0.12
        columns = np.arange(20, 41)
        # The mean over each pixel of a ramp.
        fine = np.linspace(-0.5, 0.5, 101)
        ramp = np.clip((columns[:, None] + fine - 30.0) / width + 0.5, 0.0, 1.0).mean(axis=1)
        np.testing.assert_allclose(profile[20:41], ramp, atol=0.02)

    def test_robot_at_rest_is_rendered_once(self):
        still = self.render(turn_rate=0.0)
        image = self.render("images.exposure_time=0.01", "images.row_readout_time=0.001",
                            turn_rate=0.0)
        np.testing.assert_array_equal(image, still)


if __name__ == "__main__":
    unittest.main()
