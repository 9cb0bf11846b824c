"""The tool render_sequence: what it writes and what it refuses."""

import os
import unittest

from source_tree import FileTest

import cv2
import numpy as np
import rosbag
from omnitag.command_line import InputError
from omnitag.marker_map import rotation_from_quaternion
from omnitag.rendering.camera import canvas_of, load_camera
from omnitag.rendering.poses import leaning_transform
from omnitag.rendering.route import read_route
from omnitag.rendering.world import load_world
from omnitag.trajectory import read_trajectory

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")

CAMERA = """\
model: catadioptric
image: {width: 64, height: 48}
lens: {fx: 150, fy: 150, cx: 31.5, cy: 23.5}
mirror:
  profile: spherical
  radius_of_curvature: 0.04
  apex_distance: 0.21
  rim_radius: 0.0375
"""

MAP = """\
frame_id: hall
family: tag36h11
size: 1
markers:
  - {id: 3, position: [2, 0, 1], yaw: 3.1416}
"""

WORLD = """\
marker_map: map.yaml
camera: {frame_id: eye, position: [0.1, 0, 1.1], orientation: [1, 0, 0, 0]}
images: {start: 100.5, noise: 0}
ambient: 0.5
lights: [{position: [0, 0, 2.9], size: 0, intensity: 0.5, reach: 2}]
materials:
  - {name: paint, grey: 0.5}
  - {name: tiles, pattern: checker, dark: 0.2, light: 0.4, scale: 1}
room: {x: [-3, 3], y: [-3, 3], height: 3, floor: tiles, walls: paint, ceiling: paint}
boards: {thickness: 0.02, quiet_modules: 1, black: 0, white: 1, back: paint}
furniture:
  - {shape: box, position: [0, 2, 0], size: [1, 0.5, 0.5], yaw: 0.3, material: tiles}
robot:
  - {shape: cylinder, position: [0.1, 0, 0], radius: 0.2, height: 0.3, material: paint}
"""

ROUTE = "stamp,x,y,yaw\n0.00,0,0,0\n0.25,0.1,0,1.5\n0.50,0.2,0.1,-3\n"


FISHEYE = """\
model: equidistant
image: {width: 64, height: 48}
lens: {fx: 20, fy: 20, cx: 30.5, cy: 23}
distortion: [0, 0, 0, 0]
max_angle: 1.6
"""


def values(message, names):
    return [getattr(message, name) for name in names]


class FisheyeFileTest(FileTest):
    """Which fisheyes can be rendered."""

    def load(self, text):
        return load_camera(self.write("fisheye.yaml", text))

    def test_is_read(self):
        camera = self.load(FISHEYE)
        self.assertEqual((camera.width, camera.height, camera.max_angle), (64, 48, 1.6))
        canvas = canvas_of(camera)
        # The axis is in the canvas's middle.
        self.assertEqual(0.5 * (canvas.width - 1) - canvas.left, 30.5)
        self.assertEqual(0.5 * (canvas.height - 1) - canvas.top, 23.0)
        self.assertGreaterEqual(canvas.width - canvas.left, 64)
        self.assertGreaterEqual(canvas.height - canvas.top, 48)

    def test_reaches_to_the_corners_by_default(self):
        camera = self.load(FISHEYE.replace("max_angle: 1.6\n", ""))
        self.assertAlmostEqual(camera.max_angle, np.hypot(33.0, 24.5) / 20.0)

    def test_others_are_refused(self):
        for old, new, part in (("[0, 0, 0, 0]", "[0, 0.1, 0, 0]", "exactly equidistant"),
                               ("30.5", "30.6", "lens.cx: expected a multiple of 0.5"),
                               ("1.6", "3.2", "max_angle: expected at most 3.12"),
                               ("equidistant", "unified", "model: expected 'catadioptric' or")):
            with self.assertRaises(InputError) as caught:
                self.load(FISHEYE.replace(old, new))
            self.assertIn(part, str(caught.exception))


