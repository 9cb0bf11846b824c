#!/usr/bin/env python3
"""The node starts where it stopped, and says so if it cannot."""

import os
import subprocess
import sys
import tempfile
import unittest

import rospy
import rostest
import yaml
from harness import IMAGE_TOPIC, PACKAGE, Harness, wait_until
from odometry_test import black_image
from omnitag.msg import LocalizationStatus
from std_srvs.srv import Empty

CAMERA = os.path.join(PACKAGE, "config", "cameras", "paper.yaml")
MAP = os.path.join(PACKAGE, "maps", "paper.yaml")


class SavedPoseTest(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.pose_file = os.path.join(directory.name, "pose.yaml")
        self.output = tempfile.NamedTemporaryFile()
        self.addCleanup(self.output.close)
        for name, value in {"camera_file": CAMERA, "map_file": MAP, "queue_size": 100,
                            "image_transport": "compressed", "pose_file": self.pose_file,
                            "save_pose_period": 0.2}.items():
            rospy.set_param("/localizer/" + name, value)

    def start(self):
        """Starts the node; returns what it publishes."""
        self.node = subprocess.Popen(["rosrun", "omnitag", "localizer_node", "__name:=localizer",
                                      "image:=" + IMAGE_TOPIC], stderr=self.output)
        self.addCleanup(self.stop)
        rospy.wait_for_service("global_localization", 30.0)
        return Harness("compressed")

    def stop(self):
        """Stops the node and waits until it has ended."""
        self.node.terminate()
        self.node.wait()

    def said(self, part):
        """Whether the node printed it. A line of its start may be too early for /rosout."""
        with open(self.output.name, encoding="utf-8") as file:
            return part in file.read()

    def test_starts_where_it_stopped(self):
        rospy.set_param("/localizer/initial_pose", [-1.4439, 2.9956, -2.1440])
        harness = self.start()
        for image in harness.images[:4]:
            self.assertTrue(harness.localize(image).has_pose)
        x, y, _ = harness.truth[harness.images[3].header.stamp]

        def is_saved():
            if not os.path.exists(self.pose_file):
                return False
            with open(self.pose_file, encoding="utf-8") as file:
                pose = yaml.safe_load(file)["pose"]
            return abs(pose[0] - x) < 0.01 and abs(pose[1] - y) < 0.01

        self.assertTrue(wait_until(is_saved))
        self.stop()
        self.assertEqual(os.listdir(os.path.dirname(self.pose_file)), ["pose.yaml"])

        # Without a marker in sight, it is where it was: a hypothesis, less certain than before.
        rospy.delete_param("/localizer/initial_pose")
        harness = self.start()
        dark = black_image(harness.images[4], harness.images[4].header.stamp)
        status = harness.localize(dark)
        self.assertEqual(status.mode, LocalizationStatus.DEAD_RECKONING)
        message = harness.covariances.at(dark.header.stamp)
        self.assertAlmostEqual(message.pose.pose.position.x, x, delta=0.01)
        self.assertGreater(message.pose.covariance[0], 0.1 ** 2)
        # A pose that no marker showed is not saved.
        before = os.stat(self.pose_file).st_mtime_ns
        rospy.sleep(0.6)
        self.assertEqual(os.stat(self.pose_file).st_mtime_ns, before)
        status = harness.localize(harness.images[5])
        self.assertEqual(status.mode, LocalizationStatus.TRACKING)
        rospy.ServiceProxy("global_localization", Empty)()
        self.stop()

    def test_searches_where_the_file_is_wrong(self):
        with open(self.pose_file, "w", encoding="utf-8") as file:
            file.write("frame_id: map\nstamp: 1\npose: [1, 2]\ncovariance: []\n")
        harness = self.start()
        self.assertTrue(wait_until(lambda: self.said("pose.yaml:3: pose")))
        dark = black_image(harness.images[0], harness.images[0].header.stamp)
        self.assertEqual(harness.localize(dark).mode, LocalizationStatus.SEARCHING)
        self.stop()


if __name__ == "__main__":
    rospy.init_node("saved_pose_test")
    rostest.rosrun("omnitag", "saved_pose", SavedPoseTest, sys.argv)
