#!/usr/bin/env python3
"""The localizer with an odometry frame: map -> odom, and never under another name."""

import copy
import sys
import unittest

import cv2
import numpy as np
import rospy
import rostest
from geometry_msgs.msg import PoseWithCovarianceStamped
from harness import (ODOM_X, ODOM_Y, ODOM_YAW, Harness, LogTopic, is_connected, odometry,
                     wait_until, yaw_of)
from omnitag.msg import LocalizationStatus
from rosgraph_msgs.msg import Log

TOLERANCE = 0.1  # s, the default of transform_tolerance
BESIDE = 0.3  # m
PERIOD = 0.05  # s, the default of transform_period


class OdometryTest(unittest.TestCase):
    def test_map_to_odom(self):
        harness = Harness("compressed")
        without = set(range(20, 23))
        for i, image in enumerate(harness.images[:40]):
            stamp = image.header.stamp
            if i not in without:
                harness.publish_transform(odometry(stamp, harness.truth[stamp]))
            status = harness.localize(image)
            self.assertIsNotNone(status)
            self.assertTrue(status.has_pose)

        # They come over a separate connection, in their order.
        last = harness.images[39].header.stamp + rospy.Duration(TOLERANCE)
        self.assertTrue(wait_until(lambda: any(
            transform.header.stamp == last for transform in harness.published_transforms())))
        by_stamp = {transform.header.stamp: transform
                    for transform in harness.published_transforms()}
        for i, image in enumerate(harness.images[:40]):
            stamp = image.header.stamp + rospy.Duration(TOLERANCE)
            self.assertEqual(stamp in by_stamp, i not in without, i)
            if i in without:
                continue
            transform = by_stamp[stamp]
            self.assertEqual(transform.child_frame_id, "odom")
            self.assertAlmostEqual(transform.transform.translation.x, ODOM_X, delta=0.05)
            self.assertAlmostEqual(transform.transform.translation.y, ODOM_Y, delta=0.05)
            self.assertAlmostEqual(yaw_of(transform.transform.rotation), ODOM_YAW, delta=0.01)
        self.assertEqual({transform.child_frame_id
                          for transform in harness.published_transforms()}, {"odom"})

        # Without further images, it continues in the images' time.
        self.assertTrue(wait_until(lambda: any(
            last + rospy.Duration(0.2) < transform.header.stamp < last + rospy.Duration(20.0)
            for transform in harness.published_transforms())))
        # No more often than configured, although its own transforms come back to the localizer.
        # (Those before the last image's do not count, however long that one took to come.)
        sent = [transform.header.stamp for transform in harness.published_transforms()]
        repeated = sent[sent.index(last) + 1:]
        for earlier, later in zip(repeated, repeated[1:]):
            self.assertGreater((later - earlier).to_sec(), PERIOD - 1e-6)

        self.point_at_where_the_robot_was(harness)

    def point_at_where_the_robot_was(self, harness):
        """RViz's "2D Pose Estimate", stamped some images ago and with no marker in view since."""
        log = LogTopic()
        publisher = rospy.Publisher("initialpose", PoseWithCovarianceStamped, queue_size=1)
        self.assertTrue(wait_until(lambda: is_connected(publisher, log.subscriber)))
        then, now = harness.images[40].header.stamp, harness.images[46].header.stamp
        for image in harness.images[40:47]:
            stamp = image.header.stamp
            harness.publish_transform(odometry(stamp, harness.truth[stamp]))
        message = PoseWithCovarianceStamped()
        message.header.stamp, message.header.frame_id = then, "map"
        # A little beside where it was, so that the effect can be told from tracking.
        x, y, yaw = harness.truth[then]
        x += BESIDE
        message.pose.pose.position.x, message.pose.pose.position.y = x, y
        message.pose.pose.orientation.z = np.sin(yaw / 2)
        message.pose.pose.orientation.w = np.cos(yaw / 2)
        message.pose.covariance[0] = message.pose.covariance[7] = 0.25
        message.pose.covariance[35] = (np.pi / 12) ** 2
        start = len(log.messages)
        publisher.publish(message)
        self.assertTrue(log.wait_for_line(Log.INFO, "initial pose", start))

        for i in range(20):
            blind = black_image(harness.images[46], now + rospy.Duration(0.1 * i))
            harness.publish_transform(odometry(blind.header.stamp, harness.truth[now]))
            status = harness.localize(blind)
            self.assertEqual(status.mode, LocalizationStatus.DEAD_RECKONING, i)
            pose = harness.poses.at(blind.header.stamp)
            self.assertAlmostEqual(pose.pose.position.x, harness.truth[now][0] + BESIDE,
                                   delta=0.01)
            self.assertAlmostEqual(pose.pose.position.y, harness.truth[now][1], delta=0.01)


def black_image(image, stamp):
    """An image of the same camera that shows nothing."""
    _, data = cv2.imencode(".png", np.zeros((500, 500), np.uint8))
    black = copy.deepcopy(image)
    black.header.stamp = stamp
    black.format = "png"
    black.data = data.tobytes()
    return black


if __name__ == "__main__":
    rospy.init_node("odometry_test")
    rostest.rosrun("omnitag", "odometry", OdometryTest, sys.argv)
