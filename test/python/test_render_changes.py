"""What is only there for a while, and markers that the map is wrong about."""

import os
import unittest

from source_tree import FileTest

import numpy as np
from omnitag.marker_map import Marker, rotation_from_quaternion, rotation_from_yaw_and_roll
from omnitag.rendering.camera import CatadioptricCamera, Lens
from omnitag.rendering.mirror import ConicMirror
from omnitag.rendering.route import Frame
from omnitag.rendering.sequence import render_frames
from omnitag.rendering.world import load_world, present
from omnitag.tag_bitmap import tag_bitmap
from test_rendering import project

CAMERA = CatadioptricCamera(300, 280, Lens(590.0, 570.0, 157.3, 134.6),
                            ConicMirror(0.21, 0.0375, 0.04, 0.0))

MAP = """\
family: tag36h11
size: 0.8
markers:
  - {id: 3, name: east, position: [1.0, 0.0, 0.9], yaw: 3.1416}
  - {id: 4, name: north, position: [0.0, 1.0, 0.9], yaw: -1.5708, roll: 0.2}
  - {id: 5, name: desk, position: [0.0, -0.9, 0.6], orientation: [-0.382683, 0, 0, 0.92388]}
"""

WORLD = """\
marker_map: map.yaml
camera: {frame_id: eye, position: [0, 0, 1.1], orientation: [1, 0, 0, 0]}
images: {start: 100, noise: 0}
ambient: 1
lights: []
materials: [{name: paint, grey: 0.5}]
room: {x: [-2, 2], y: [-2, 2], height: 3, floor: paint, walls: paint, ceiling: paint}
boards: {thickness: 0.02, quiet_modules: 1, black: 0, white: 1, back: paint}
"""

START = 100 * 10**9
SECOND = 10**9


class WorldTest(FileTest):
    """A small room with three markers around the camera."""

    def setUp(self):
        super().setUp()
        self.write("map.yaml", MAP)

    def load(self, changes: str, map_path=None):
        return load_world(self.write("world.yaml", WORLD + changes), map_path)

    def hung(self, changes: str, moment: int = 0):
        return self.load(changes).hung_markers.at(moment)

    def refused(self, changes: str, *parts: str):
        with self.assert_error("world.yaml:9: ", *parts):
            self.load(changes)


class RenderedChangesTest(WorldTest):
    """Images of the room, against the exact projection of each marker's modules."""

    def render(self, changes: str, *seconds: int):
        world = self.load(changes)
        frames = [Frame(START + second * SECOND, 0.0, 0.0, 0.0) for second in seconds]
        return world, list(render_frames(world, CAMERA, frames, 1))

    def shows(self, world, image: np.ndarray, marker: Marker) -> bool:
        """Whether every module is in the image where the marker hangs."""
        bitmap = tag_bitmap(marker.family, marker.id)
        count = len(bitmap.modules)
        steps = (np.arange(count) - 0.5 * (count - 1)) * marker.size / bitmap.family.width_at_border
        x, y = np.meshgrid(steps, -steps)
        in_marker = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size), np.ones(x.size)])
        camera_from_marker = (np.linalg.inv(world.mounting.base_from_camera)
                              @ marker.map_from_marker)
        pixels = np.rint(project(CAMERA, (in_marker @ camera_from_marker.T)[:, :3])).astype(int)
        white = image[pixels[:, 1], pixels[:, 0]] > 0.5
        return np.array_equal(white.reshape(count, count), bitmap.modules)

    def shown(self, world, image: np.ndarray) -> list:
        """Of the mapped markers, those in the image where the map has them."""
        return [marker.name for marker in world.marker_map.markers
                if self.shows(world, image, marker)]

    def test_occluders_are_there_in_their_stretch(self):
        world, images = self.render(
            "furniture: [{shape: cylinder, position: [0.6, 0, 0], radius: 0.2, height: 2, "
            "material: paint, during: [[1, 2], [5, 5]]}]\n"
            "robot: [{shape: cylinder, position: [0, 0, 0.8], radius: 0.1, height: 0.4, "
            "material: paint, during: [[6, 9]]}]", 0, 2, 3, 5, 6)
        everything = ["east", "north", "desk"]
        self.assertEqual([self.shown(world, image) for image in images],
                         [everything, everything[1:], everything, everything[1:], []])

    def test_displaced_and_missing_markers_and_decoys(self):
        world, (before, after) = self.render(
            "displaced_markers: [{marker: east, position: [0.9, 0.5, 1.0], yaw: -2.6, "
            "during: [[1, 9]]}]\n"
            "missing_markers: [{marker: 1, during: [[1, 9]]}]\n"
            "decoys: [{id: 9, position: [-1.0, 0.6, 0.9], yaw: -0.5, size: 0.6, "
            "during: [[1, 9]]}]", 0, 1)
        self.assertEqual(self.shown(world, before), ["east", "north", "desk"])
        self.assertEqual(self.shown(world, after), ["desk"])
        displaced, decoy = np.eye(4), np.eye(4)
        displaced[:3, :3] = rotation_from_yaw_and_roll(-2.6)
        displaced[:3, 3] = 0.9, 0.5, 1.0
        decoy[:3, :3] = rotation_from_yaw_and_roll(-0.5)
        decoy[:3, 3] = -1.0, 0.6, 0.9
        for marker in (Marker(3, "tag36h11", "", 0.8, displaced),
                       Marker(9, "tag36h11", "", 0.6, decoy)):
            self.assertFalse(self.shows(world, before, marker))
            self.assertTrue(self.shows(world, after, marker))

    def test_moments_count_from_the_start_of_the_route(self):
        world = self.load("furniture: [{shape: box, position: [0, 1, 0], size: [1, 1, 1], "
                          "material: paint, during: [[0.5, 1]]}]")
        self.assertEqual([len(present(world.furniture, moment))
                          for moment in (499999999, 500000000, SECOND, SECOND + 1)], [0, 1, 1, 0])


