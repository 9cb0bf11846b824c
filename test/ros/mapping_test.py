#!/usr/bin/env python3
"""The node maps markers that its map does not have, refines those that it has, and saves both."""

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

    def start(self, **parameters):
        """The node, with the map file, which must be there."""
        for name, value in {"camera_file": CAMERA, "map_file": self.map_file,
                            "image_transport": "compressed", "queue_size": 100,
                            "initial_pose": [-1.4439, 2.9956, -2.1440], **parameters}.items():
            rospy.set_param("/mapper/" + name, value)
        self.addCleanup(rospy.delete_param, "/mapper")
        node = subprocess.Popen(["rosrun", "omnitag", "localizer_node", "__name:=mapper",
                                 "image:=" + IMAGE_TOPIC])
        self.addCleanup(node.wait)
        self.addCleanup(node.terminate)
        save = rospy.ServiceProxy("save_map", Trigger)
        save.wait_for_service(30.0)
        return save

    def write_map(self, text):
        with open(self.map_file, "w", encoding="utf-8") as file:
            file.write(text)

    def read_map(self):
        """The map file's text."""
        with open(self.map_file, encoding="utf-8") as file:
            return file.read()

    def test_saves_what_it_has_mapped(self):
        self.write_map(seed_text())
        save = self.start(mapping=True)
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

    def test_saves_what_it_has_refined(self):
        subprocess.run([os.path.join(PACKAGE, "tools", "disturb_files"), "--map", MAP, "--output-map",
                        self.map_file, "--deviation", "0.005", "--orientation-deviation", "0.0175",
                        "--seed", "5", "--say"], check=True, stdout=subprocess.DEVNULL)
        save = self.start(refine_map=True)
        truth = [marker.position for marker in load_marker_map(MAP).markers]

        def spread(marker_map):
            errors = [marker.position - true for marker, true in zip(marker_map.markers, truth)]
            return np.linalg.norm(np.subtract(errors, np.mean(errors, axis=0)))

        before = load_marker_map(self.map_file)
        harness = Harness("compressed")
        for image in harness.images[:IMAGES]:
            self.assertIsNotNone(harness.localize(image))
        response = save()
        self.assertTrue(response.success, response.message)
        self.assertIn("refined in " + self.map_file, response.message)
        saved = load_marker_map(self.map_file)
        # Some have not been seen yet.
        self.assertLess(spread(saved), 0.8 * spread(before))

        # It goes on from there, and writes nothing that somebody changed meanwhile.
        with open(self.map_file, encoding="utf-8") as file:
            lines = file.readlines()
        first = next(i for i, line in enumerate(lines) if line.startswith("  - {id: 0,"))
        lines[first] = "  - {id: 0, position: [-3.4, 4.4, 1.3], yaw: -1.5707963}\n"
        self.write_map("".join(lines))
        for image in harness.images[IMAGES:IMAGES + 10]:
            self.assertIsNotNone(harness.localize(image))
        response = save()
        self.assertTrue(response.success, response.message)
        with open(self.map_file, encoding="utf-8") as file:
            self.assertIn(lines[first], file.read())
        self.assertLess(spread(load_marker_map(self.map_file)), 1.5 * spread(saved) + 0.2)


if __name__ == "__main__":
    rospy.init_node("mapping_test")
    rostest.rosrun("omnitag", "mapping", MappingTest, sys.argv)
