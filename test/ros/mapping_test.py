#!/usr/bin/env python3
"""The node maps markers that its map does not have, and saves them on request."""

import os
import subprocess
import sys
import tempfile
import unittest

import numpy as np
import rospy
import rostest
from harness import IMAGE_TOPIC, PACKAGE, Harness, Topic
from omnitag.marker_map import load_marker_map
from std_srvs.srv import Trigger
from visualization_msgs.msg import MarkerArray

CAMERA = os.path.join(PACKAGE, "config", "cameras", "paper.yaml")
MAP = os.path.join(PACKAGE, "maps", "paper.yaml")
SEED_IDS = (0, 1, 7, 8, 9, 10, 11)
COMMENT = "# measured by hand\n"
IMAGES = 30


def seed_text():
    """The shipped map with some of its markers, and an additional comment."""
    with open(MAP, encoding="utf-8") as file:
        lines = file.readlines()
    seeds = tuple("  - {{id: {},".format(marker_id) for marker_id in SEED_IDS)
    return "".join(line for line in lines
                   if not line.startswith("  - ") or line.startswith(seeds)) + COMMENT


class MappingTest(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.map_file = os.path.join(directory.name, "map.yaml")
        with open(self.map_file, "w", encoding="utf-8") as file:
            file.write(seed_text())
        for name, value in {"camera_file": CAMERA, "map_file": self.map_file, "mapping": True,
                            "image_transport": "compressed", "queue_size": 100,
                            "initial_pose": [-1.4439, 2.9956, -2.1440]}.items():
            rospy.set_param("/mapper/" + name, value)
        node = subprocess.Popen(["rosrun", "omnitag", "localizer_node", "__name:=mapper",
                                 "image:=" + IMAGE_TOPIC])
        self.addCleanup(node.wait)
        self.addCleanup(node.terminate)

    def read_map(self):
        """The map file's text."""
        with open(self.map_file, encoding="utf-8") as file:
            return file.read()

    def test_saves_what_it_has_mapped(self):
        save = rospy.ServiceProxy("save_map", Trigger)
        save.wait_for_service(30.0)
        response = save()
        self.assertTrue(response.success)
        self.assertIn("has all already", response.message)
        self.assertEqual(self.read_map(), seed_text())

        markers = Topic("markers", MarkerArray)
        harness = Harness("compressed")
        for image in harness.images[:IMAGES]:
            self.assertIsNotNone(harness.localize(image))

        response = save()
        self.assertTrue(response.success, response.message)
        # The old text is still there, and the old file is kept beside it.
        text = self.read_map()
        without_new = "".join(line for line in text.splitlines(True) if "mapped:" not in line)
        self.assertEqual(without_new, seed_text())
        with open(self.map_file + "~", encoding="utf-8") as file:
            self.assertEqual(file.read(), seed_text())
        truth = {marker.id: marker for marker in load_marker_map(MAP).markers}
        added = [m for m in load_marker_map(self.map_file).markers if m.id not in SEED_IDS]
        self.assertGreaterEqual(len(added), 2)
        for marker in added:
            distance = np.linalg.norm(marker.position - truth[marker.id].position)
            self.assertLess(distance, 0.02, marker.id)

        # RViz shows their names, too.
        names = {shape.text for message in markers.messages for shape in message.markers
                 if shape.ns == "names"}
        self.assertTrue({str(marker.id) for marker in added} <= names, names)

        # Saved markers are not saved again.
        self.assertIsNotNone(harness.localize(harness.images[IMAGES]))
        save()
        again = load_marker_map(self.map_file).markers
        self.assertEqual(len({marker.id for marker in again}), len(again))


if __name__ == "__main__":
    rospy.init_node("mapping_test")
    rostest.rosrun("omnitag", "mapping", MappingTest, sys.argv)
