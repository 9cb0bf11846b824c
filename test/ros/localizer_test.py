#!/usr/bin/env python3
"""The localizer, as node and as nodelet, against the shipped bag."""

import copy
import sys
import unittest

import cv2
import numpy as np
import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import PoseWithCovarianceStamped
from harness import (Diagnostics, Harness, LogTopic, Topic, angle_between, is_connected, raw_image,
                     wait_until, yaw_of)
from nav_msgs.msg import Path
from omnitag.msg import LocalizationStatus
from rosgraph_msgs.msg import Log
from sensor_msgs.msg import CompressedImage, Image
from std_srvs.srv import Empty, Trigger
from visualization_msgs.msg import MarkerArray


class LocalizerTest(unittest.TestCase):
    """The tests run in the order of their names: each uses the localizer as the last one left it."""

    @classmethod
    def setUpClass(cls):
        cls.harness = Harness(rospy.get_param("~transport"))
        cls.path = Topic("path", Path)
        cls.markers = Topic("markers", MarkerArray)
        cls.debug_images = Topic("debug_image", Image)
        cls.diagnostics = Diagnostics()
        cls.log = LogTopic()
        cls.initial_pose = rospy.Publisher("initialpose", PoseWithCovarianceStamped, queue_size=1)
        assert wait_until(lambda: is_connected(
            cls.initial_pose, cls.path.subscriber, cls.markers.subscriber,
            cls.debug_images.subscriber, cls.diagnostics.subscriber, cls.log.subscriber))

    def wait_for_diagnostics(self, task, level, *parts):
        """Waits until a task of the localizer newly reports a line with these parts."""
        self.diagnostics.wait_for_report(": " + task, level, *parts)

    def test_1_says_what_it_waits_for(self):
        self.wait_for_diagnostics("images", DiagnosticStatus.ERROR, "waiting for the first image",
                                  "/camera/image", "1 publishers")

    def test_2_shows_the_map_before_the_first_image(self):
        array = self.markers.wait_for(lambda message: True)
        self.assertEqual({marker.ns for marker in array.markers}, {"tags", "normals", "names"})
        self.assertEqual(len([m for m in array.markers if m.ns == "names"]), 17)

    def test_3_localizes_every_image(self):
        harness = self.harness
        for image in harness.images:
            self.assertIsNotNone(harness.localize(image), image.header.stamp)
        stamps = [image.header.stamp for image in harness.images]
        self.assertEqual(len(stamps), 66)
        for topic in (harness.poses, harness.covariances, harness.status, harness.detections):
            self.assertIsNotNone(topic.at(stamps[-1]))
            self.assertEqual([message.header.stamp for message in topic.messages], stamps)

        errors = [harness.errors(pose) for pose in harness.poses.messages]
        self.assertLess(np.mean([distance for distance, _ in errors]), 0.005)
        self.assertLess(np.max([distance for distance, _ in errors]), 0.02)
        self.assertLess(np.max([angle for _, angle in errors]), np.radians(0.2))

        for pose in harness.poses.messages:
            self.assertEqual(pose.header.frame_id, "map")
            self.assertEqual((pose.pose.position.z, pose.pose.orientation.x,
                              pose.pose.orientation.y), (0.0, 0.0, 0.0))
        for pose, estimate in zip(harness.poses.messages, harness.covariances.messages):
            self.assertEqual(estimate.header, copy_without_seq(pose.header, estimate.header))
            self.assertEqual(estimate.pose.pose, pose.pose)
            covariance = np.reshape(estimate.pose.covariance, (6, 6))
            np.testing.assert_array_equal(covariance, covariance.T)
            self.assertGreater(np.linalg.eigvalsh(covariance)[0], 0.0)
            self.assertLess(np.sqrt(covariance[0, 0]), 0.05)

        for status, detections in zip(harness.status.messages, harness.detections.messages):
            self.assertEqual(status.mode, LocalizationStatus.TRACKING)
            self.assertEqual(status.images_dropped, 0)
            self.assertEqual(status.header.frame_id, "map")
            self.assertEqual(detections.header.frame_id, "camera_optical_frame")
            self.assertEqual(status.markers_detected, len(detections.detections))
            accepted = [d for d in detections.detections if d.accepted]
            self.assertEqual(status.markers_used, len(accepted))
            self.assertGreaterEqual(len(accepted), 3)
            for detection in accepted:
                self.assertEqual(detection.reason, "")
                self.assertLess(detection.residual, 1.5)
            for detection in detections.detections:
                self.assertNotEqual(detection.accepted, bool(detection.reason))
        self.assertEqual(harness.status.messages[-1].images_received, 66)

    def test_4_tf_agrees_with_the_poses(self):
        self.assertTrue(wait_until(lambda: len(self.harness.published_transforms()) >= 66))
        transforms = {t.header.stamp: t for t in self.harness.published_transforms()}
        self.assertEqual(len(transforms), 66)
        for pose in self.harness.poses.messages:
            transform = transforms[pose.header.stamp]
            self.assertEqual(transform.child_frame_id, "base_link")
            self.assertAlmostEqual(transform.transform.translation.x, pose.pose.position.x, 12)
            self.assertAlmostEqual(transform.transform.translation.y, pose.pose.position.y, 12)
            self.assertLess(angle_between(yaw_of(transform.transform.rotation),
                                          yaw_of(pose.pose.orientation)), 1e-9)

    def test_5_shows_what_it_does(self):
        last = self.harness.images[-1].header.stamp
        self.assertIsNotNone(self.path.at(last))
        path = self.path.messages[-1]
        self.assertEqual(path.header.frame_id, "map")
        self.assertGreater(len(path.poses), 20)
        image = self.debug_images.at(last)
        self.assertIsNotNone(image)
        self.assertEqual((image.encoding, image.width), ("bgr8", 1020))
        shown = self.markers.wait_for(lambda array: any(
            marker.header.stamp == last and marker.ns == "accepted" for marker in array.markers))
        self.assertIsNotNone(shown)
        for marker in shown.markers:
            self.assertEqual(marker.header.frame_id, "map")
        self.wait_for_diagnostics("localization", DiagnosticStatus.OK, "tracking")
        self.wait_for_diagnostics("transforms", DiagnosticStatus.OK)

    def test_6_starts_anew_when_time_goes_back(self):
        start = len(self.log.messages)
        status = self.harness.localize(self.shifted(0, -100.0))
        self.assertEqual(status.mode, LocalizationStatus.TRACKING)
        self.assertEqual(status.images_dropped, 0)
        self.assertTrue(self.log.wait_for_line(Log.WARN, "stamps went back", start))
        self.assertEqual(len(self.path.at(status.header.stamp).poses), 1)
        pose = self.harness.poses.at(status.header.stamp)
        self.assertLess(self.distance(pose, 0), 0.02)

    def test_7_keeps_its_pose_through_bad_images(self):
        harness = self.harness
        poses = len(harness.poses.messages)
        harness.publish_any(self.with_pixels(self.shifted(1, -100.0),
                                             np.zeros((400, 500), np.uint8)))
        self.wait_for_diagnostics("images", DiagnosticStatus.ERROR, "500 x 400 pixels",
                                  "expected 500 x 500 pixels", "paper.yaml")
        torn = self.with_pixels(self.shifted(1, -100.0), np.zeros((500, 500), np.uint8))
        torn.data = torn.data[:40]
        harness.publish_any(torn)
        self.wait_for_diagnostics("images", DiagnosticStatus.ERROR, "refused", "40")
        unnamed = self.shifted(1, -100.0)
        unnamed.header.frame_id = ""
        harness.publish(unnamed)
        self.wait_for_diagnostics("images", DiagnosticStatus.ERROR, "header.frame_id is empty")
        unknown = self.shifted(1, -100.0)
        unknown.header.frame_id = "no_such_camera"
        harness.publish(unknown)
        self.wait_for_diagnostics("transforms", DiagnosticStatus.ERROR, "no_such_camera",
                                  "base_link")
        harness.publish(self.shifted(0, -100.1))

        status = harness.localize(self.shifted(2, -100.0))
        self.assertEqual(status.mode, LocalizationStatus.TRACKING)
        self.assertEqual(status.images_dropped, 1)
        self.assertIsNotNone(harness.poses.at(status.header.stamp))
        self.assertEqual(len(harness.poses.messages), poses + 1)
        self.wait_for_diagnostics("images", DiagnosticStatus.OK, "images are coming")

    def test_8_takes_poses_and_forgets_them(self):
        harness = self.harness
        rospy.ServiceProxy("global_localization", Empty)()
        status = harness.localize(compressed(self.shifted(3, -100.0),
                                             np.full((500, 500), 90, np.uint8)))
        self.assertFalse(status.has_pose)
        self.assertIn("no marker", status.remark)
        self.wait_for_diagnostics("localization", DiagnosticStatus.WARN, "searching", "no marker")
        status = harness.localize(self.shifted(4, -100.0))
        self.assertEqual(status.mode, LocalizationStatus.FOUND)
        self.assertLess(self.distance(harness.poses.at(status.header.stamp), 4), 0.02)

        for frame_id, quaternion in (("map", (0.0, 0.0)), ("map", (np.nan, 1.0)),
                                     ("", (0.0, 1.0)), ("no_such_frame", (0.0, 1.0))):
            start = len(self.log.messages)
            self.initial_pose.publish(initial_pose(frame_id, 40.0, 40.0, quaternion))
            self.assertTrue(self.log.wait_for_line(Log.ERROR, "initialpose refused", start))
        status = harness.localize(self.shifted(5, -100.0))
        self.assertEqual(status.mode, LocalizationStatus.TRACKING)
        self.assertEqual(status.remark, "")
        self.assertLess(self.distance(harness.poses.at(status.header.stamp), 5), 0.02)

        x, y, yaw = self.true_pose(6)
        start = len(self.log.messages)
        self.initial_pose.publish(
            initial_pose("map", x + 0.03, y - 0.02, (np.sin(yaw / 2.0), np.cos(yaw / 2.0))))
        self.assertTrue(self.log.wait_for_line(Log.INFO, "initial pose x", start))
        status = harness.localize(self.shifted(6, -100.0))
        self.assertEqual(status.mode, LocalizationStatus.TRACKING)
        self.assertLess(self.distance(harness.poses.at(status.header.stamp), 6), 0.02)

    def test_9_says_that_mapping_is_off(self):
        response = rospy.ServiceProxy("save_map", Trigger)()
        self.assertFalse(response.success)
        self.assertIn("mapping and refine_map are off", response.message)

    def shifted(self, index, shift):
        """An image of the bag, its stamp shifted by some seconds."""
        image = copy.deepcopy(self.harness.images[index])
        image.header.stamp += rospy.Duration(shift)
        return image

    def with_pixels(self, image, pixels):
        """A message of the image topic's type: other pixels under the header of an image."""
        message = compressed(image, pixels)
        return raw_image(message) if rospy.get_param("~transport") == "raw" else message

    def true_pose(self, index):
        """(x, y, yaw) of an image of the bag."""
        return self.harness.truth[self.harness.images[index].header.stamp]

    def distance(self, pose, index):
        """m: distance of a pose from the true one of an image of the bag."""
        x, y, _ = self.true_pose(index)
        return np.hypot(pose.pose.position.x - x, pose.pose.position.y - y)


def compressed(image, pixels):
    """Other pixels under the header of an image."""
    return CompressedImage(header=image.header, format="png",
                           data=cv2.imencode(".png", pixels)[1].tobytes())


def copy_without_seq(header, other):
    """The header with the other's sequence number, which the sender counts for each topic."""
    header = copy.deepcopy(header)
    header.seq = other.seq
    return header


def initial_pose(frame_id, x, y, quaternion):
    """A message as RViz sends it; the quaternion is (z, w)."""
    message = PoseWithCovarianceStamped()
    message.header.frame_id = frame_id
    message.pose.pose.position.x, message.pose.pose.position.y = x, y
    message.pose.pose.orientation.z, message.pose.pose.orientation.w = quaternion
    message.pose.covariance[0] = message.pose.covariance[7] = 0.0025
    message.pose.covariance[35] = 0.001
    return message


if __name__ == "__main__":
    rospy.init_node("localizer_test")
    rostest.rosrun("omnitag", "localizer_test", LocalizerTest, sys.argv)
