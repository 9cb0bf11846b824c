#!/usr/bin/env python3
"""One localizer with two cameras: which image updates what, and what it says if one is missing."""

import copy
import sys
import threading
import unittest

import numpy as np
import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import PoseStamped
from harness import (Diagnostics, Topic, angle_between, is_connected, odometry, read_bag,
                     read_truth, wait_until, yaw_of)
from omnitag.msg import LocalizationStatus, MarkerDetectionArray
from sensor_msgs.msg import CompressedImage, Image
from tf2_msgs.msg import TFMessage

NAMES = ("front", "back")


def pixels_of(image):
    return np.frombuffer(image.data, np.uint8).reshape(image.height, image.width, 3)


class SeveralCamerasTest(unittest.TestCase):
    def setUp(self):
        self.images, static_transforms = read_bag()
        self.truth = read_truth()
        self.poses = Topic("pose", PoseStamped)
        self.status = Topic("status", LocalizationStatus)
        self.detections = Topic("detections", MarkerDetectionArray)
        self.transforms = Topic("/tf", TFMessage)
        self.paintings = {name: Topic(name + "/debug_image", Image) for name in NAMES}
        self.joint_paintings = Topic("debug_image", Image)
        self.publishers = {name: rospy.Publisher("/{}/image/compressed".format(name),
                                                 CompressedImage, queue_size=100)
                           for name in NAMES}
        self.tf = rospy.Publisher("/tf", TFMessage, queue_size=1000)
        static = rospy.Publisher("/tf_static", TFMessage, latch=True, queue_size=1)
        back = copy.deepcopy(static_transforms[0])
        back.child_frame_id = "back_optical"
        static.publish(static_transforms + [back])
        ends = [self.poses.subscriber, self.status.subscriber, self.detections.subscriber,
                self.transforms.subscriber, self.tf, static]
        ends += [painting.subscriber for painting in self.paintings.values()]
        ends.append(self.joint_paintings.subscriber)
        ends += self.publishers.values()
        self.assertTrue(wait_until(lambda: is_connected(*ends)))
        # Both cameras' images of the same moment first, then one camera at a time.
        self.sent = [(0, "front"), (0, "back")]
        self.sent += [(index, NAMES[index % 2]) for index in range(1, 13)]

    def test_all(self):
        diagnostics = Diagnostics()
        for index, name in self.sent:
            self.send(index, name)
            self.assertIsNotNone(self.status.wait_for(
                lambda status: status.header.stamp == self.images[index].header.stamp and
                status.camera == name))
            # Debug images have a queue of one: the next image may replace what was not sent yet.
            self.assertIsNotNone(self.paintings[name].at(self.images[index].header.stamp))
        self.assertEqual([status.camera for status in self.status.messages],
                         [name for _, name in self.sent])
        self.assertTrue(all(status.has_pose for status in self.status.messages))
        self.check_poses()
        self.check_frames()
        self.check_joint_paintings()
        self.check_transforms()
        diagnostics.wait_for_report("localizer: localization", DiagnosticStatus.OK, "tracking")
        self.check_missing_camera(diagnostics)

    def send(self, index, name):
        image = self.images[index]
        self.tf.publish([odometry(image.header.stamp, self.truth[image.header.stamp])])
        self.publishers[name].publish(image)

    def check_poses(self):
        self.assertTrue(wait_until(lambda: len(self.poses.messages) == len(self.sent)))
        for pose in self.poses.messages:
            x, y, yaw = self.truth[pose.header.stamp]
            distance = np.hypot(pose.pose.position.x - x, pose.pose.position.y - y)
            self.assertLess(distance, 0.005)
            self.assertLess(angle_between(yaw_of(pose.pose.orientation), yaw), 0.003)

    def check_frames(self):
        """Each camera's detections are in its frame, and its debug images on its topic."""
        self.assertTrue(wait_until(lambda: len(self.detections.messages) == len(self.sent)))
        frames = [detections.header.frame_id for detections in self.detections.messages]
        own = self.images[0].header.frame_id
        self.assertEqual(frames, [own if name == "front" else "back_optical"
                                  for _, name in self.sent])
        for name in NAMES:
            stamps = [self.images[index].header.stamp for index, sent in self.sent if sent == name]
            self.assertTrue(wait_until(
                lambda: len(self.paintings[name].messages) == len(stamps)))
            self.assertEqual([image.header.stamp for image in self.paintings[name].messages],
                             stamps)

    def check_joint_paintings(self):
        """RViz shows the last image of each camera, side by side."""
        own = {name: self.paintings[name].messages[-1] for name in NAMES}
        last = self.images[self.sent[-1][0]]
        joint = self.joint_paintings.at(last.header.stamp)
        self.assertIsNotNone(joint)
        width = own["front"].width
        self.assertEqual((joint.width, joint.height), (2 * width, own["front"].height))
        pixels = pixels_of(joint)
        np.testing.assert_array_equal(pixels[:, :width], pixels_of(own["front"]))
        np.testing.assert_array_equal(pixels[:, width:], pixels_of(own["back"]))

    def check_transforms(self):
        """tf would complain of a second transform of the same stamp."""
        stamps = [transform.header.stamp for message in self.transforms.messages
                  for transform in message.transforms if transform.header.frame_id == "map"]
        self.assertGreaterEqual(len(stamps), 13)
        self.assertEqual(len(stamps), len(set(stamps)))

    def check_missing_camera(self, diagnostics):
        """A camera that falls silent is named although the other goes on."""
        going_on = threading.Event()

        def go_on():
            index = 13
            while not going_on.wait(0.3) and index < len(self.images):
                self.send(index, "front")
                index += 1

        sender = threading.Thread(target=go_on)
        sender.start()
        try:
            diagnostics.wait_for_report("localizer: images", DiagnosticStatus.ERROR,
                                        "waiting for images on /back/image")
        finally:
            going_on.set()
            sender.join()


if __name__ == "__main__":
    rospy.init_node("several_cameras_test")
    rostest.rosrun("omnitag", "several_cameras", SeveralCamerasTest, sys.argv)