class HungMarkersTest(WorldTest):
    """The markers in the room, as the world file says."""

    def test_nothing_said_is_the_map(self):
        world = self.load("")
        self.assertEqual(tuple(world.hung_markers.at(0)), world.marker_map.markers)

    def test_what_is_not_said_stays_as_mapped(self):
        changes = "displaced_markers: [{marker: north, %s}]"
        for change, position, yaw, roll in (
                ("position: [0.1, 1, 0.9]", (0.1, 1.0, 0.9), -1.5708, 0.2),
                ("yaw: -1.4", (0.0, 1.0, 0.9), -1.4, 0.2),
                ("roll: -3", (0.0, 1.0, 0.9), -1.5708, -3.0),
                ("roll: 0, yaw: 2", (0.0, 1.0, 0.9), 2.0, 0.0)):
            marker = self.hung(changes % change)[1]
            np.testing.assert_allclose(marker.position, position)
            np.testing.assert_allclose(marker.map_from_marker[:3, :3],
                                       rotation_from_yaw_and_roll(yaw, roll), atol=1e-12)

    def test_orientation(self):
        marker = self.hung("displaced_markers: [{marker: desk, orientation: [0, 0, 0.6, 0.8]}]")[2]
        np.testing.assert_allclose(marker.map_from_marker[:3, :3],
                                   rotation_from_quaternion(np.array([0.0, 0.0, 0.6, 0.8])))

    def test_missing_by_name_and_by_index(self):
        self.assertEqual([marker.name for marker in self.hung("missing_markers: [east, 2]")],
                         ["north"])

    def test_missing_wherever_it_was_moved_to(self):
        hung = self.hung("missing_markers: [0]\ndisplaced_markers: [{marker: 0, yaw: 3}]")
        self.assertEqual([marker.name for marker in hung], ["north", "desk"])

    def test_decoys_take_the_map_s_defaults(self):
        decoy = self.hung("decoys: [{id: 3, position: [1, 1, 1], yaw: 0}]")[3]
        self.assertEqual((decoy.id, decoy.family, decoy.size), (3, "tag36h11", 0.8))

    def test_another_map(self):
        other = self.write("other.yaml", MAP.replace("id: 3, name: east", "id: 8, name: door"))
        world = self.load("missing_markers: [north]", other)
        self.assertEqual([marker.id for marker in world.hung_markers.at(0)], [8, 5])
        with self.assert_error("world.yaml:9: missing_markers[0]", "name or the index", "east"):
            self.load("missing_markers: [east]", other)

    def test_wrong_changes(self):
        self.refused("displaced_markers: [{marker: west, yaw: 1}]",
                     "displaced_markers[0].marker", "name or the index", "west")
        self.refused("missing_markers: [3]", "missing_markers[0]", "0 to 2", "3")
        self.refused("displaced_markers: [{marker: 0}]", "displaced_markers[0]", "position", "none")
        self.refused("displaced_markers: [{marker: desk, yaw: 1}]", "displaced_markers[0]",
                     "not vertical")
        self.refused("displaced_markers: [{marker: 0, yaw: 1, orientation: [0, 0, 0, 1]}]",
                     "displaced_markers[0].yaw", "both")
        self.refused("decoys: [{id: 999, position: [0, 0, 1], yaw: 0}]", "decoys[0].id", "999")

    def test_wrong_stretches(self):
        for during, parts in (("[[3, 2]]", ("during[0]", "earlier", "[3, 2]")),
                              ("[3, 4]", ("during[0]", "2 numbers", "3")),
                              ("[]", ("during", "at least one", "empty")),
                              ("[[1, .nan]]", ("during[0][1]", "finite", "nan"))):
            self.refused("missing_markers: [{marker: 0, during: %s}]" % during,
                         "missing_markers[0].", *parts)


