"""Rendered images against geometry that is computed another way."""

import unittest

import source_tree  # noqa: F401, puts the package on the path

import numpy as np
from omnitag.marker_map import Marker, rotation_from_yaw_and_roll
from omnitag.rendering.camera import CatadioptricCamera, FisheyeCamera, Lens, canvas_of
from omnitag.rendering.mirror import ConicMirror, TabulatedMirror
from omnitag.rendering.optics import camera_scene
from omnitag.rendering.povray import matrix, render
from omnitag.rendering.scene import marker_bitmaps, marker_scene
from omnitag.rendering.effects import grey_levels
from omnitag.rendering.world import Boards, Material
from omnitag.tag_bitmap import tag_bitmap

HEADER = "#version 3.7;\nglobal_settings { assumed_gamma 1.0 }\nbackground { rgb 0 }\n"
GOLDEN_RATIO = 0.5 * (np.sqrt(5.0) - 1.0)


def project(camera: CatadioptricCamera, points: np.ndarray) -> np.ndarray:
    """Pixels (n, 2) of points (n, 3) in the optical frame, by Fermat's principle.

    Light takes the shortest way from the point over the mirror to the pinhole; the point on the
    mirror lies in the plane through the axis. Golden section search over its distance off the axis.
    """
    mirror, lens = camera.mirror, camera.lens
    distance = np.hypot(points[:, 0], points[:, 1])

    def path_length(rho: np.ndarray) -> np.ndarray:
        z = mirror.apex_distance + mirror.sag(rho)
        return np.hypot(rho, z) + np.hypot(distance - rho, points[:, 2] - z)

    lower, upper = np.zeros(len(points)), np.full(len(points), mirror.rim_radius)
    for _ in range(60):
        left = upper - GOLDEN_RATIO * (upper - lower)
        right = lower + GOLDEN_RATIO * (upper - lower)
        shorter = path_length(left) < path_length(right)
        upper, lower = np.where(shorter, right, upper), np.where(shorter, lower, left)
    rho = 0.5 * (lower + upper)
    slope = rho / (mirror.apex_distance + mirror.sag(rho))
    return np.column_stack([lens.cx + lens.fx * slope * points[:, 0] / distance,
                            lens.cy + lens.fy * slope * points[:, 1] / distance])


def polygon_centroid(vertices: np.ndarray) -> np.ndarray:
    """Centroid of the area within a closed polygon (n, 2)."""
    following = np.roll(vertices, -1, axis=0)
    cross = vertices[:, 0] * following[:, 1] - following[:, 0] * vertices[:, 1]
    return ((vertices + following) * cross[:, None]).sum(axis=0) / (3.0 * cross.sum())


def facing(direction: np.ndarray, position: np.ndarray) -> np.ndarray:
    """(4, 4) transform of a body at `position` whose z axis points along `direction`."""
    z = direction / np.linalg.norm(direction)
    x = np.cross([0.3, 0.5, 0.8], z)
    x /= np.linalg.norm(x)
    transform = np.eye(4)
    transform[:3, :3] = np.column_stack([x, np.cross(z, x), z])
    transform[:3, 3] = position
    return transform


def reflect(mirror, azimuth: float, rim_share: float):
    """A point of the mirror and the direction of what is seen there, in the optical frame."""
    rho, step = rim_share * mirror.rim_radius, 1e-6
    slope = (mirror.sag(rho + step) - mirror.sag(rho - step)) / (2.0 * step)
    outward = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
    on_mirror = rho * outward + [0.0, 0.0, mirror.apex_distance + mirror.sag(rho)]
    normal = (slope * outward - [0.0, 0.0, 1.0]) / np.hypot(slope, 1.0)
    incoming = on_mirror / np.linalg.norm(on_mirror)
    return on_mirror, incoming - 2.0 * (incoming @ normal) * normal


def camera_with(mirror) -> CatadioptricCamera:
    """A small camera whose pixels are not square and whose axis is off the middle."""
    return CatadioptricCamera(300, 280, Lens(590.0, 570.0, 157.3, 134.6), mirror)


SPHERE = ConicMirror(0.21, 0.0375, 0.04, 0.0)
HYPERBOLOID = ConicMirror(0.15, 0.035, 0.02, -2.3)
ASPHERE = ConicMirror(0.21, 0.036, 0.045, -0.6, (900.0, -1.5e5))
TABLE = TabulatedMirror(0.21, 0.036, tuple(
    (rho, float(ASPHERE.sag(rho))) for rho in np.linspace(0.0, 0.04, 9)))

# A camera that hangs askew, so that no axis of it is an axis of the map.
MAP_FROM_CAMERA = facing(np.array([0.15, -0.1, -1.0]), np.array([0.4, -0.7, 1.2]))


