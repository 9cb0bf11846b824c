"""The tool disturb_files."""

import os
import unittest

from source_tree import FileTest

import numpy as np
from omnitag.disturbance import MapDeviations, displaced
from omnitag.marker_map import MarkerMap, load_marker_map
from omnitag.rendering.camera import load_camera

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
MAP = os.path.join(ROOT, "maps", "fisheye.yaml")
CAMERA = os.path.join(ROOT, "config", "cameras", "hyperbolic.yaml")
FISHEYE = os.path.join(ROOT, "config", "cameras", "fisheye.yaml")


class DisturbFilesTest(FileTest):
    def disturb(self, *arguments):
        return self.run_tool("disturb_files", *arguments)

    def text(self, name):
        with open(self.path(name), encoding="utf-8") as file:
            return file.read()

    def disturbed_map(self, *options):
        result = self.disturb("--map", MAP, "--output-map", self.path("off.yaml"), *options)
        self.assertEqual(result.returncode, 0, result.stderr)
        return load_marker_map(self.path("off.yaml"))

    def disturbed_camera(self, *options):
        result = self.disturb("--camera", CAMERA, "--output-camera", self.path("c.yaml"), *options)
        self.assertEqual(result.returncode, 0, result.stderr)
        return load_camera(self.path("c.yaml"))

    def test_map_without_errors_is_the_map(self):
        true, written = load_marker_map(MAP), self.disturbed_map()
        self.assertEqual(written.frame_id, true.frame_id)
        for before, after in zip(true.markers, written.markers):
            self.assertEqual((after.id, after.family, after.name, after.size),
                             (before.id, before.family, before.name, before.size))
            np.testing.assert_allclose(after.map_from_marker, before.map_from_marker, atol=2e-6)
        self.assertNotIn("deviation", self.text("off.yaml"))

    def test_markers_are_displaced_as_asked_for(self):
        marker = load_marker_map(MAP).markers[-1]
        markers = MarkerMap((marker,) * 3000)
        off = displaced(markers, MapDeviations(0.005, 0.0175), 3)
        steps = np.array([m.position - marker.position for m in off.markers])
        np.testing.assert_allclose(steps.std(axis=0), 0.005, rtol=0.06)
        turns = [marker.map_from_marker[:3, :3].T @ m.map_from_marker[:3, :3]
                 for m in off.markers]
        vectors = 0.5 * np.array([(t[2, 1] - t[1, 2], t[0, 2] - t[2, 0], t[1, 0] - t[0, 1])
                                  for t in turns])
        np.testing.assert_allclose(vectors.std(axis=0), 0.0175, rtol=0.06)
        np.testing.assert_allclose(turns[7] @ turns[7].T, np.eye(3), atol=1e-12)

    def test_seed_and_what_is_said(self):
        options = ("--deviation", "0.005", "--orientation-deviation", "0.02")
        first = self.disturbed_map(*options)
        again = self.disturbed_map(*options, "--say")
        self.assertIn("\ndeviation: 0.005\norientation_deviation: 0.02\n", self.text("off.yaml"))
        other = self.disturbed_map(*options, "--seed", "1")
        np.testing.assert_array_equal(first.markers[3].position, again.markers[3].position)
        self.assertTrue(np.all(first.markers[3].position != other.markers[3].position))

    def test_exact_camera(self):
        true = load_camera(CAMERA)
        camera = self.disturbed_camera("--principal-point", "-0.5", "--scale", "0.01", "--apex",
                                       "0.0002", "--exact")
        np.testing.assert_allclose(camera.lens, [1.01 * 1480.0, 1.01 * 1480.0, 511.0, 383.0])
        self.assertAlmostEqual(camera.mirror.apex_distance, true.mirror.apex_distance + 0.0002)
        self.assertEqual(camera.mirror.rim_radius, true.mirror.rim_radius)
        self.assertNotIn("uncertainty", self.text("c.yaml"))

    def test_drawn_camera(self):
        true = load_camera(CAMERA)
        cameras = [self.disturbed_camera("--principal-point", "0.5", "--seed", seed)
                   for seed in ("1", "1", "2")]
        self.assertEqual(cameras[0], cameras[1])
        self.assertNotEqual(cameras[0], cameras[2])
        off = np.array(cameras[0].lens) - true.lens
        self.assertEqual(off[:2].tolist(), [0.0, 0.0])
        self.assertTrue(np.all((np.abs(off[2:]) > 0.0) & (np.abs(off[2:]) < 2.0)))
        self.assertEqual(cameras[0].mirror, true.mirror)

    def test_camera_says_pixels(self):
        self.disturbed_camera("--principal-point", "0.5", "--scale", "0.001", "--say")
        self.assertIn("\nuncertainty: {principal_point: 0.5, scale: 0.384, tilt: 0, rim: 0}\n",
                      self.text("c.yaml"))

    def test_block_of_uncertainty_is_dropped(self):
        with open(CAMERA, encoding="utf-8") as file:
            text = file.read().replace("uncertainty: none   #", "uncertainty:\n  rim: 0.1  #")
        camera = self.write("camera.yaml", text)
        result = self.disturb("--camera", camera, "--output-camera", self.path("c.yaml"))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(load_camera(self.path("c.yaml")), load_camera(CAMERA))

    def test_wrong_files(self):
        output = ("--output-camera", self.path("c.yaml"))
        self.assert_refused(self.disturb("--camera", FISHEYE, "--apex", "0.001", *output),
                            "fisheye.yaml:", "mirror", "none")
        self.assert_refused(self.disturb("--camera", self.path("none.yaml"), *output),
                            "none.yaml", "No such file")
        self.assert_refused(self.disturb("--map", CAMERA, "--output-map", self.path("m.yaml")),
                            "hyperbolic.yaml:", "model", "unknown key")
        self.assertEqual(os.listdir(self.directory), [])

    def test_wrong_arguments(self):
        for arguments in ((), ("--map", MAP), ("--output-camera", "c.yaml"),
                          ("--map", MAP, "--output-map", "m.yaml", "--deviation", "-1"),
                          ("--camera", CAMERA, "--output-camera", "c.yaml", "--scale", "-1")):
            result = self.disturb(*arguments)
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assertIn("expected", result.stderr)


if __name__ == "__main__":
    unittest.main()