class RandomRouteTest(WorldTest):
    """The tool random_route."""

    FURNITURE = """\
furniture:
  - {shape: box, position: [0.9, -1.2, 0], yaw: 0.5, size: [0.8, 0.4, 0.5], material: paint}
  - {shape: cylinder, position: [-1.2, 1.2, 0], radius: 0.3, height: 1, material: paint}
  - {shape: box, position: [0, 0, 2.5], size: [4, 4, 0.1], material: paint}
"""

    def random_route(self, *options: str):
        return self.run_tool("random_route", "--world", self.world,
                             "--output", self.path("route.csv"), *options)

    def setUp(self):
        super().setUp()
        self.world = self.write("world.yaml", WORLD + self.FURNITURE)

    def test_poses_keep_their_distance(self):
        result = self.random_route("--count", "400", "--seed", "2", "--clearance", "0.3",
                                   "--interval", "0.5")
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(self.path("route.csv"), encoding="utf-8") as file:
            self.assertEqual(file.readline(), "stamp,x,y,yaw,jump\n")
            rows = np.loadtxt(file, delimiter=",")
        self.assertEqual(len(rows), 400)
        np.testing.assert_allclose(rows[:, 0], 0.5 * np.arange(400))
        self.assertEqual(rows[:, 4].tolist(), [0.0] + [1.0] * 399)
        places, yaw = rows[:, 1:3], rows[:, 3]
        self.assertLessEqual(np.abs(places).max(), 1.7)
        self.assertGreaterEqual(np.hypot(*(places - [-1.2, 1.2]).T).min(), 0.6)
        # Points all along the outlines; the boards are 1 m wide with their quiet zones.
        steps = np.linspace(-0.5, 0.5, 400)
        cosine, sine = np.cos(0.5), np.sin(0.5)
        box = np.concatenate([np.column_stack([0.8 * steps, np.full(400, side)])
                              for side in (-0.2, 0.2)])
        outlines = np.concatenate([box @ [[cosine, sine], [-sine, cosine]] + [0.9, -1.2],
                                   np.column_stack([np.full(400, 1.0), steps]),
                                   np.column_stack([steps, np.full(400, 1.0)])])
        distances = np.hypot(*(places[:, None] - outlines[None]).transpose(2, 0, 1)).min(axis=1)
        self.assertGreaterEqual(distances.min(), 0.3)
        self.assertLess(distances.min(), 0.32)
        # All headings: the mean of their directions is about zero.
        self.assertLess(np.hypot(np.cos(yaw).mean(), np.sin(yaw).mean()), 3.0 / np.sqrt(400.0))

    def test_seed(self):
        routes = []
        for seed in ("1", "1", "2"):
            self.random_route("--count", "3", "--seed", seed)
            with open(self.path("route.csv"), encoding="utf-8") as file:
                routes.append(file.read())
        self.assertEqual(routes[0], routes[1])
        self.assertNotEqual(routes[0], routes[2])

    def test_no_space(self):
        self.assert_refused(self.random_route("--count", "1", "--clearance", "2.5"),
                            "world.yaml", "free space", "2.5 m", "none")
        self.assertFalse(os.path.exists(self.path("route.csv")))


if __name__ == "__main__":
    unittest.main()
