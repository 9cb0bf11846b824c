#!/usr/bin/env python3
"""The localizer without an odometry frame, on a robot whose tf has another parent of base_link."""

import sys
import unittest

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import TransformStamped
from harness import Diagnostics, Harness, LogTopic, is_connected, odometry, wait_until
from rosgraph_msgs.msg import Log


class OtherParentTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.harness = Harness("compressed")
        cls.diagnostics = Diagnostics()
        cls.log = LogTopic()
        assert wait_until(lambda: is_connected(cls.diagnostics.subscriber, cls.log.subscriber))

    def localize(self, index):
        """Whether the robot's transform is sent with the image's pose; there must be a pose."""
        image = self.harness.images[index]
        status = self.harness.localize(image)
        self.assertIsNotNone(status)
        self.assertTrue(status.has_pose)
        self.assertIsNotNone(self.harness.poses.at(image.header.stamp))
        return wait_until(lambda: any(
            transform.header.stamp == image.header.stamp and transform.child_frame_id == "base_link"
            for transform in self.harness.published_transforms()), 1.0)

    def test_stops_sending_tf_alone_and_says_why(self):
        for index in range(2):
            self.assertTrue(self.localize(index), index)

        # A recording of the localizer's own transform is not another parent.
        recorded = TransformStamped()
        recorded.header.frame_id, recorded.child_frame_id = "map", "base_link"
        recorded.header.stamp = self.harness.images[1].header.stamp - rospy.Duration(100.0)
        recorded.transform.rotation.w = 1.0
        self.harness.publish_transform(recorded)
        self.assertTrue(self.localize(2))

        start = len(self.log.messages)
        following = iter(range(3, len(self.harness.images)))

        def is_sent():
            index = next(following)
            stamp = self.harness.images[index].header.stamp
            self.harness.publish_transform(odometry(stamp, self.harness.truth[stamp]))
            return self.localize(index)

        # It comes over a separate connection, maybe after the image.
        self.assertTrue(wait_until(lambda: not is_sent()))
        self.assertTrue(self.log.wait_for_line(
            Log.ERROR, "tf has 'odom' as the parent of 'base_link'", start))
        self.diagnostics.wait_for_report(": transforms", DiagnosticStatus.ERROR, "odom_frame")
        self.assertFalse(is_sent())


if __name__ == "__main__":
    rospy.init_node("other_parent_test")
    rostest.rosrun("omnitag", "other_parent", OtherParentTest, sys.argv)