class RenderSequenceTest(FileTest):
    def setUp(self):
        super().setUp()
        self.camera = self.write("camera.yaml", CAMERA)
        self.world = self.write("world.yaml", WORLD)
        self.route = self.write("route.csv", ROUTE)
        self.write("map.yaml", MAP)

    def render(self, *options):
        return self.run_tool("render_sequence", "--world", self.world, "--camera", self.camera,
                             "--trajectory", self.route, "--output", self.path("out.bag"),
                             "--reference", self.path("out.tum"), *options)

    def messages(self, topic):
        with rosbag.Bag(self.path("out.bag")) as bag:
            return [message for _, message, _ in bag.read_messages(topic)]

    def test_bag_and_reference(self):
        result = self.render("--keep-frames", self.path("frames"), "--frames", "1:3")
        self.assertEqual(result.returncode, 0, result.stderr)
        images = self.messages("/camera/image/compressed")
        self.assertEqual([image.header.stamp.to_nsec() for image in images],
                         [100750000000, 101000000000])
        self.assertEqual(images[0].header.frame_id, "eye")
        pixels = cv2.imdecode(np.frombuffer(images[0].data, np.uint8), cv2.IMREAD_UNCHANGED)
        kept = cv2.imread(self.path("frames/0001.png"), cv2.IMREAD_UNCHANGED)
        self.assertEqual(pixels.shape, (48, 64))
        np.testing.assert_array_equal(pixels, kept)

        transform, = self.messages("/tf_static")[0].transforms
        self.assertEqual((transform.header.frame_id, transform.child_frame_id),
                         ("base_link", "eye"))
        self.assertEqual(transform.header.stamp.to_nsec(), 100750000000)
        self.assertEqual(transform.transform.translation.x, 0.1)
        self.assertEqual(transform.transform.rotation.x, 1.0)
        with rosbag.Bag(self.path("out.bag")) as bag:
            headers = [connection.header for connection in bag._get_connections("/tf_static")]
        self.assertEqual([header["latching"] for header in headers], [b"1"])

        reference = read_trajectory(self.path("out.tum"))
        np.testing.assert_allclose(reference.yaw, [1.5, -3.0], atol=1e-8)
        truth = self.messages("/ground_truth/pose")
        self.assertEqual([pose.header.frame_id for pose in truth], ["hall", "hall"])
        self.assertEqual([pose.pose.position.x for pose in truth], [0.1, 0.2])
        self.assertAlmostEqual(truth[0].pose.orientation.z, np.sin(0.75))

    def test_another_topic(self):
        result = self.render("--topic", "/front/image", "--frames", "0:1")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(len(self.messages("/front/image/compressed")), 1)
        self.assertEqual(self.messages("/camera/image/compressed"), [])
        for topic in ("front/image", "/image", "/front/", "/1front/image"):
            self.assertIn("expected a topic", self.render("--topic", topic).stderr)

    def test_raw_images(self):
        result = self.render("--encoding", "raw", "--frames", "0:1")
        self.assertEqual(result.returncode, 0, result.stderr)
        image, = self.messages("/camera/image")
        self.assertEqual((image.width, image.height, image.step, image.encoding),
                         (64, 48, 64, "mono8"))
        self.assertEqual(len(image.data), 64 * 48)

    def test_odometry_comes_before_its_image(self):
        self.world = self.write("world.yaml", WORLD + "odometry: {rate: 10}\n")
        result = self.render("--frames", "0:2")
        self.assertEqual(result.returncode, 0, result.stderr)
        order = []
        with rosbag.Bag(self.path("out.bag")) as bag:
            for topic, message, _ in bag.read_messages(["/tf", "/camera/image/compressed"]):
                stamped = message.transforms[0] if topic == "/tf" else message
                order.append((topic[:3], stamped.header.stamp.to_nsec() // 10**6))
        self.assertEqual(order, [("/tf", 100500), ("/ca", 100500), ("/tf", 100600),
                                 ("/tf", 100700), ("/tf", 100750), ("/ca", 100750)])
        first, *_, last = self.messages("/tf")
        self.assertEqual(first.transforms[0].transform.rotation.w, 1.0)
        transform = last.transforms[0]
        self.assertEqual((transform.header.frame_id, transform.child_frame_id),
                         ("odom", "base_link"))
        self.assertAlmostEqual(transform.transform.translation.x, 0.1)
        self.assertAlmostEqual(transform.transform.rotation.z, np.sin(0.75))

    def test_options_override_the_world(self):
        self.world = self.write("world.yaml", WORLD + "odometry: {translation_per_metre: 0.1}\n")
        other = self.write("other.yaml", MAP.replace("hall", "other"))
        outcomes = []
        for options in ((), ("--noise", "2"), ("--noise", "2", "--seed", "0"),
                        ("--noise", "2", "--seed", "1"), ("--map", other)):
            result = self.render("--frames", "0:2", *options)
            self.assertEqual(result.returncode, 0, result.stderr)
            outcomes.append((self.messages("/camera/image/compressed")[1].data,
                             self.messages("/tf")[-1].transforms[0].transform.translation.x,
                             self.messages("/ground_truth/pose")[0].header.frame_id))
        plain, noisy, default_seed, seeded, mapped = outcomes
        self.assertNotEqual(noisy[0], plain[0])
        self.assertEqual(noisy[1:], plain[1:])
        self.assertEqual(default_seed, noisy)
        self.assertNotEqual(seeded[0], noisy[0])
        self.assertNotEqual(seeded[1], noisy[1])
        self.assertEqual(mapped, (*plain[:2], "other"))

    def test_truth_has_six_numbers(self):
        self.route = self.write("route.csv", "stamp,x,y,yaw,z,roll,pitch\n0,0,0,0.4,0.1,0.2,-0.1\n"
                                "0.25,0.1,0,0.5,0.1,0.2,-0.1\n")
        result = self.render("--set", "floor.constant_lean=[0.01, 0.02]", "--set",
                             "floor.constant_height=0.3", "--set", "odometry.lean=true")
        self.assertEqual(result.returncode, 0, result.stderr)
        expected = leaning_transform([0.1, 0.0, 0.4], 0.5, 0.21, -0.08)
        reference = read_trajectory(self.path("out.tum"))
        pose = self.messages("/ground_truth/pose")[1].pose
        transform = self.messages("/tf")[-1].transforms[0].transform
        # Of the odometry, as seen from the first pose in the plane.
        seen = np.linalg.inv(leaning_transform([0, 0, 0], 0.4, 0.0, 0.0)) @ expected
        for position, orientation, truth in (
                (reference.positions[1], reference.orientations[1], expected),
                (values(pose.position, "xyz"), values(pose.orientation, "xyzw"), expected),
                (values(transform.translation, "xyz"), values(transform.rotation, "xyzw"), seen)):
            np.testing.assert_allclose(position, truth[:3, 3], atol=1e-8)
            np.testing.assert_allclose(rotation_from_quaternion(np.array(orientation)),
                                       truth[:3, :3], atol=1e-8)

    def test_image_comes_when_its_last_row_is_exposed(self):
        result = self.render("--frames", "0:2", "--set", "images.row_readout_time=0.001", "--set",
                             "images.exposure_time=0.01", "--set", "images.sub_frame_interval=0.1",
                             "--set", "odometry.rate=50")
        self.assertEqual(result.returncode, 0, result.stderr)
        with rosbag.Bag(self.path("out.bag")) as bag:
            received = [(message.header.stamp.to_nsec(), stamp.to_nsec()) for _, message, stamp in
                        bag.read_messages("/camera/image/compressed")]
        self.assertEqual(received, [(stamp, stamp + 52000000)
                                    for stamp in (100500000000, 100750000000)])
        stamps = [message.transforms[0].header.stamp.to_nsec() // 10**6 - 100500
                  for message in self.messages("/tf")]
        self.assertEqual(stamps[:4], [-5, 0, 20, 40])
        self.assertEqual(stamps[-4:], [250, 270, 290, 302])

    def test_kept_light_serves_all_that_follows_it(self):
        light = self.path("light")
        images = []
        for settings in ((), ("--set", "images.gain=0.5"), ("--set", "images.turn=0.05"),
                         ("--set", "floor.constant_height=0.2")):
            result = self.render("--frames", "0:1", "--light", light, *settings)
            self.assertEqual(result.returncode, 0, result.stderr)
            images.append(self.messages("/camera/image/compressed")[0].data)
        self.assertEqual(len(set(images)), 4)
        self.assertEqual(len(os.listdir(light)), 3)

    def test_wrong_setting(self):
        self.assert_refused(self.render("--set", "images.blurr=1"), "--set: images.blurr",
                            "unknown key")
        self.assertFalse(os.path.exists(self.path("out.bag")))

    def refused_world(self, old, new, *parts):
        self.world = self.write("world.yaml", WORLD.replace(old, new))
        self.assert_refused(self.render(), "world.yaml:", *parts)
        self.assertFalse(os.path.exists(self.path("out.bag")))

    def test_wrong_world(self):
        self.refused_world("material: tiles}", "material: gold}", ":12: furniture[0].material",
                           "paint, tiles", "gold")
        self.refused_world("orientation: [1, 0, 0, 0]", "orientation: [1, 1, 0, 0]",
                           ":2: camera.orientation", "length 1")
        self.refused_world("noise: 0", "noise: .nan", ":3: images.noise", "finite")
        self.refused_world("grey: 0.5", "grey: 5", ":7: materials[0].grey", "from 0 to 1", "5")

    def test_missing_map(self):
        self.world = self.write("world.yaml", WORLD.replace("map.yaml", "none.yaml"))
        self.assert_refused(self.render(), "none.yaml", "No such file")

    def refused_camera(self, old, new, *parts):
        self.camera = self.write("camera.yaml", CAMERA.replace(old, new))
        self.assert_refused(self.render(), "camera.yaml:", *parts)

    def test_wrong_camera(self):
        self.refused_camera("catadioptric", "unified", ":1: model", "catadioptric", "unified")
        self.refused_camera("cy: 23.5}", "cy: 23.5, distortion: [0.1, 0, 0, 0, 0]}",
                            ":3: lens.distortion[0]", "POV-Ray")
        self.refused_camera("rim_radius: 0.0375", "rim_radius: 0.05", ":8: mirror.rim_radius")
        self.refused_camera("rim_radius: 0.0375", "rim_radius: 0.03\n  conic_constant: -1",
                            ":9: mirror.conic_constant", "spherical", "-1")

    def test_wrong_route(self):
        for text, parts in (
                ("stamp,x,y\n", (":1:", "stamp,x,y,yaw or")),
                (ROUTE + "0.5,0,0,0\n", (":5:", "stamp", "after")),
                (ROUTE + "0.75,0,zero,0\n", (":5:", "y", "finite", "zero")),
                ("stamp,x,y,yaw\n", ("poses", "none"))):
            self.route = self.write("route.csv", text)
            self.assert_refused(self.render(), "route.csv", *parts)

    def test_no_such_frames(self):
        for frames in ("3:9", "2:1", "1:1", "0:4"):
            self.assert_refused(self.render("--frames", frames), "--frames", "0:3", frames)


class ShippedExperimentTest(unittest.TestCase):
    """worlds/paper.yaml and its route."""

    def test_route_is_smooth(self):
        world = load_world(os.path.join(ROOT, "worlds", "paper.yaml"))
        frames = read_route(os.path.join(ROOT, "worlds", "paper_route.csv"), world.start)
        self.assertEqual(len(frames), 66)
        self.assertEqual(len(world.marker_map.markers), 17)
        stamps, x, y, yaw, *_ = np.array(frames).T
        np.testing.assert_allclose(np.diff(stamps), 0.25e9)
        self.assertLessEqual(np.hypot(np.diff(x), np.diff(y)).max(), 0.25)
        self.assertLessEqual(np.abs(np.diff(np.unwrap(yaw))).max(), np.radians(12.0))

    def test_bag_belongs_to_the_route(self):
        world = load_world(os.path.join(ROOT, "worlds", "paper.yaml"))
        frames = read_route(os.path.join(ROOT, "worlds", "paper_route.csv"), world.start)
        reference = read_trajectory(os.path.join(ROOT, "bags", "paper.tum"))
        self.assertEqual(reference.stamps.tolist(), [frame.stamp for frame in frames])
        np.testing.assert_allclose(reference.positions[:, :2], [(f.x, f.y) for f in frames])
        path = os.path.join(ROOT, "bags", "paper.bag")
        self.assertLess(os.path.getsize(path), 8e6)
        with rosbag.Bag(path) as bag:
            images = [message for _, message, _ in bag.read_messages("/camera/image/compressed")]
        self.assertEqual([image.header.stamp.to_nsec() for image in images],
                         reference.stamps.tolist())
        self.assertEqual({image.header.frame_id for image in images}, {world.mounting.frame_id})

    def test_disc_is_under_400_pixels(self):
        camera = load_camera(os.path.join(ROOT, "config", "cameras", "paper.yaml"))
        mirror = camera.mirror
        slope = mirror.rim_radius / (mirror.apex_distance + mirror.sag(mirror.rim_radius))
        self.assertLess(2.0 * camera.lens.fx * slope, 400.0)


if __name__ == "__main__":
    unittest.main()
