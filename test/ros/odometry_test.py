#!/usr/bin/env python3
"""The localizer with an odometry frame: map -> odom, and never under a false name."""

import sys
import unittest

import rospy
import rostest
from harness import ODOM_X, ODOM_Y, ODOM_YAW, Harness, odometry, wait_until, yaw_of

TOLERANCE = 0.1  # s, the default of transform_tolerance
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

        # They come over a connection of their own, in their order.
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

        # Without further images it goes on, in the images' time.
        self.assertTrue(wait_until(lambda: any(
            last + rospy.Duration(0.2) < transform.header.stamp < last + rospy.Duration(20.0)
            for transform in harness.published_transforms())))
        # No more often than asked: its own transforms come back to the localizer, too. (Those that
        # came before the last image's do not count, however long that one took to come.)
        sent = [transform.header.stamp for transform in harness.published_transforms()]
        repeated = sent[sent.index(last) + 1:]
        for earlier, later in zip(repeated, repeated[1:]):
            self.assertGreater((later - earlier).to_sec(), PERIOD - 1e-6)


if __name__ == "__main__":
    rospy.init_node("odometry_test")
    rostest.rosrun("omnitag", "odometry", OdometryTest, sys.argv)