class MirrorProfileTest(unittest.TestCase):
    """Sags."""

    def test_sphere_keeps_its_distance_from_its_centre(self):
        rho = np.linspace(0.0, SPHERE.rim_radius, 20)
        np.testing.assert_allclose(np.hypot(rho, 0.04 - SPHERE.sag(rho)), 0.04, atol=1e-15)

    def test_table_goes_through_its_samples(self):
        for rho, sag in TABLE.samples:
            self.assertAlmostEqual(float(TABLE.sag(rho)), sag, delta=1e-15)

    def test_table_of_a_paraboloid_is_the_paraboloid(self):
        paraboloid = ConicMirror(0.2, 0.03, 0.04, -1.0)
        table = TabulatedMirror(0.2, 0.03, tuple(
            (rho, float(paraboloid.sag(rho))) for rho in (0.0, 0.004, 0.013, 0.02, 0.031)))
        rho = np.linspace(0.0, 0.03, 50)
        np.testing.assert_allclose(table.sag(rho), paraboloid.sag(rho), atol=1e-15)


class DotsInTheMirrorTest(unittest.TestCase):
    """Images of small glowing discs at known places."""

    TOLERANCE = 0.02  # px

    def check(self, mirror):
        camera = camera_with(mirror)
        scene = HEADER + camera_scene(camera, MAP_FROM_CAMERA)
        expected = []
        for index in range(8):
            azimuth = 0.3 + index * np.pi / 4.0
            seen_at, direction = reflect(mirror, azimuth, (0.5, 0.65, 0.8)[index % 3])
            radius = 0.8 + 0.3 * index
            camera_from_disc = facing(-direction, seen_at + radius * direction)
            disc_radius = 0.07 * radius
            scene += (f"disc {{ <0, 0, 0>, z, {1000.0 * disc_radius} pigment {{ rgb 1 }} "
                      f"finish {{ emission rgb 1 ambient 0 diffuse 0 }} "
                      f"{matrix(MAP_FROM_CAMERA @ camera_from_disc)} }}\n")
            angles = np.linspace(0.0, 2.0 * np.pi, 200, endpoint=False)
            edge = disc_radius * np.column_stack(
                [np.cos(angles), np.sin(angles), np.zeros_like(angles)])
            in_camera = edge @ camera_from_disc[:3, :3].T + camera_from_disc[:3, 3]
            expected.append(polygon_centroid(project(camera, in_camera)))
        image = render(scene, {}, camera.width, camera.height, samples=9)

        rows, columns = np.mgrid[:camera.height, :camera.width]
        distances = np.stack([np.hypot(columns - u, rows - v) for u, v in expected])
        for index, centroid in enumerate(expected):
            near = (distances.argmin(axis=0) == index) & (distances[index] < 25.0)
            weights = image * near
            self.assertGreater(weights.sum(), 15.0)
            found = np.array([(weights * columns).sum(), (weights * rows).sum()]) / weights.sum()
            self.assertLess(np.abs(found - centroid).max(), self.TOLERANCE)

    def test_spherical(self):
        self.check(SPHERE)

    def test_hyperbolic(self):
        self.check(HYPERBOLOID)

    def test_parabolic(self):
        self.check(ConicMirror(0.18, 0.038, 0.04, -1.0))

    def test_aspheric(self):
        self.check(ASPHERE)

    def test_tabulated(self):
        self.check(TABLE)


class DotsInTheFisheyeTest(unittest.TestCase):
    """Images of small glowing discs, some of them behind the lens."""

    TOLERANCE = 0.02  # px

    def test_equidistant(self):
        lens = Lens(62.0, 58.5, 131.5, 140.0)
        camera = FisheyeCamera(300, 280, lens, 2.0)
        canvas = canvas_of(camera)
        scene = HEADER + camera_scene(camera, MAP_FROM_CAMERA)
        expected = []
        for index, off_axis in enumerate((0.0, 0.4, 0.8, 1.1, 1.4, 1.6, 1.75, 1.9)):
            azimuth = 2.4 * index
            direction = np.array([np.sin(off_axis) * np.cos(azimuth),
                                  np.sin(off_axis) * np.sin(azimuth), np.cos(off_axis)])
            angular_radius = 0.06
            disc = MAP_FROM_CAMERA @ facing(-direction, direction)
            scene += (f"disc {{ <0, 0, 0>, z, {1000.0 * np.tan(angular_radius)} "
                      f"pigment {{ rgb 1 }} finish {{ emission rgb 1 ambient 0 diffuse 0 }} "
                      f"{matrix(disc)} }}\n")
            turns = np.linspace(0.0, 2.0 * np.pi, 400, endpoint=False)
            edge = facing(-direction, direction) @ np.vstack([
                np.tan(angular_radius) * np.cos(turns), np.tan(angular_radius) * np.sin(turns),
                np.zeros_like(turns), np.ones_like(turns)])
            sideways = np.hypot(edge[0], edge[1])
            angles = np.arctan2(sideways, edge[2])
            expected.append(polygon_centroid(np.column_stack([
                lens.cx + lens.fx * angles * edge[0] / sideways,
                lens.cy + lens.fy * angles * edge[1] / sideways])))
        image = render(scene, {}, canvas.width, canvas.height, samples=9)
        image = image[canvas.top:canvas.top + 280, canvas.left:canvas.left + 300]
        columns, rows = np.meshgrid(np.arange(300), np.arange(280))
        for u, v in expected:
            near = np.hypot(columns - u, rows - v) < 9.0
            light = image * near
            found = np.array([(light * columns).sum(), (light * rows).sum()]) / light.sum()
            np.testing.assert_allclose(found, (u, v), atol=self.TOLERANCE)


