#!/usr/bin/env python3
"""Two localizers side by side, started by the launch file as a user does; a table of what one of
them saw; and simulated time that is taken back."""

import csv
import os
import queue
import signal
import subprocess
import sys
import threading
import time
import unittest
from xmlrpc.client import ServerProxy
from xmlrpc.server import SimpleXMLRPCServer

import numpy as np
import rosgraph
import rosnode
import rospkg
import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import PoseStamped
from harness import (PACKAGE, Diagnostics, Harness, Topic, angle_between, is_connected,
                     wait_until)

sys.path.append(os.path.join(PACKAGE, "python"))
from omnitag.marker_map import load_marker_map  # noqa: E402

IMAGES = 12
CAMERA = np.array([0.1, 0.02])  # its axis, which is upright, in base_link


def rows_of(path):
    """The complete rows of a table that is being written."""
    if not os.path.exists(path):
        return []
    with open(path, encoding="utf-8") as file:
        return list(csv.DictReader(line for line in file if line.endswith("\n")))


class InterruptingMaster:
    """Passes calls on to the master, and interrupts the caller in the midst of one."""

    def __init__(self, method):
        self.method = method
        self.node = queue.Queue()
        self.server = SimpleXMLRPCServer(("localhost", 0), logRequests=False, allow_none=True)
        self.server.register_instance(self)
        self.uri = "http://localhost:{}/".format(self.server.server_address[1])
        self.thread = threading.Thread(target=self.server.serve_forever)

    def __enter__(self):
        self.thread.start()
        return self

    def __exit__(self, *_):
        self.server.shutdown()
        self.thread.join()
        self.server.server_close()

    def interrupt(self, node):
        self.node.put(node)

    def _dispatch(self, method, arguments):
        if method == self.method and self.node is not None:
            self.node.get().send_signal(signal.SIGINT)
            self.node = None
            time.sleep(0.3)  # So that it is there before the answer.
        with ServerProxy(rosgraph.get_master_uri()) as master:
            return getattr(master, method)(*arguments)


class SideBySideTest(unittest.TestCase):
    def test_1_both_localize_and_one_sends_the_transform(self):
        self.wait_for_subscribers("/camera/image/compressed", "/front/localizer", "/rear/localizer")
        self.wait_for_subscribers("/front/detections", "/front/record_trajectory")
        harness = Harness("compressed")
        diagnostics = Diagnostics()
        rear = Topic("/rear/pose", PoseStamped)
        self.assertTrue(wait_until(lambda: is_connected(rear.subscriber, diagnostics.subscriber)))
        for image in harness.images[:IMAGES]:
            self.assertIsNotNone(harness.localize(image))
            for pose in (harness.poses.at(image.header.stamp), rear.at(image.header.stamp)):
                distance, angle = harness.errors(pose)
                self.assertLess(distance, 0.02)
                self.assertLess(angle, 0.01)
        # If both sent it, it would be there twice.
        self.assertTrue(wait_until(lambda: len(harness.published_transforms()) >= IMAGES))
        stamps = [transform.header.stamp for transform in harness.published_transforms()]
        self.assertEqual(sorted(stamps), [image.header.stamp for image in harness.images[:IMAGES]])
        for name in ("front", "rear"):
            diagnostics.wait_for_report(name + "/localizer: localization", DiagnosticStatus.OK,
                                        "tracking")
        diagnostics.wait_for_report("waiting/localizer: camera", DiagnosticStatus.ERROR,
                                    "camera_info on /elsewhere/info")
        self.check_table(harness)

    def wait_for_subscribers(self, topic, *nodes):
        """Waits until the master knows them: then the harness waits for the connections."""
        master = rosgraph.Master(rospy.get_name())
        self.assertTrue(wait_until(
            lambda: set(nodes) <= set(dict(master.getSystemState()[1]).get(topic, []))))

    def check_table(self, harness):
        """The bearings that record_trajectory writes are those of the markers from the robot."""
        path = os.path.join(rospkg.get_ros_home(), "side_by_side_detections.csv")
        last = harness.images[IMAGES - 1].header.stamp
        self.assertTrue(wait_until(
            lambda: any(row["stamp"].startswith(str(last.secs) + ".") for row in rows_of(path))))
        markers = load_marker_map(os.path.join(PACKAGE, "maps", "paper.yaml")).markers
        used = [row for row in rows_of(path) if row["accepted"] == "1"]
        self.assertGreater(len(used), IMAGES)
        for row in used:
            seconds, nanoseconds = row["stamp"].split(".")
            x, y, yaw = harness.truth[rospy.Time(int(seconds), int(nanoseconds))]
            turn = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
            way = markers[int(row["map_entry"])].position[:2] - [x, y] - turn @ CAMERA
            self.assertLess(angle_between(float(row["bearing"]), np.arctan2(way[1], way[0]) - yaw),
                            0.002)

    def test_2_simulated_time_is_taken_back(self):
        node = self.start_take_back(rosgraph.get_master_uri())
        self.assertTrue(wait_until(lambda: "/front/take_back_sim_time" in rosnode.get_node_names()))
        node.send_signal(signal.SIGINT)
        self.check_time_is_taken_back(node)

    def test_3_simulated_time_is_taken_back_by_a_node_that_hardly_started(self):
        with InterruptingMaster("getParam") as master:
            node = self.start_take_back(master.uri)
            master.interrupt(node)
            self.check_time_is_taken_back(node)

    def start_take_back(self, master_uri):
        rospy.set_param("/use_sim_time", True)
        self.addCleanup(lambda: rospy.has_param("/use_sim_time") and
                        rospy.delete_param("/use_sim_time"))
        node = subprocess.Popen(["rosrun", "omnitag", "take_back_sim_time"],
                                stdout=subprocess.PIPE, universal_newlines=True,
                                env=dict(os.environ, ROS_MASTER_URI=master_uri))
        self.addCleanup(node.wait)
        self.addCleanup(node.kill)
        return node

    def check_time_is_taken_back(self, node):
        said, _ = node.communicate(timeout=30)
        self.assertIn("/use_sim_time is deleted", said)
        self.assertFalse(rospy.has_param("/use_sim_time"))


if __name__ == "__main__":
    rospy.init_node("side_by_side_test")
    rostest.rosrun("omnitag", "side_by_side", SideBySideTest, sys.argv)
