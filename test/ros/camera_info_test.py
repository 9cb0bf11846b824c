#!/usr/bin/env python3
"""The localizer without a camera file: it waits for camera_info, checks it, and says so."""

import os
import shutil
import subprocess
import sys
import tempfile
import unittest

import rospy
import rosservice
import rostest
from diagnostic_msgs.msg import DiagnosticStatus, KeyValue
from harness import PACKAGE, Diagnostics, LogTopic, Topic, is_connected, wait_until
from omnitag.msg import LocalizationStatus
from rosgraph_msgs.msg import Log
from sensor_msgs.msg import CameraInfo, Image
from tf2_msgs.msg import TFMessage
from geometry_msgs.msg import TransformStamped

INFO_TOPIC = "/camera/camera_info"


def fisheye_info():
    """A camera_info as a calibrated driver would send it."""
    info = CameraInfo(width=500, height=500, distortion_model="equidistant", D=[0.0] * 4)
    info.K = [146.0, 0.0, 249.5, 0.0, 146.0, 249.5, 0.0, 0.0, 1.0]
    return info


class CameraInfoTest(unittest.TestCase):
    def setUp(self):
        self.diagnostics = Diagnostics()
        self.status = Topic("status", LocalizationStatus)
        self.infos = rospy.Publisher(INFO_TOPIC, CameraInfo, queue_size=10)
        self.images = rospy.Publisher("/camera/image", Image, queue_size=10)

    def wait_for_camera(self, level, part):
        """Waits until /diagnostics says this about the camera."""
        self.diagnostics.wait_for_report(": camera", level, part)

    def test_waits_checks_and_starts(self):
        self.wait_for_camera(DiagnosticStatus.ERROR,
                             "waiting for the first camera_info on " + INFO_TOPIC)
        self.assertTrue(wait_until(lambda: is_connected(self.infos)))

        self.infos.publish(CameraInfo())
        self.wait_for_camera(DiagnosticStatus.ERROR, "width, height: expected")
        uncalibrated = fisheye_info()
        uncalibrated.K = [0.0] * 9
        self.infos.publish(uncalibrated)
        self.wait_for_camera(DiagnosticStatus.ERROR, "K: expected")
        other = fisheye_info()
        other.distortion_model = "fov"
        self.infos.publish(other)
        self.wait_for_camera(DiagnosticStatus.ERROR, "found 'fov'")
        self.assertNotIn("/save_map", rosservice.get_service_list())
        self.assertEqual(self.images.get_num_connections(), 0)

        self.infos.publish(fisheye_info())
        self.wait_for_camera(DiagnosticStatus.OK, "described by camera_info")
        self.assertTrue(wait_until(lambda: "/save_map" in rosservice.get_service_list()))
        self.assertTrue(wait_until(lambda: is_connected(self.images, self.status.subscriber)))

        # It needs no more of them, and still says where its camera came from.
        self.assertTrue(wait_until(lambda: self.infos.get_num_connections() == 0))
        start = len(self.diagnostics.messages)
        self.assertTrue(wait_until(lambda: any(
            status.name.endswith(": camera") and KeyValue("topic", INFO_TOPIC) in status.values
            for message in self.diagnostics.messages[start:] for status in message.status)))

        mounting = TransformStamped()
        mounting.header.frame_id, mounting.child_frame_id = "base_link", "eye"
        mounting.transform.rotation.w = 1.0
        static = rospy.Publisher("/tf_static", TFMessage, latch=True, queue_size=1)
        static.publish([mounting])
        self.assertTrue(wait_until(lambda: is_connected(static)))
        image = Image(height=500, width=500, encoding="mono8", step=500, data=bytes(250000))
        image.header.frame_id = "eye"

        def is_answered():
            image.header.stamp = rospy.Time.now()
            self.images.publish(image)
            return self.status.wait_for(lambda status: not status.has_pose, 0.5) is not None

        self.assertTrue(wait_until(is_answered))

    def test_what_is_wrong_beside_the_camera_is_said_once(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        map_file = os.path.join(directory.name, "map.yaml")
        shutil.copy(os.path.join(PACKAGE, "maps", "fisheye.yaml"), map_file)
        rospy.set_param("/rear/map_file", map_file)
        infos = rospy.Publisher("/rear_camera/camera_info", CameraInfo, queue_size=10)
        log = LogTopic()
        node = subprocess.Popen(["rosrun", "omnitag", "localizer_node", "__name:=rear",
                                 "image:=/rear_camera/image"])
        self.addCleanup(node.wait)
        self.addCleanup(node.terminate)
        self.assertTrue(wait_until(lambda: is_connected(infos, log.subscriber)))

        os.remove(map_file)
        for _ in range(3):
            infos.publish(fisheye_info())
        self.diagnostics.wait_for_report("rear: camera", DiagnosticStatus.ERROR, map_file)
        self.assertTrue(wait_until(lambda: infos.get_num_connections() == 0))
        self.assertTrue(log.wait_for_line(Log.FATAL, map_file, 0))
        lines = [line.msg for line in log.messages if line.level == Log.FATAL]
        self.assertEqual(len(lines), 1, lines)

    def test_with_scale_to_image_it_waits_for_an_image(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        camera_file = os.path.join(directory.name, "camera.yaml")
        shutil.copy(os.path.join(PACKAGE, "config", "cameras", "fisheye.yaml"), camera_file)
        with open(camera_file, "a", encoding="utf-8") as file:
            file.write("\nscale_to_image: true\n")
        rospy.set_param("/other/small/camera_file", camera_file)
        rospy.set_param("/other/small/map_file", os.path.join(PACKAGE, "maps", "fisheye.yaml"))
        node = subprocess.Popen(["rosrun", "omnitag", "localizer_node", "__name:=small",
                                 "__ns:=/other", "image:=/small_camera/image"])
        self.addCleanup(node.wait)
        self.addCleanup(node.terminate)
        self.diagnostics.wait_for_report("small: camera", DiagnosticStatus.ERROR,
                                         "waiting for the first image on /small_camera/image")
        images = rospy.Publisher("/small_camera/image", Image, queue_size=10)
        image = Image(height=250, width=250, encoding="mono8", step=250, data=bytes(62500))
        image.header.frame_id = "small_eye"

        def is_started():
            image.header.stamp = rospy.Time.now()
            images.publish(image)
            return any(status.name.endswith("small: camera")
                       and status.level == DiagnosticStatus.OK
                       and status.message == "scaled to the images"
                       for message in self.diagnostics.messages for status in message.status)

        self.assertTrue(wait_until(is_started))


if __name__ == "__main__":
    rospy.init_node("camera_info_test")
    rostest.rosrun("omnitag", "camera_info", CameraInfoTest, sys.argv)
