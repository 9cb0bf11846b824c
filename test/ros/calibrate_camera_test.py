"""calibrate_camera: its results from a bag, and what it says about useless recordings."""

import os
import re
import subprocess
import sys
import tempfile
import unittest

import numpy as np
import rosbag
import rospy
import yaml
from tf2_msgs.msg import TFMessage

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from harness import BAG, PACKAGE, odometry, read_truth  # noqa: E402

MAP = os.path.join(PACKAGE, "maps", "paper.yaml")
GUESS = """
model: catadioptric
image: {width: 500, height: 500}
uncertainty: none
lens: {fx: 1090.0, fy: 1090.0, cx: 255.0, cy: 244.0}
mirror: {profile: spherical, radius_of_curvature: 0.04, apex_distance: 0.21, rim_radius: 0.0375}
"""
# Leans by 5 degrees relative to the bag's transform, which is true.
LEANING = "0.1,0.02,1.1,-3.08,0.06,0.5236"


class CalibrateCameraTest(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.directory = directory.name
        self.guess = self.path("guess.yaml")
        self.write(self.guess, GUESS)

    def path(self, name):
        return os.path.join(self.directory, name)

    @staticmethod
    def write(path, text):
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)

    def run_tool(self, *arguments, **options):
        values = {"camera": self.guess, "map": MAP, "bag": BAG, "output": self.path("out.yaml")}
        values.update(options)
        command = ["rosrun", "omnitag", "calibrate_camera", *arguments]
        for name, value in values.items():
            command += ["--" + name, value]
        return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              universal_newlines=True, timeout=300, check=False)

    def assert_refused(self, *parts, **options):
        """Expects status 1, nothing on standard output, a last line with these parts, and no file."""
        result = self.run_tool(**options)
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertEqual(result.stdout, "")
        last = result.stderr.splitlines()[-1]
        for part in ("calibrate_camera: ",) + parts:
            self.assertIn(part, last)
        self.assertFalse(os.path.exists(self.path("out.yaml")))
        self.assertFalse(os.path.exists(self.path("out_residuals.png")))

    def test_recovers_the_paper_camera(self):
        result = self.run_tool("--fix", "apex_distance", mounting=LEANING, images="40")
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(self.path("out.yaml"), encoding="utf-8") as file:
            text = file.read()
        camera = yaml.safe_load(text)
        self.assertAlmostEqual(camera["lens"]["fx"], 1195.0, delta=1.0)
        self.assertAlmostEqual(camera["lens"]["fy"], 1195.0, delta=1.0)
        self.assertAlmostEqual(camera["lens"]["cx"], 249.5, delta=0.1)
        self.assertAlmostEqual(camera["lens"]["cy"], 249.5, delta=0.1)
        self.assertEqual(camera["mirror"]["apex_distance"], 0.21)
        self.assertIn("static_transform_publisher", text)
        for part in ("standard deviation", "residual before", "residual after", "held: as told"):
            self.assertIn(part, result.stdout)
        x, y, z, roll, pitch, yaw = map(
            float, re.search(r"--mounting (\S+)", result.stdout).group(1).split(","))
        self.assertEqual((x, y, yaw), (0.1, 0.02, 0.5236))
        self.assertAlmostEqual(z, 1.1, delta=0.003)
        self.assertAlmostEqual(abs(roll), 3.14159, delta=0.001)
        self.assertAlmostEqual(pitch, 0.0, delta=0.001)
        with open(self.path("out_residuals.png"), "rb") as file:
            self.assertEqual(file.read(8), b"\x89PNG\r\n\x1a\n")
        self.assertIn("with the guess", result.stderr)
        self.assertIn("calibrating:", result.stderr)

        # localize_bag accepts what it writes.
        localized = subprocess.run(
            ["rosrun", "omnitag", "localize_bag", "--camera", self.path("out.yaml"), "--map", MAP,
             "--bag", BAG, "--trajectory", self.path("out.tum"), "--mounting",
             f"{x},{y},{z},{roll},{pitch},{yaw}"],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=300, check=False)
        self.assertEqual(localized.returncode, 0, localized.stderr)
        evaluated = subprocess.run(
            ["rosrun", "omnitag", "evaluate_trajectory", "--estimate", self.path("out.tum"),
             "--reference", BAG.replace(".bag", ".tum"), "--json"],
            stdout=subprocess.PIPE, universal_newlines=True, timeout=100, check=False)
        self.assertLess(yaml.safe_load(evaluated.stdout)["position_rmse"], 0.001)

    def write_bag_with_odometry(self, path, late):
        """The shipped bag with odometry that puts the robot where it was this many seconds before: its
        images are late by that much."""
        truth = read_truth()
        stamps = np.array([stamp.to_sec() for stamp in truth])
        x, y, yaw = np.array(list(truth.values())).T
        yaw = np.unwrap(yaw)
        with rosbag.Bag(path, "w") as bag:
            for topic, message, time in rosbag.Bag(BAG).read_messages():
                bag.write(topic, message, time)
            for time in np.arange(stamps[0], stamps[-1], 0.025):
                pose = tuple(np.interp(time, stamps, values) for values in (x, y, yaw))
                stamp = rospy.Time.from_sec(time + late)
                bag.write("/tf", TFMessage([odometry(stamp, pose)]), stamp)

    def test_estimates_how_late_images_are(self):
        bag = self.path("late.bag")
        params = self.path("params.yaml")
        self.write_bag_with_odometry(bag, 0.020)
        self.write(params, "base_frame: base_link  # ours\nimage_time_offset: 0.5 # a guess")
        result = self.run_tool("--odom-frame", "odom", "--output-params", params, bag=bag)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertRegex(result.stdout, r"row_readout_time.*held: as of a global shutter")
        with open(params, encoding="utf-8") as file:
            text = file.read()
        self.assertTrue(text.startswith("base_frame: base_link  # ours\nimage_time_offset: "), text)
        self.assertIn(" # a guess\n", text)
        found = yaml.safe_load(text)
        self.assertAlmostEqual(found["image_time_offset"], 0.020, delta=0.001)
        self.assertEqual(found["row_readout_time"], 0.0)
        # localize_bag accepts what it writes.
        localized = subprocess.run(
            ["rosrun", "omnitag", "localize_bag", "--camera", self.path("out.yaml"), "--map", MAP,
             "--bag", bag, "--odom-frame", "odom", "--params", params,
             "--trajectory", self.path("out.tum")],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=300, check=False)
        self.assertEqual(localized.returncode, 0, localized.stderr)

    def test_refuses_what_tells_no_times(self):
        self.assert_refused("paper.bag: --odom-frame", "'odom'", **{"odom-frame": "odom"})
        params = self.path("params.yaml")
        self.assert_refused("--output-params: needs --odom-frame", **{"output-params": params})
        bag = self.path("late.bag")
        self.write_bag_with_odometry(bag, 0.0)
        for text, part in (("{base_frame: base_link}", "a line of its own"),
                           ("time_offset: 0.1", "time_offset"), ("a: [", "cannot put")):
            self.write(params, text)
            self.assert_refused("params.yaml", part, bag=bag,
                                **{"odom-frame": "odom", "output-params": params})
            with open(params, encoding="utf-8") as file:
                self.assertEqual(file.read(), text)

    def test_refuses_too_few_images(self):
        self.assert_refused("5 images of 5", "drive longer", images="5")

    def test_refuses_another_map(self):
        with open(MAP, encoding="utf-8") as file:
            other = re.sub(r"id: (\d+)", lambda match: f"id: {int(match.group(1)) + 200}",
                           file.read())
        self.write(self.path("map.yaml"), other)
        self.assert_refused("is in the map", map=self.path("map.yaml"), images="10")

    def test_refuses_a_robot_that_stands(self):
        with rosbag.Bag(BAG) as bag:
            messages = list(bag.read_messages())
        image = next(m for m in messages if "image" in m.topic)
        with rosbag.Bag(self.path("still.bag"), "w") as bag:
            for topic, message, time in messages:
                if "image" in topic:
                    message.data = image.message.data
                bag.write(topic, message, time)
        self.assert_refused("the robot moved by", bag=self.path("still.bag"), images="15")

    def test_refuses_a_camera_that_is_not_calibrated(self):
        self.write(self.guess, "model: equirectangular\nimage: {width: 200, height: 100}\n")
        self.assert_refused("guess.yaml:1: model", "catadioptric, equidistant, unified, pinhole")

    def test_refuses_bad_options(self):
        self.assert_refused("--mounting", "X,Y,Z,ROLL,PITCH,YAW", mounting="1,2,3")
        self.assert_refused("'focus'", "apex_distance", fix="focus", images="15")
        self.assert_refused("--output", "is an input", output=self.guess)


if __name__ == "__main__":
    unittest.main()
