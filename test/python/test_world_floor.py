"""The tool world_floor."""

import os
import unittest

from source_tree import FileTest

import cv2
import numpy as np
import yaml

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
ROOMS = os.path.join(ROOT, "worlds", "rooms.yaml")


class WorldFloorTest(FileTest):
    def cells(self, *options):
        """A function that gives the grey level at a place of the map."""
        result = self.run_tool("world_floor", "--world", ROOMS, "--output",
                               self.path("floor.yaml"), *options)
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(self.path("floor.yaml"), encoding="utf-8") as file:
            floor = yaml.safe_load(file)
        image = cv2.imread(self.path(floor["image"]), cv2.IMREAD_GRAYSCALE)

        def at(x, y):
            column = int((x - floor["origin"][0]) // floor["resolution"])
            row = int((y - floor["origin"][1]) // floor["resolution"])
            return image[image.shape[0] - 1 - row, column]
        return at

    def test_what_stands_in_the_way(self):
        at = self.cells()
        self.assertEqual(at(-2.0, 0.0), 254)
        self.assertEqual(at(0.0, 0.5), 254, "the doorway")
        self.assertEqual(at(0.0, -1.0), 0, "the wall beside it")
        self.assertEqual(at(-4.6, -2.2), 0, "the cupboard")
        self.assertEqual(at(4.2, -1.9), 0, "the pillar")
        self.assertEqual(at(3.4, -0.8), 254, "the table, which is lower than 1 m")
        self.assertEqual(at(-5.02, 0.0), 0, "the outer wall")
        self.assertEqual(at(-5.08, 0.0), 205, "beyond it")
        self.assertEqual(at(-2.5, 5.0), 254, "the empty part")
        self.assertEqual(self.cells("--height", "0.72")(3.4, -0.8), 0, "the table")

    def test_what_cannot_be_reached_is_unknown(self):
        at = self.cells("--from=-2,0")
        self.assertEqual(at(-2.5, 5.0), 205)
        self.assertEqual(at(2.0, 5.0), 254)

    def test_the_shipped_floor_is_that_of_the_world(self):
        self.cells("--from=-2,0")
        worlds = os.path.join(ROOT, "worlds")
        with open(self.path("floor.yaml"), encoding="utf-8") as made, \
                open(os.path.join(worlds, "rooms_floor.yaml"), encoding="utf-8") as shipped:
            self.assertEqual(made.read().replace("floor.png", "rooms_floor.png"), shipped.read())
        np.testing.assert_array_equal(
            cv2.imread(self.path("floor.png"), cv2.IMREAD_UNCHANGED),
            cv2.imread(os.path.join(worlds, "rooms_floor.png"), cv2.IMREAD_UNCHANGED))

    def test_the_world_is_not_overwritten(self):
        self.assert_refused(
            self.run_tool("world_floor", "--world", ROOMS, "--output", ROOMS), "would be overwritten")

    def test_bad_input(self):
        self.assert_refused(
            self.run_tool("world_floor", "--world", ROOMS, "--output", self.path("floor.yaml"),
                          "--from=0,-1"), "--from: expected a free place, found 0,-1")
        self.assertEqual(os.listdir(self.directory), [])


if __name__ == "__main__":
    unittest.main()
