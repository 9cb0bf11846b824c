#!/usr/bin/env python3
"""What a wrong parameter or file does to the node, and to a nodelet and its manager."""

import os
import re
import subprocess
import sys
import tempfile
import unittest

import rospy
import rostest
from harness import PACKAGE, TIMEOUT, wait_until

CAMERA = os.path.join(PACKAGE, "config", "cameras", "paper.yaml")
MAP = os.path.join(PACKAGE, "maps", "paper.yaml")
GOOD = {"camera_file": CAMERA, "map_file": MAP}


def run(*command):
    """Runs a command to its end; the result has its output."""
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=TIMEOUT,
                          universal_newlines=True, check=False)


class BadParametersTest(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.directory = directory.name

    def write(self, name, text):
        path = os.path.join(self.directory, name)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return path

    def cases(self):
        with open(MAP, encoding="utf-8") as file:
            good_map = file.read()
        with open(CAMERA, encoding="utf-8") as file:
            good_camera = file.read()
        bad_map = self.write("map.yaml", re.sub("(?m)^size: .*$", "size: -1", good_map))
        sizeless_map = self.write("sizeless.yaml",
                                  "frame_id: map\nfamily: tag36h11\nmarkers:\n"
                                  "  - {id: 3, position: [1, 2, 3], yaw: 0, size: 0.3}\n")
        bad_camera = self.write("camera.yaml", good_camera.replace("spherical", "conical"))
        return [
            ({}, "/bad: map_file: expected the path of a file, found nothing"),
            ({"camera_file": CAMERA}, "/bad: map_file: expected the path of a file, found nothing"),
            ({"camera_file": "/no/such.yaml", "map_file": MAP},
             "/no/such.yaml: expected a readable file, found none"),
            ({"camera_file": bad_camera, "map_file": MAP}, bad_camera + ":"),
            ({"camera_file": CAMERA, "map_file": bad_map}, bad_map + ":"),
            ({"camera_file": CAMERA, "map_file": CAMERA}, CAMERA),
            ({**GOOD, "map_fram": "map"}, "/bad: map_fram: unknown key"),
            ({**GOOD, "initial_pose": [1.0, 2.0]}, "/bad: initial_pose: expected [x, y, yaw]"),
            ({**GOOD, "initial_pose": "[1.0, .nan, 0]"}, "/bad: initial_pose: expected"),
            ({**GOOD, "queue_size": "many"}, "/bad: queue_size: expected an integer"),
            ({**GOOD, "image_transport": "pigeon"}, "/bad: image_transport: expected one of"),
            ({"map_file": MAP, "image_transport": "pigeon"},
             "/bad: image_transport: expected one of"),
            ({"map_file": sizeless_map, "mapping": True},
             sizeless_map + ": mapping needs the size"),
            ({**GOOD, "motion": {"max_speed": 1.0}}, "/bad: motion.max_speed: unknown key"),
        ]

    def set_parameters(self, parameters):
        if rospy.has_param("/bad"):
            rospy.delete_param("/bad")
        for name, value in parameters.items():
            rospy.set_param("/bad/" + name, value)

    def test_node_ends_with_one_line(self):
        for parameters, line in self.cases():
            self.set_parameters(parameters)
            result = run("rosrun", "omnitag", "localizer_node", "__name:=bad")
            self.assertEqual(result.returncode, 1, result.stdout)
            self.assertIn(line, result.stdout)
            self.assertEqual(len(result.stdout.splitlines()), 1, result.stdout)

    def test_standalone_nodelet_ends(self):
        parameters, line = self.cases()[2]
        self.set_parameters(parameters)
        result = run("rosrun", "nodelet", "nodelet", "standalone", "omnitag/LocalizerNodelet",
                     "__name:=bad")
        self.assertNotEqual(result.returncode, 0)
        self.assertIn(line, result.stdout)

    def test_manager_survives(self):
        log = open(os.path.join(self.directory, "manager.log"), "w+", encoding="utf-8")
        self.addCleanup(log.close)
        manager = subprocess.Popen(["rosrun", "nodelet", "nodelet", "manager", "__name:=manager"],
                                   stdout=log, stderr=subprocess.STDOUT)
        self.addCleanup(manager.wait)
        self.addCleanup(manager.terminate)
        rospy.wait_for_service("/manager/load_nodelet", TIMEOUT)

        for parameters, line in self.cases()[:3]:
            self.set_parameters(parameters)
            result = run("rosrun", "nodelet", "nodelet", "load", "omnitag/LocalizerNodelet",
                         "manager", "__name:=bad")
            self.assertNotEqual(result.returncode, 0)
            log.seek(0)
            self.assertIn(line, log.read())
            self.assertIsNone(manager.poll())

        self.set_parameters(GOOD)
        for _ in range(5):
            loader = subprocess.Popen(["rosrun", "nodelet", "nodelet", "load",
                                       "omnitag/LocalizerNodelet", "manager", "__name:=bad"],
                                      stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            self.assertTrue(wait_until(self.is_loaded))
            result = run("rosrun", "nodelet", "nodelet", "unload", "/bad", "manager")
            self.assertEqual(result.returncode, 0, result.stdout)
            loader.terminate()
            loader.wait()
            self.assertTrue(wait_until(lambda: not self.is_loaded()))
            self.assertIsNone(manager.poll())

    @staticmethod
    def is_loaded():
        """Whether the localizer in the manager offers its services."""
        return "/save_map" in run("rosservice", "list").stdout.split()


if __name__ == "__main__":
    rospy.init_node("bad_parameters_test")
    rostest.rosrun("omnitag", "bad_parameters", BadParametersTest, sys.argv)
