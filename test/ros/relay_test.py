#!/usr/bin/env python3
"""Detections are relayed in other packages' messages: types as those packages define them are laid
where the node finds them."""

import os
import subprocess
import sys
import tempfile
import unittest

import rospy
import rostest
from geometry_msgs.msg import Point
from harness import Topic, is_connected, wait_until
from omnitag.msg import DetectedMarker, MarkerDetectionArray

HEADER = "std_msgs/Header header\n"
FIDUCIAL = "int32 fiducial_id\nint32 direction\n" + "".join(
    "float64 {}{}\n".format(axis, i) for i in range(4) for axis in "xy")
TRANSFORM = ("int32 fiducial_id\ngeometry_msgs/Transform transform\nfloat64 image_error\n"
             "float64 object_error\nfloat64 fiducial_area\n")
TYPES = {
    "fiducial_msgs": {
        "Fiducial": FIDUCIAL,
        "FiducialArray": HEADER + "int32 image_seq\nfiducial_msgs/Fiducial[] fiducials\n",
        "FiducialTransform": TRANSFORM,
        "FiducialTransformArray":
            HEADER + "int32 image_seq\nfiducial_msgs/FiducialTransform[] transforms\n"},
    "apriltag_ros": {
        "AprilTagDetection":
            "int32[] id\nfloat64[] size\ngeometry_msgs/PoseWithCovarianceStamped pose\n",
        "AprilTagDetectionArray": HEADER + "apriltag_ros/AprilTagDetection[] detections\n"},
    "aruco_msgs": {
        "Marker": HEADER + "uint32 id\ngeometry_msgs/PoseWithCovariance pose\n"
                           "float64 confidence\n",
        "MarkerArray": HEADER + "aruco_msgs/Marker[] markers\n"}}
GENMSG = ["/usr/lib/genpy/genmsg_py.py", "/opt/ros/noetic/lib/genpy/genmsg_py.py"]
MESSAGES = ["/usr/share/{0}/msg", "/opt/ros/noetic/share/{0}/msg"]


def generate(directory):
    """Python packages of the types."""
    tool = next(path for path in GENMSG if os.path.exists(path))
    includes = []
    for package in ("std_msgs", "geometry_msgs"):
        path = next(p.format(package) for p in MESSAGES if os.path.isdir(p.format(package)))
        includes += ["-I", package + ":" + path]
    for package, types in TYPES.items():
        folder = os.path.join(directory, package, "msg")
        os.makedirs(folder)
        for name, text in types.items():
            with open(os.path.join(folder, name + ".msg"), "w", encoding="utf-8") as file:
                file.write(text)
        with open(os.path.join(directory, package, "__init__.py"), "w", encoding="utf-8"):
            pass
        common = ["-p", package, "-o", folder, "-I", package + ":" + folder] + includes
        for name in types:
            subprocess.run([sys.executable, tool, os.path.join(folder, name + ".msg")] + common,
                           check=True)
        subprocess.run([sys.executable, tool, "--initpy", "-p", package, "-o", folder], check=True)


def detection():
    """The detection of a marker 2 m in front of the camera."""
    marker = DetectedMarker(id=7, family="tag36h11", accepted=True, residual=0.1, size=0.3)
    marker.corners = [Point(10, 20, 0), Point(14, 20, 0), Point(14, 16, 0), Point(10, 16, 0)]
    marker.pose.pose.position.z = 2.0
    marker.pose.pose.orientation.x = 1.0
    marker.pose.covariance[0] = marker.pose.covariance[7] = 0.01
    marker.pose.covariance[14] = 0.02
    return marker


class RelayTest(unittest.TestCase):
    def test_relays_what_others_expect(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        generate(directory.name)
        environment = dict(os.environ)
        environment["PYTHONPATH"] = directory.name + ":" + environment.get("PYTHONPATH", "")
        node = subprocess.Popen(["rosrun", "omnitag", "relay_detections"], env=environment)
        self.addCleanup(node.wait)
        self.addCleanup(node.terminate)
        sys.path.insert(0, directory.name)
        # pylint: disable=import-outside-toplevel,import-error
        from apriltag_ros.msg import AprilTagDetectionArray
        from aruco_msgs.msg import MarkerArray
        from fiducial_msgs.msg import FiducialArray, FiducialTransformArray
        topics = [Topic(name, message_type) for name, message_type in (
            ("fiducial_transforms", FiducialTransformArray),
            ("fiducial_vertices", FiducialArray), ("tag_detections", AprilTagDetectionArray),
            ("aruco_marker_publisher/markers", MarkerArray))]
        publisher = rospy.Publisher("detections", MarkerDetectionArray, queue_size=1)
        self.assertTrue(wait_until(
            lambda: is_connected(publisher, *(topic.subscriber for topic in topics))))
        array = MarkerDetectionArray()
        array.header.stamp, array.header.frame_id = rospy.Time(12.5), "camera"
        without_pose = DetectedMarker(id=9)
        without_pose.pose.covariance[0] = -1.0
        array.detections = [detection(), without_pose]
        publisher.publish(array)
        transforms, vertices, tags, markers = (topic.at(rospy.Time(12.5)) for topic in topics)

        (transform,) = transforms.transforms
        self.assertEqual(transform.fiducial_id, 7)
        self.assertEqual(transform.transform.translation.z, 2.0)
        self.assertEqual(transform.transform.rotation.x, 1.0)
        self.assertEqual(transform.fiducial_area, 16.0)
        self.assertAlmostEqual(transform.object_error, 0.2)
        (fiducial,) = vertices.fiducials
        # Clockwise from the upper left.
        self.assertEqual([(fiducial.x0, fiducial.y0), (fiducial.x1, fiducial.y1),
                          (fiducial.x2, fiducial.y2), (fiducial.x3, fiducial.y3)],
                         [(10, 16), (14, 16), (14, 20), (10, 20)])
        (tag,) = tags.detections
        self.assertEqual((tag.id, tag.size, tag.pose.header.frame_id), ((7,), (0.3,), "camera"))
        self.assertEqual(tag.pose.pose.pose.position.z, 2.0)
        (marker,) = markers.markers
        self.assertEqual((marker.id, marker.pose.covariance[14]), (7, 0.02))

    def test_says_what_it_looked_for(self):
        result = subprocess.run(["rosrun", "omnitag", "relay_detections", "__name:=alone"],
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                universal_newlines=True, check=False)
        if result.returncode == 0:
            self.skipTest("one of the packages is installed")
        self.assertIn("apriltag_ros, aruco_msgs, fiducial_msgs", result.stdout)


if __name__ == "__main__":
    rospy.init_node("relay_test")
    rostest.rosrun("omnitag", "relay", RelayTest, sys.argv)