class MarkersTest(unittest.TestCase):
    """What a person in the room reads on a board, and its place in the image."""

    BOARDS = Boards(0.02, 1, 0.0, 1.0, Material("plain", 0.5, 0.5, 1.0, 0.0))

    def render_marker(self, family: str, map_from_marker: np.ndarray):
        camera = camera_with(SPHERE)
        marker = Marker(7, family, "", 0.8, map_from_marker)
        scene = (HEADER + camera_scene(camera, MAP_FROM_CAMERA)
                 + marker_scene(marker, self.BOARDS, 1.0))
        image = render(scene, marker_bitmaps([marker], self.BOARDS), camera.width, camera.height)
        return camera, image

    def check(self, family: str, map_from_marker: np.ndarray):
        camera, image = self.render_marker(family, map_from_marker)
        bitmap = tag_bitmap(family, 7)
        module = 0.8 / bitmap.family.width_at_border
        count = len(bitmap.modules)
        steps = (np.arange(count) - 0.5 * (count - 1)) * module
        x, y = np.meshgrid(steps, -steps)
        in_marker = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size), np.ones(x.size)])
        camera_from_marker = np.linalg.inv(MAP_FROM_CAMERA) @ map_from_marker
        pixels = np.rint(project(camera, (in_marker @ camera_from_marker.T)[:, :3])).astype(int)
        white = image[pixels[:, 1], pixels[:, 0]] > 0.5
        np.testing.assert_array_equal(white.reshape(count, count), bitmap.modules)

    def in_front_of_the_camera(self, rotation: np.ndarray) -> np.ndarray:
        transform = np.eye(4)
        transform[:3, :3] = rotation
        transform[:3, 3] = MAP_FROM_CAMERA[:3, 3] + [0.9, 0.5, 0.0]
        return transform

    def test_upright(self):
        self.check("tag36h11", self.in_front_of_the_camera(rotation_from_yaw_and_roll(-2.5)))

    def test_rolled_and_oblique(self):
        self.check("tag36h11", self.in_front_of_the_camera(rotation_from_yaw_and_roll(-2.9, 1.0)))

    def test_a_border_of_two_modules(self):
        self.check("aprilgrid", self.in_front_of_the_camera(rotation_from_yaw_and_roll(-2.5)))

    def test_pattern_beyond_its_border(self):
        self.check("tagStandard41h12",
                   self.in_front_of_the_camera(rotation_from_yaw_and_roll(-2.5)))

    def test_back_is_plain(self):
        behind = self.in_front_of_the_camera(rotation_from_yaw_and_roll(-2.5 + np.pi))
        _, image = self.render_marker("tag36h11", behind)
        self.assertAlmostEqual(image.max(), 0.5, delta=0.001)


class NoiseTest(unittest.TestCase):
    """Grey levels."""

    def test_noise_is_repeatable_and_as_strong_as_asked_for(self):
        light = np.full((300, 300), 0.5)
        first = grey_levels(light, 3.0, np.random.default_rng([4, 2]))
        second = grey_levels(light, 3.0, np.random.default_rng([4, 2]))
        np.testing.assert_array_equal(first, second)
        # Rounding adds a variance of 1/12.
        self.assertAlmostEqual(first.std(), np.sqrt(9.0 + 1.0 / 12.0), delta=0.05)
        self.assertAlmostEqual(first.mean(), 127.5, delta=0.06)

    def test_levels_are_clipped(self):
        levels = grey_levels(np.array([[-0.2, 0.0, 1.0, 1.3]]), 0.0, np.random.default_rng(0))
        self.assertEqual(levels.tolist(), [[0, 0, 255, 255]])


if __name__ == "__main__":
    unittest.main()
