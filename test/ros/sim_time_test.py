#!/usr/bin/env python3
"""The localizer on the clock of a bag: before it runs, while it does, and when it is set back."""

import copy
import sys
import time
import unittest

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticStatus
from harness import Diagnostics, Harness, LogTopic, is_connected, odometry, wait_until
from omnitag.msg import LocalizationStatus
from rosgraph_msgs.msg import Clock, Log

TOLERANCE = rospy.Duration(0.1)  # the default of transform_tolerance


class SimTimeTest(unittest.TestCase):
    """The tests run in the order of their names, each starting where the last one left the clock."""

    @classmethod
    def setUpClass(cls):
        cls.harness = Harness("raw")
        cls.diagnostics = Diagnostics()
        cls.log = LogTopic()
        cls.clock = rospy.Publisher("/clock", Clock, queue_size=100)
        assert wait_until(lambda: is_connected(cls.clock, cls.diagnostics.subscriber,
                                               cls.log.subscriber))

    def localize(self, index):
        """Sends an image of the bag, after its odometry; returns the status."""
        image = self.harness.images[index]
        stamp = image.header.stamp
        self.harness.publish_transform(odometry(stamp, self.harness.truth[stamp]))
        status = self.harness.localize(image)
        self.assertIsNotNone(status)
        self.assertTrue(status.has_pose)
        return status

    def stamps(self, start):
        """Stamps of the map -> odom transforms after the first `start` ones."""
        return [transform.header.stamp
                for transform in self.harness.published_transforms()[start:]]

    def expect_correction(self, index, start=0):
        """Expects map -> odom for an image, now or soon, after the first `start` ones."""
        stamp = self.harness.images[index].header.stamp + TOLERANCE
        self.assertTrue(wait_until(lambda: stamp in self.stamps(start)))

    def test_1_localizes_before_the_first_clock(self):
        self.assertTrue(rospy.Time.now().is_zero())
        self.diagnostics.wait_for_report(": images", DiagnosticStatus.ERROR,
                                         "waiting for the first image")
        for index in range(3):
            self.localize(index)
            self.expect_correction(index)
        self.diagnostics.wait_for_report(": localization", DiagnosticStatus.OK, "tracking")

    def set_clock(self, now):
        """Sets the clock and waits until the localizer has it."""
        self.clock.publish(now)
        self.assertIsNotNone(self.diagnostics.wait_for(
            lambda message: message.header.stamp == now and
            any("localizer" in status.name for status in message.status)))

    def test_2_no_transform_jumps_when_the_clock_starts(self):
        images = self.harness.images
        self.set_clock(images[8].header.stamp)
        self.assertEqual(max(self.stamps(0)), images[2].header.stamp + TOLERANCE)
        self.localize(8)
        self.expect_correction(8)

    def test_3_the_transform_goes_on_with_the_clock(self):
        last = self.harness.images[8].header.stamp + TOLERANCE
        start = len(self.harness.published_transforms())
        later = rospy.Duration(1.0)
        self.set_clock(self.harness.images[8].header.stamp + later)
        self.assertTrue(wait_until(lambda: last + later in self.stamps(start)))
        self.assertEqual(max(self.stamps(start)), last + later)

    def test_4_starts_anew_when_the_bag_does(self):
        start = len(self.log.messages)
        before = len(self.harness.published_transforms())
        # Transforms from before the clock was set back must not hide those that come after.
        last = self.harness.images[8].header.stamp
        self.harness.publish_transform(
            odometry(last + rospy.Duration(100.0), self.harness.truth[last]))
        self.set_clock(self.harness.images[0].header.stamp)
        # Another one was still on its way.
        self.harness.publish_transform(
            odometry(last + rospy.Duration(100.0), self.harness.truth[last]))
        for topic in (self.harness.status, self.harness.poses):
            topic.messages.clear()
        self.assertEqual(self.localize(0).mode, LocalizationStatus.FOUND)
        self.expect_correction(0, before)
        self.assertTrue(self.log.wait_for_line(
            Log.WARN, "simulated time and the images' stamps went back", start))
        self.assertEqual(self.localize(1).mode, LocalizationStatus.TRACKING)
        pose = self.harness.poses.at(self.harness.images[1].header.stamp)
        distance, angle = self.harness.errors(pose)
        self.assertLess(distance, 0.02)
        self.assertLess(angle, 0.01)

    def test_5_survives_a_transform_that_time_has_no_stamp_for(self):
        # A camera whose clock is shortly before the last second of ros::Time, ...
        last = rospy.Time(4294967295)
        # tf forgets what is more than 68 years older: it could not interpolate from there.
        self.set_clock(rospy.Time(500))
        time.sleep(1.5)  # for a second, stamps ahead of the clock count as from before its step
        image = copy.deepcopy(self.harness.images[2])
        pose = self.harness.truth[image.header.stamp]
        image.header.stamp = last - rospy.Duration(100.0)
        self.harness.publish_transform(odometry(image.header.stamp, pose))
        self.assertTrue(self.harness.localize(image).has_pose)
        # ... a transform that tf has no room for, and a correction that would be repeated after
        # that second.
        self.harness.publish_transform(odometry(last, pose))
        self.set_clock(rospy.Time.now() + rospy.Duration(200.0))

        self.harness.status.messages.clear()
        self.set_clock(self.harness.images[0].header.stamp)
        self.localize(0)

    def test_6_a_bag_that_is_paused_is_no_fault(self):
        start = len(self.log.messages)
        self.diagnostics.wait_for_report(": images", DiagnosticStatus.WARN, "bag is paused")
        self.assertFalse([line.msg for line in self.log.messages[start:]
                          if "waiting for images" in line.msg])
        self.localize(1)
        self.diagnostics.wait_for_report(": images", DiagnosticStatus.OK, "images are coming")
        # Once the clock continues, images are missing.
        self.set_clock(self.harness.images[1].header.stamp + rospy.Duration(10.0))
        self.diagnostics.wait_for_report(": images", DiagnosticStatus.ERROR, "waiting for images")


if __name__ == "__main__":
    rospy.init_node("sim_time_test")
    rostest.rosrun("omnitag", "sim_time", SimTimeTest, sys.argv)
