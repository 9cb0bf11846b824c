"""Pictures of the robot: the mirror's mesh, and the film of a drive."""

import os
import struct
import unittest

import cv2
import numpy as np
import PIL
from PIL import Image
from source_tree import FileTest

from omnitag.film import BLUE, GREEN, YELLOW, FilmFrame, film_pictures, write_gif
from omnitag.marker_map import load_marker_map
from omnitag.mirror_mesh import mirror_triangles
from omnitag.rendering.mirror import ConicMirror

CAMERAS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "config", "cameras")
MAP = """\
frame_id: map
family: tag36h11
size: 0.4
markers:
  - {id: 1, position: [2.0, 0.0, 1.0], yaw: 3.14159265}
  - {id: 2, position: [-2.0, 0.0, 1.0], yaw: 0.0}
  - {id: 3, position: [0.0, 2.0, 1.0], yaw: -1.57079633}
  - {id: 4, position: [0.0, -2.0, 1.0], yaw: 1.57079633}
"""


class MirrorMeshTest(FileTest):
    def test_a_sphere(self):
        radius, rim, apex = 0.05, 0.04, 0.2
        triangles = mirror_triangles(ConicMirror(apex, rim, radius, 0.0))
        depth = radius - np.sqrt(radius ** 2 - rim ** 2)
        points = triangles.reshape(-1, 3)
        mirror = points[points[:, 2] <= apex + depth + 1e-9]
        self.assertGreater(len(mirror), 1000)
        distances = np.linalg.norm(mirror - [0.0, 0.0, apex + radius], axis=1)
        np.testing.assert_allclose(distances, radius, atol=1e-12)

        # Closed, with its faces outward: the volume about it is what a cap leaves of a cylinder.
        volume = np.linalg.det(triangles).sum() / 6.0
        thickness = points[:, 2].max() - apex - depth
        cap = np.pi * depth * (3.0 * rim ** 2 + depth ** 2) / 6.0
        expected = cap + np.pi * rim ** 2 * thickness
        self.assertAlmostEqual(volume / expected, 1.0, 1)

    def test_tool(self):
        output = self.path("mirror.stl")
        result = self.run_tool("mirror_mesh", "--camera", os.path.join(CAMERAS, "paper.yaml"),
                               "--output", output)
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(output, "rb") as file:
            data = file.read()
        (count,) = struct.unpack("<I", data[80:84])
        self.assertEqual(len(data), 84 + 50 * count)
        normal = np.frombuffer(data, "<f4", 3, 84)
        self.assertLess(normal[2], -0.9)  # at the apex, toward the lens

        result = self.run_tool("mirror_mesh", "--camera", os.path.join(CAMERAS, "fisheye.yaml"),
                               "--output", output)
        self.assert_refused(result, "fisheye.yaml", "catadioptric")


class FilmTest(FileTest):
    def setUp(self):
        super().setUp()
        self.map = load_marker_map(self.write("map.yaml", MAP))
        debug_image = np.zeros((100, 80, 3), np.uint8)
        self.frames = [FilmFrame(i, debug_image, (-1.0 + i, 1.0, 0.0), [0] if i == 2 else [])
                       for i in range(3)]

    def pixels(self, picture, colour):
        """Where the map beside the image has that colour; x and y as in the map."""
        rows, columns = np.nonzero(np.all(picture[:, 160:] == colour, axis=2))
        # The map is 4 m and two margins of 0.5 m wide.
        return np.column_stack([columns - 100.0, 100.0 - rows]) / (200.0 / 5.0)

    def test_pictures(self):
        pictures = film_pictures(self.frames, self.map, None, 200)
        self.assertEqual([picture.shape for picture in pictures], 3 * [(200, 360, 3)])
        for frame, picture in zip(self.frames, pictures):
            np.testing.assert_allclose(np.mean(self.pixels(picture, YELLOW), axis=0),
                                       frame.pose[:2], atol=0.1)
        self.assertEqual(len(self.pixels(pictures[1], GREEN)), 0)
        way = self.pixels(pictures[2], BLUE)
        self.assertAlmostEqual(way[:, 0].min(), -1.0, 1)
        # The line of sight ends at the marker.
        sight = self.pixels(cv2.medianBlur(pictures[2], 1), GREEN)
        self.assertGreater(len(sight), 0)

    def test_gif(self):
        pictures = film_pictures(self.frames, self.map, None, 200)
        write_gif(self.path("film.gif"), pictures, 5.0)
        with Image.open(self.path("film.gif")) as film:
            self.assertEqual((film.n_frames, film.size, film.info["duration"]),
                             (3, (360, 200), 200))
            # Pillow before version 9 does not read the later pictures of a film rightly.
            last_read = 2 if int(PIL.__version__.split(".")[0]) >= 9 else 0
            film.seek(last_read)
            last = np.asarray(film.convert("RGB")).astype(float)
        self.assertLess(np.abs(last[:, :, ::-1] - pictures[last_read]).mean(), 3.0)

    def test_bad_input(self):
        self.assert_refused(
            self.run_tool("make_film", "--bag", "x.bag", "--map", "m.yaml", "--output", "f.gif",
                          "--every", "0"), "--every", "more than 0")


if __name__ == "__main__":
    unittest.main()
