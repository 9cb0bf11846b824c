#!/usr/bin/env python3
"""Faults that the nodelet must survive: after each, the very next good image gives a right pose."""

import copy
import sys
import time
import unittest
from xmlrpc.client import ServerProxy

import cv2
import numpy as np
import rosgraph
import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticStatus, KeyValue
from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped, TransformStamped
from harness import (Diagnostics, Harness, LogTopic, Topic, angle_between, is_connected, raw_image,
                     wait_until, yaw_of)
from omnitag.msg import LocalizationStatus
from rosgraph_msgs.msg import Log
from sensor_msgs.msg import Image

HALF_PERIOD = rospy.Duration(0.125)  # half the time between two images of the bag
MOST_IMAGES = 20  # of the bag, that a test takes


def with_pixels(image, encoding, pixels, padding=0):
    """The image's header over other pixels; `padding` bytes of rubbish end each row."""
    rows = np.ascontiguousarray(pixels).view(np.uint8).reshape(pixels.shape[0], -1)
    rows = np.hstack([rows, np.full((rows.shape[0], padding), 0xa5, np.uint8)])
    return Image(header=image.header, height=pixels.shape[0], width=pixels.shape[1],
                 encoding=encoding, step=rows.shape[1], data=rows.tobytes())


class FaultsTest(unittest.TestCase):
    """The tests run in the order of their names and share one robot that keeps driving: each takes the
    next images of the bag, and starts with a localizer that knows its pose."""

    @classmethod
    def setUpClass(cls):
        cls.harness = Harness("raw")
        cls.diagnostics = Diagnostics()
        cls.log = LogTopic()
        cls.initial_pose = rospy.Publisher("initialpose", PoseWithCovarianceStamped, queue_size=1)
        assert wait_until(lambda: is_connected(cls.initial_pose, cls.diagnostics.subscriber,
                                               cls.log.subscriber))
        cls.manager = ServerProxy(rosgraph.Master("/faults").lookupNode("/manager"))
        cls.pid = cls.manager.getPid("/faults")[2]
        cls.index = 0
        cls.later = rospy.Duration(0)

    def setUp(self):
        # After the last image, the first ones come again, later and elsewhere.
        if self.index + MOST_IMAGES > len(self.harness.images):
            type(self).later = self.later + 2 * HALF_PERIOD * len(self.harness.images)
            type(self).index = 0
        self.expect_right_pose(self.next_image())

    def tearDown(self):
        self.assertEqual(self.manager.getPid("/faults")[2], self.pid, "the manager was restarted")

    def next_image(self):
        """The next image of the bag, decoded."""
        type(self).index = self.index + 1
        return self.image_of_bag(self.index - 1, self.later)

    def between_images(self):
        """The last image again, half a period later."""
        return self.image_of_bag(self.index - 1, self.later + HALF_PERIOD)

    def image_of_bag(self, index, later=rospy.Duration(0)):
        """An image of the bag, decoded, its stamp shifted."""
        image = raw_image(copy.deepcopy(self.harness.images[index]))
        image.header.stamp += later
        return image

    @staticmethod
    def pixels(image):
        """Grey levels of a mono8 image."""
        return np.frombuffer(image.data, np.uint8).reshape(image.height, image.width)

    def localize(self, image):
        """Sends an image; returns the status and, if there is one, the pose."""
        self.harness.publish_any(image)
        status = self.harness.status.at(image.header.stamp)
        self.assertIsNotNone(status, "not localized")
        pose = self.harness.poses.at(image.header.stamp) if status.has_pose else None
        return status, pose

    def errors(self, pose, index):
        """m and rad: errors relative to the true pose at an image of the bag."""
        x, y, yaw = self.harness.truth[self.harness.images[index].header.stamp]
        return (np.hypot(pose.pose.position.x - x, pose.pose.position.y - y),
                angle_between(yaw_of(pose.pose.orientation), yaw))

    def expect_right_pose(self, image):
        """Expects a right pose from the image, which shows the last place that `next_image` gave."""
        status, pose = self.localize(image)
        self.assertTrue(status.has_pose)
        self.assertGreaterEqual(status.markers_used, 2)
        distance, angle = self.errors(pose, self.index - 1)
        self.assertLess(distance, 0.02)
        self.assertLess(angle, np.radians(0.3))
        return status

    def expect_tracking(self):
        """Expects the next good image to be localized as if nothing had happened."""
        status = self.expect_right_pose(self.next_image())
        self.assertEqual(status.mode, LocalizationStatus.TRACKING)

    def expect_no_pose_at(self, stamp):
        """Expects that nothing was published with that stamp, now that later results are there."""
        for topic in (self.harness.poses, self.harness.status):
            self.assertIsNone(topic.at(stamp, timeout=0.0))

    def wait_for_diagnostics(self, task, level, *parts):
        """Waits until a task of the first localizer newly reports a line with these parts."""
        self.diagnostics.wait_for_report("first/localizer: " + task, level, *parts)

    def second(self):
        """The camera of the second localizer, and the topics of its poses and status."""
        camera = rospy.Publisher("/second_camera/image", Image, queue_size=100)
        poses = Topic("/second/pose", PoseStamped)
        status = Topic("/second/status", LocalizationStatus)
        self.assertTrue(wait_until(
            lambda: is_connected(camera, poses.subscriber, status.subscriber)))
        return camera, poses, status

    def test_01_images_without_a_marker(self):
        noise = np.random.RandomState(1).randint(0, 256, (500, 500)).astype(np.uint8)
        for pixels in (np.zeros((500, 500), np.uint8), np.full((500, 500), 255, np.uint8), noise):
            status, pose = self.localize(with_pixels(self.between_images(), "mono8", pixels))
            self.assertEqual(status.markers_used, 0)
            self.assertIn(status.mode, (LocalizationStatus.DEAD_RECKONING,
                                        LocalizationStatus.SEARCHING))
            if pose:  # carried on for an eighth of a second
                self.assertLess(self.errors(pose, self.index - 1)[0], 0.3)
            self.expect_tracking()

    def test_02_torn_images(self):
        elsewhere = self.pixels(self.image_of_bag(-1))
        for lower in (np.zeros((250, 500), np.uint8), elsewhere[250:]):
            image = self.next_image()
            torn = np.vstack([self.pixels(image)[:250], lower])
            status, pose = self.localize(with_pixels(image, "mono8", torn))
            if status.markers_used:
                self.assertLess(self.errors(pose, self.index - 1)[0], 0.03)
            self.expect_tracking()

    def test_03_images_of_another_size(self):
        for height, width in ((400, 500), (500, 640), (1000, 1000), (1, 1)):
            image = with_pixels(self.between_images(), "mono8",
                                np.full((height, width), 80, np.uint8))
            self.harness.publish_any(image)
            self.expect_tracking()
            self.expect_no_pose_at(image.header.stamp)

    def test_04_messages_that_contradict_themselves(self):
        short = self.between_images()
        short.data = short.data[:1000]
        empty = self.between_images()
        empty.height = empty.width = empty.step = 0
        empty.data = b""
        narrow = self.between_images()
        narrow.step = 100
        unknown = self.between_images()
        unknown.encoding = "rgb565"
        for image in (short, empty, narrow, unknown):
            image.header.stamp = self.between_images().header.stamp
            self.harness.publish_any(image)
            self.expect_tracking()
            self.expect_no_pose_at(image.header.stamp)

        # An image that is refused anyway does not wait for its transform.
        unnamed = self.between_images()
        unnamed.header.frame_id = ""
        start = time.monotonic()
        self.harness.publish_any(unnamed)
        self.expect_tracking()
        self.assertLess(time.monotonic() - start,
                        rospy.get_param("/first/localizer/transform_timeout"))
        self.expect_no_pose_at(unnamed.header.stamp)

    def test_05_padded_rows(self):
        for padding in (1, 12, 500):
            image = self.next_image()
            self.expect_right_pose(with_pixels(image, "mono8", self.pixels(image), padding))
        image = self.next_image()
        color = cv2.cvtColor(self.pixels(image), cv2.COLOR_GRAY2BGR)
        self.expect_right_pose(with_pixels(image, "bgr8", color, 36))
        self.expect_tracking()

    def test_06_every_encoding(self):
        def sixteen_bits(gray):
            return gray.astype("<u2") * 257

        encodings = {"mono8": np.copy, "mono16": sixteen_bits, "8UC1": np.copy,
                     "16UC1": sixteen_bits}
        for encoding in ("bgr8", "rgb8", "bgra8", "rgba8"):
            encodings[encoding] = (
                lambda gray, channels=len(encoding) - 1: np.dstack([gray] * channels))
        for order in ("rggb", "bggr", "gbrg", "grbg"):
            encodings[f"bayer_{order}8"] = np.copy
        for encoding, convert in encodings.items():
            with self.subTest(encoding):
                image = self.next_image()
                self.expect_right_pose(with_pixels(image, encoding, convert(self.pixels(image))))
        self.expect_tracking()

    def test_07_camera_unplugged(self):
        self.wait_for_diagnostics("images", DiagnosticStatus.ERROR, "none for")
        type(self).later = self.later + rospy.Duration(30.0)
        type(self).index = self.index + 2
        status = self.expect_right_pose(self.next_image())
        self.assertEqual(status.mode, LocalizationStatus.FOUND)
        self.expect_tracking()
        self.wait_for_diagnostics("images", DiagnosticStatus.OK)

    def test_08_initial_poses_that_are_none(self):
        x, y, yaw = self.harness.truth[self.harness.images[self.index - 1].header.stamp]
        good = PoseWithCovarianceStamped()
        good.header.frame_id = "map"
        good.pose.pose.position.x, good.pose.pose.position.y = x + 3.0, y
        good.pose.pose.orientation.z = np.sin(yaw / 2)
        good.pose.pose.orientation.w = np.cos(yaw / 2)
        bad = [copy.deepcopy(good) for _ in range(5)]
        bad[0].pose.pose.position.y = np.nan
        bad[1].pose.pose.orientation.w = np.nan
        bad[2].header.frame_id = "no_such_frame"
        bad[3].header.frame_id = ""
        bad[4].pose.pose.orientation.z = bad[4].pose.pose.orientation.w = 0.0
        for message in bad:
            start = len(self.log.messages)
            self.initial_pose.publish(message)
            self.assertTrue(self.log.wait_for_line(
                Log.ERROR, "/first/localizer: initialpose refused: ", start), message)
            self.expect_tracking()

    def test_09_initial_pose_in_another_frame(self):
        # The frame `door` stands 2 m before the map's origin and a quarter turn to its left.
        door = TransformStamped()
        door.header.stamp = self.between_images().header.stamp
        door.header.frame_id, door.child_frame_id = "map", "door"
        door.transform.translation.x = 2.0
        door.transform.rotation.z = door.transform.rotation.w = np.sqrt(0.5)
        x, y, yaw = self.harness.truth[self.harness.images[self.index].header.stamp]
        message = PoseWithCovarianceStamped()
        message.header.frame_id = "door"
        message.pose.pose.position.x, message.pose.pose.position.y = y + 0.03, -(x - 2.0)
        half = (yaw - np.pi / 2) / 2
        message.pose.pose.orientation.z = np.sin(half)
        message.pose.pose.orientation.w = np.cos(half)
        message.pose.covariance[0] = message.pose.covariance[7] = 0.0025
        message.pose.covariance[35] = 0.001

        def is_taken():
            # Until tf has the frame, the pose is refused.
            self.harness.publish_transform(door)
            self.initial_pose.publish(message)
            return self.log.wait_for_line(Log.INFO, "/first/localizer: initial pose", start, 0.5)

        start = len(self.log.messages)
        self.assertTrue(wait_until(is_taken))
        self.expect_tracking()

    def test_10_transform_gone_and_back(self):
        mounting = copy.deepcopy(self.harness.static_transforms[0])
        mounting.child_frame_id = "camera_on_a_turntable"

        def send(image, with_transform):
            image.header.frame_id = mounting.child_frame_id
            if with_transform:
                mounting.header.stamp = image.header.stamp
                self.harness.publish_transform(mounting)
            return image

        self.expect_right_pose(send(self.next_image(), True))
        # Only one: another might still be waiting when the transform is back, and rightly get it.
        gone = send(self.next_image(), False)
        self.harness.publish_any(gone)
        self.wait_for_diagnostics("transforms", DiagnosticStatus.ERROR, "waiting for tf",
                                  mounting.child_frame_id)
        self.expect_right_pose(send(self.next_image(), True))
        self.expect_no_pose_at(gone.header.stamp)
        self.wait_for_diagnostics("transforms", DiagnosticStatus.OK)
        self.expect_tracking()

    def test_11_frame_that_nobody_knows(self):
        image = self.between_images()
        image.header.frame_id = "no_such_camera"
        self.harness.publish_any(image)
        self.wait_for_diagnostics("transforms", DiagnosticStatus.ERROR, "no_such_camera")
        self.expect_tracking()
        self.expect_no_pose_at(image.header.stamp)

    def test_12_two_localizers_in_one_manager(self):
        camera, poses, _ = self.second()
        first_poses = len(self.harness.poses.messages)
        for index in range(30, 34):  # elsewhere than the first
            image = self.image_of_bag(index)
            camera.publish(image)
            self.expect_tracking()
            pose = poses.at(image.header.stamp)
            self.assertIsNotNone(pose)
            self.assertLess(self.errors(pose, index)[0], 0.02)
        self.assertEqual(len(self.harness.poses.messages), first_poses + 4)
        self.assertEqual(len(poses.messages), 4)

    def test_13_equal_stamps_and_older_ones(self):
        image = self.next_image()
        dropped = self.expect_right_pose(image).images_dropped
        older = copy.deepcopy(image)
        older.header.stamp -= HALF_PERIOD / 2
        for late in (image, image, older):
            self.harness.publish_any(late)
        status = self.expect_right_pose(self.next_image())
        self.assertEqual(status.mode, LocalizationStatus.TRACKING)
        self.assertEqual(status.images_dropped, dropped + 3)
        self.expect_no_pose_at(older.header.stamp)
        for topic in (self.harness.poses, self.harness.status):
            stamps = [message.header.stamp for message in topic.messages]
            self.assertEqual(stamps.count(image.header.stamp), 1)

    def test_14_gaps_of_seconds(self):
        for gap in (2.0, 5.0, 3600.0):
            type(self).later = self.later + rospy.Duration(gap)
            self.expect_right_pose(self.image_of_bag(self.index - 1, self.later))

    def test_15_a_slow_machine_drops_old_images(self):
        camera, _, status = self.second()
        camera.publish(self.image_of_bag(40))
        before = status.at(self.image_of_bag(40).header.stamp)
        self.assertIsNotNone(before)
        # The localizer waits for this one's transform while the others come.
        slow = self.image_of_bag(41)
        slow.header.frame_id = "no_such_camera"
        camera.publish(slow)
        self.wait_for_second_to_receive(before.images_received + 1)
        others = [self.image_of_bag(index) for index in range(42, 47)]
        for image in others:
            camera.publish(image)
        after = status.at(others[-1].header.stamp)
        self.assertIsNotNone(after)
        self.assertEqual(after.images_received, before.images_received + 6)
        self.assertEqual(after.images_dropped, before.images_dropped + 4)
        self.assertEqual([message.header.stamp for message in status.messages],
                         [before.header.stamp, after.header.stamp])

    def wait_for_second_to_receive(self, count):
        """Waits until /diagnostics says that the second localizer received this many images; it has then
        taken up the last one, unless others wait before it."""
        self.assertIsNotNone(self.diagnostics.wait_for(lambda message: any(
            status.name.endswith("second/localizer: images") and
            KeyValue("received", str(count)) in status.values for status in message.status)))


if __name__ == "__main__":
    rospy.init_node("faults_test")
    rostest.rosrun("omnitag", "faults", FaultsTest, sys.argv)
