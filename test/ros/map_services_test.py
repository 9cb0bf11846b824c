#!/usr/bin/env python3
"""The map is changed while the robot drives: by services, by an edited file, and in RViz."""

import os
import re
import subprocess
import sys
import tempfile
import unittest

import rospy
import rostest
from harness import IMAGE_TOPIC, PACKAGE, Harness, Topic, wait_until
from omnitag.marker_map import load_marker_map
from omnitag.msg import MapMarkerArray
from omnitag.srv import AddMarker, ChangeMap, IgnoreMarkers, RemoveMarker
from std_srvs.srv import Trigger
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import InteractiveMarkerFeedback, InteractiveMarkerInit

CAMERA = os.path.join(PACKAGE, "config", "cameras", "paper.yaml")
MAP = os.path.join(PACKAGE, "maps", "paper.yaml")


def text_of(path):
    """The text of a file."""
    with open(path, encoding="utf-8") as file:
        return file.read()


# The shipped map without names.
MAP_TEXT = re.sub(r"name: [^,]*, ", "", text_of(MAP))


class MapServicesTest(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.map_file = os.path.join(directory.name, "map.yaml")
        self.write(MAP_TEXT)
        for name, value in {"camera_file": CAMERA, "map_file": self.map_file,
                            "image_transport": "compressed", "queue_size": 100,
                            "publish_marker_tf": True, "drag_markers": True,
                            "initial_pose": [-1.4439, 2.9956, -2.1440]}.items():
            rospy.set_param("/localizer/" + name, value)
        node = subprocess.Popen(["rosrun", "omnitag", "localizer_node", "__name:=localizer",
                                 "image:=" + IMAGE_TOPIC])
        self.addCleanup(node.wait)
        self.addCleanup(node.terminate)
        rospy.wait_for_service("ignore_markers", 30.0)
        self.maps = Topic("marker_map", MapMarkerArray)
        self.harness = Harness("compressed")
        self.images = iter(self.harness.images)

    def write(self, text):
        """Edits the map file."""
        with open(self.map_file, "w", encoding="utf-8") as file:
            file.write(text)

    def localize(self):
        """The next image's status and detections; the pose must be there and right."""
        image = next(self.images)
        status = self.harness.localize(image)
        self.assertTrue(status.has_pose, status.remark)
        distance, _ = self.harness.errors(self.harness.poses.at(image.header.stamp))
        self.assertLess(distance, 0.02)
        return self.harness.detections.at(image.header.stamp).detections

    def call(self, name, service, *arguments, success=True):
        """What a service answers."""
        response = rospy.ServiceProxy(name, service)(*arguments)
        self.assertEqual(response.success, success, response.message)
        return response.message

    def newest_map(self, predicate):
        """The markers of the last message once that fulfils a condition."""
        self.assertTrue(wait_until(lambda: bool(self.maps.messages)
                                   and predicate(self.maps.messages[-1].markers)))
        return self.maps.messages[-1].markers

    def test_the_map_changes_while_the_robot_drives(self):
        count = len(load_marker_map(MAP).markers)
        markers = self.newest_map(lambda them: len(them) == count)
        used = [d.id for d in self.localize() if d.accepted]
        self.assertGreaterEqual(len(used), 4)
        self.check_detections_against(markers)

        # Ignored: never accepted, and last in the map.
        ignored = str(used[0])
        self.assertIn("ignored: " + ignored,
                      self.call("ignore_markers", IgnoreMarkers, [ignored]))
        last = self.newest_map(lambda them: them[-1].ignored)[-1]
        self.assertEqual(last.id, used[0])
        for _ in range(4):
            self.assertNotIn(used[0], [d.id for d in self.localize() if d.accepted])
        self.assertIn("no marker 'nobody'", self.call(
            "ignore_markers", IgnoreMarkers, ["nobody"], success=False))
        self.call("ignore_markers", IgnoreMarkers, [])

        # Removed, and added again at the same place with a name.
        self.assertIn("1 removed (tag36h11:{})".format(used[1]),
                      self.call("remove_marker", RemoveMarker, str(used[1])))
        self.assertNotIn(used[1], [d.id for d in self.localize() if d.accepted])
        place = next(m for m in markers if m.id == used[1])
        added = (used[1], "", "again", place.size, place.pose, 0.0, 0.0)
        self.assertIn("1 added (again)", self.call("add_marker", AddMarker, *added))
        self.assertIn("'again'", self.call("add_marker", AddMarker, *added, success=False))
        self.assertIn(used[1], [d.id for d in self.localize() if d.accepted])

        # A wrong file is refused, naming the line, and nothing is lost.
        self.write(MAP_TEXT + "  - {id: 500, position: [0, 0], yaw: 0}\n")
        refusal = self.call("reload_map", Trigger, success=False)
        line = text_of(self.map_file).count("\n")
        self.assertIn("{}:{}:".format(self.map_file, line), refusal)
        self.localize()
        self.write(MAP_TEXT + "  - {id: 500, position: [0, 0, 1], yaw: 0}\n")
        answer = self.call("reload_map", Trigger)
        self.assertIn("1 added (tag36h11:500)", answer)
        self.assertIn("2 unsaved changes kept", answer)
        self.localize()
        self.call("save_map", Trigger)
        saved = {marker.name for marker in load_marker_map(self.map_file).markers}
        self.assertIn("again", saved)

        # Another file.
        other = self.map_file + ".other"
        with open(other, "w", encoding="utf-8") as file:
            file.write(MAP_TEXT)
        self.assertIn("removed", self.call("change_map", ChangeMap, other))
        self.call("change_map", ChangeMap, other + ".none", success=False)
        self.newest_map(lambda them: len(them) == count)
        self.localize()
        self.drag(other)

    def check_detections_against(self, markers):
        """Checks what detections say besides their corners."""
        message = self.harness.detections.messages[-1]
        for detection in message.detections:
            self.assertEqual(detection.size, markers[detection.map_entry].size)
            self.assertGreater(detection.pose.covariance[0], 0.0)
            # In the optical frame, whose z axis is vertical in this rig, markers are to the side.
            position = detection.pose.pose.position
            distance = (position.x ** 2 + position.y ** 2) ** 0.5
            self.assertAlmostEqual(distance, detection.range, delta=0.03 * detection.range)
            u = sum(corner.x for corner in detection.corners) / 4 - 249.5
            v = sum(corner.y for corner in detection.corners) / 4 - 249.5
            self.assertGreater(u * position.x + v * position.y,
                               0.99 * distance * (u * u + v * v) ** 0.5)
        transforms = Topic("/tf_static", TFMessage)
        frames = {"marker_" + (marker.name or "tag36h11_{}".format(marker.id))
                  for marker in markers}
        self.assertTrue(wait_until(lambda: frames <= {
            transform.child_frame_id for sent in transforms.messages
            for transform in sent.transforms if transform.header.frame_id == "map"}))

    def drag(self, path):
        """A marker is moved with the mouse, and the map saved from its menu."""
        updates = Topic("edit_map/update_full", InteractiveMarkerInit)
        publisher = rospy.Publisher("edit_map/feedback", InteractiveMarkerFeedback, queue_size=1)
        self.assertTrue(wait_until(lambda: updates.messages and publisher.get_num_connections()))
        marker = load_marker_map(path).markers[0]
        feedback = InteractiveMarkerFeedback()
        feedback.client_id = "test"
        feedback.marker_name = "0 tag36h11:{}".format(marker.id)
        feedback.event_type = InteractiveMarkerFeedback.MOUSE_UP
        feedback.header.frame_id = "map"
        x, y, z = marker.position
        feedback.pose.position.x, feedback.pose.position.y = x + 0.25, y
        feedback.pose.position.z = z
        feedback.pose.orientation.w = 1.0
        publisher.publish(feedback)
        self.newest_map(lambda them: abs(them[0].pose.position.x - x - 0.25) < 1e-6)
        self.assertEqual(text_of(path), MAP_TEXT)
        feedback.event_type = InteractiveMarkerFeedback.MENU_SELECT
        feedback.menu_entry_id = 1
        publisher.publish(feedback)
        self.assertTrue(wait_until(lambda: text_of(path) != MAP_TEXT))
        moved = load_marker_map(path).markers[0]
        self.assertAlmostEqual(moved.position[0], x + 0.25, places=6)


if __name__ == "__main__":
    rospy.init_node("map_services_test")
    rostest.rosrun("omnitag", "map_services", MapServicesTest, sys.argv)
