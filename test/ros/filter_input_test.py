#!/usr/bin/env python3
"""What a filter beside the localizer gets: measured poses and no transform; and settings that are
tuned while the robot drives."""

import sys
import unittest

import dynamic_reconfigure.client
import numpy as np
import rospy
import rostest
from geometry_msgs.msg import PoseWithCovarianceStamped
from harness import Harness, Topic, angle_between, odometry, yaw_of
from odometry_test import black_image
from omnitag.msg import LocalizationStatus

PLANAR = [0, 1, 5]


class FilterInputTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.measured = Topic("pose_measured", PoseWithCovarianceStamped)
        cls.harness = Harness("compressed")

    def localize(self, image, truth_of=None):
        """Sends an image with its odometry."""
        truth = self.harness.truth[truth_of or image.header.stamp]
        self.harness.publish_transform(odometry(image.header.stamp, truth))
        status = self.harness.localize(image)
        self.assertIsNotNone(status)
        return status

    def error(self, message):
        """Error of (x, y, yaw)."""
        x, y, yaw = self.harness.truth[message.header.stamp]
        position = message.pose.pose.position
        turn = (yaw_of(message.pose.pose.orientation) - yaw + np.pi) % (2 * np.pi) - np.pi
        return np.array([position.x - x, position.y - y, turn])

    def test_1_measured_poses_without_a_transform(self):
        nees = []
        for image in self.harness.images[:20]:
            self.localize(image)
            message = self.measured.at(image.header.stamp)
            self.assertIsNotNone(message)
            self.assertEqual(message.header.frame_id, "map")
            covariance = np.reshape(message.pose.covariance, (6, 6))[np.ix_(PLANAR, PLANAR)]
            error = self.error(message)
            self.assertLess(np.linalg.norm(error[:2]), 0.01)
            nees.append(error @ np.linalg.solve(covariance, error))
        # The shipped map says 5 mm, but is exact.
        self.assertLess(np.mean(nees), 5.0)
        self.assertEqual(self.harness.published_transforms(), [])

    def test_2_nothing_is_measured_in_the_dark(self):
        last = self.harness.images[19]
        for i in range(1, 5):
            image = black_image(last, last.header.stamp + rospy.Duration(0.01 * i))
            status = self.localize(image, last.header.stamp)
            self.assertEqual(status.mode, LocalizationStatus.DEAD_RECKONING)
            self.assertIsNotNone(self.harness.poses.at(image.header.stamp))
            self.assertNotIn(image.header.stamp,
                             [message.header.stamp for message in self.measured.messages])

    def test_3_settings_change_and_the_pose_stays(self):
        client = dynamic_reconfigure.client.Client("/localizer/reconfigure", timeout=30)
        self.assertEqual(client.get_configuration()["estimator"], "photometric")
        descriptions = {each["name"]: each for each in client.get_parameter_descriptions()}
        self.assertEqual(descriptions["threads"]["max"], 64)
        for i, change in enumerate([{"estimator": "reprojection"}, {"threads": 2},
                                    {"estimator": "photometric", "floor_lean_deviation": 0.02},
                                    {"attention_period": 1.0, "max_misfit": 6.0}]):
            answer = client.update_configuration(change)
            for name, value in change.items():
                self.assertEqual(answer[name], value)
            image = self.harness.images[20 + i]
            status = self.localize(image)
            self.assertEqual(status.mode, LocalizationStatus.TRACKING)
        # A value out of range is set to the limit.
        self.assertEqual(client.update_configuration({"threads": 1000})["threads"], 64)
        client.update_configuration({"threads": 1})
        distance, angle = self.harness.errors(
            self.harness.poses.at(self.harness.images[23].header.stamp))
        self.assertLess(distance, 0.01)
        self.assertLess(angle, 0.01)

        client.update_configuration({"enabled": False})
        self.harness.publish(self.harness.images[24])
        rospy.sleep(1.0)
        self.assertNotIn(self.harness.images[24].header.stamp,
                         [message.header.stamp for message in self.harness.status.messages])
        client.update_configuration({"enabled": True})
        status = self.localize(self.harness.images[25])
        self.assertEqual(status.mode, LocalizationStatus.TRACKING)
        x, y, yaw = self.harness.truth[self.harness.images[25].header.stamp]
        pose = self.harness.poses.at(self.harness.images[25].header.stamp).pose
        self.assertAlmostEqual(pose.position.x, x, delta=0.01)
        self.assertAlmostEqual(pose.position.y, y, delta=0.01)
        self.assertLess(angle_between(yaw_of(pose.orientation), yaw), 0.01)


if __name__ == "__main__":
    rospy.init_node("filter_input_test")
    rostest.rosrun("omnitag", "filter_input", FilterInputTest, sys.argv)
