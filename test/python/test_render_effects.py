"""What a real camera does to light, against what it is known to be."""

import math
import unittest

from source_tree import FileTest

import cv2
import numpy as np
from omnitag.rendering.bayer import PATTERNS, TRANSMISSION, transmissions
from omnitag.rendering.blur import blurred, normal_kernel
from omnitag.rendering.camera import CatadioptricCamera, FisheyeCamera, Lens, finer, rim_shares
from omnitag.rendering.effects import Effects, collected_light, image_pixels, read_effects
from omnitag.rendering.mirror import ConicMirror
from omnitag.rendering.turning import FINENESS, turned
from omnitag.yaml_file import read_yaml

CAMERA = FisheyeCamera(81, 61, Lens(20.0, 20.0, 40.0, 30.0), 1.5)
RIM = 30.0  # px


def generator() -> np.random.Generator:
    return np.random.default_rng(3)


def normal_edge(offsets: np.ndarray, deviation: float) -> np.ndarray:
    """An edge from 0 to 1 at offset 0, blurred."""
    return np.array([0.5 * (1.0 + math.erf(x / (math.sqrt(2.0) * deviation))) for x in offsets])


class BlurTest(unittest.TestCase):
    """Normal distributions."""

    def test_kernel_has_the_variance(self):
        for deviation in (0.2, 0.4, 0.8, 1.7):
            kernel = normal_kernel(deviation)
            offsets = np.arange(len(kernel)) - len(kernel) // 2
            self.assertAlmostEqual(kernel.sum(), 1.0)
            self.assertAlmostEqual((kernel * offsets**2).sum(), deviation**2, delta=1e-9)

    def test_edge_has_the_error_function(self):
        # Blurs add their variances: the edge is smooth, so that its samples say all about it.
        columns = np.arange(60) - 29.3
        for deviation in (0.8, 1.2, 2.0):
            light = np.tile(normal_edge(columns, 1.0), (20, 1))
            found = blurred(light, deviation)[10]
            expected = normal_edge(columns, math.hypot(1.0, deviation))
            np.testing.assert_allclose(found, expected, atol=2e-4)

    def test_grows_with_the_square_of_the_radius(self):
        spots = np.zeros((61, 81))
        places = ((30, 40), (30, 55), (30, 66))
        shares = (0.0, 0.5, 26.0 / RIM)
        effects = Effects(blur=(0.7, 1.9))
        for (row, column), share in zip(places, shares):
            spots[:] = 0.0
            spots[row, column] = 1.0
            image = collected_light(spots, CAMERA, effects)
            # What a pixel gives to others follows their blur; to its own row's column above it,
            # whose distance off the axis is nearly its own.
            ratio = image[row + 1, column] / image[row, column]
            deviation = 0.7 + 1.2 * share**2
            self.assertAlmostEqual(ratio, math.exp(-0.5 / deviation**2), delta=0.02)

    def test_constant_stays(self):
        image = collected_light(np.full((61, 81), 0.3), CAMERA, Effects(blur=(0.3, 3.0)))
        np.testing.assert_allclose(image, 0.3, atol=1e-12)


class LightTest(unittest.TestCase):
    """Vignetting, gain, gamma and the order of all."""

    def pixels(self, light: np.ndarray, noise: float = 0.0, **effects) -> np.ndarray:
        return image_pixels(light, CAMERA, Effects(**effects), noise, generator())

    def test_nothing_by_default(self):
        light = np.random.default_rng(1).uniform(size=(61, 81))
        np.testing.assert_array_equal(self.pixels(light), np.rint(255.0 * light))

    def test_vignetting(self):
        image = collected_light(np.ones((61, 81)), CAMERA, Effects(vignetting=0.4))
        self.assertEqual(image[30, 40], 1.0)
        self.assertAlmostEqual(image[30, 55], 1.0 - 0.4 * 0.25)
        self.assertAlmostEqual(image[18, 56], 1.0 - 0.4 * (20.0 / RIM) ** 2)
        self.assertAlmostEqual(image[0, 40], 0.6)
        self.assertAlmostEqual(image[0, 0], 0.6)

    def test_rim_of_a_mirror(self):
        mirror = ConicMirror(0.21, 0.0375, 0.04, 0.0)
        camera = CatadioptricCamera(400, 300, Lens(800.0, 600.0, 200.0, 150.0), mirror)
        shares = rim_shares(camera)
        slope = 0.0375 / (0.21 + 0.04 - math.sqrt(0.04**2 - 0.0375**2))
        self.assertAlmostEqual(shares[150, 260], 60.0 / (800.0 * slope))
        self.assertAlmostEqual(shares[195, 200], 45.0 / (600.0 * slope))

    def test_gain_and_gamma(self):
        light = np.full((61, 81), 0.2)
        self.assertEqual(self.pixels(light, gain=0.5)[3, 3], round(255.0 * 0.1))
        self.assertEqual(self.pixels(light, gain=6.0)[3, 3], 255)
        self.assertEqual(self.pixels(light, gamma=2.2)[3, 3], round(255.0 * 0.2 ** (1.0 / 2.2)))
        self.assertEqual(self.pixels(light, gain=2.0, gamma=2.0)[3, 3],
                         round(255.0 * math.sqrt(0.4)))

    def test_noise_is_of_grey_levels(self):
        image = self.pixels(np.full((61, 81), 0.2), 4.0, gamma=2.2).astype(float)
        self.assertAlmostEqual(image.std(), 4.0, delta=0.2)

    def test_blur_comes_before_saturation(self):
        light = np.zeros((61, 81))
        light[:, 40:] = 1.0
        found = self.pixels(light, gain=1.5, blur=(1.5, 1.5))[30]
        expected = 1.5 * normal_edge(np.arange(81) - 39.5, 1.5)
        np.testing.assert_allclose(found, np.clip(255.0 * expected, 0, 255), atol=3.5)
        self.assertEqual(found[41], 255)


class BayerTest(unittest.TestCase):
    """Colour filters over a grey world."""

    def test_filters(self):
        filters = transmissions((4, 4), "grbg")
        for place, colour in (((0, 0), "g"), ((0, 1), "r"), ((1, 0), "b"), ((3, 3), "g")):
            self.assertEqual(filters[place], TRANSMISSION[colour])

    def test_white_is_balanced(self):
        light = np.full((60, 80), 0.4)
        for pattern in PATTERNS:
            image = image_pixels(light, CAMERA, Effects(bayer=pattern, gamma=2.2), 0.0, generator())
            self.assertEqual(image.shape, light.shape)
            np.testing.assert_allclose(image, 255.0 * 0.4 ** (1.0 / 2.2), atol=1.5)

    def test_pattern_is_developed_as_it_was_filtered(self):
        # Where the pattern were another, the balance would leave a mosaic or shift the slope.
        columns, rows = np.meshgrid(np.arange(80), np.arange(60))
        light = 0.2 + 0.004 * columns + 0.002 * rows
        for pattern in PATTERNS:
            image = image_pixels(light, CAMERA, Effects(bayer=pattern), 0.0, generator())
            np.testing.assert_allclose(image[2:-2, 2:-2], 255.0 * light[2:-2, 2:-2], atol=2.0)

    def test_each_pixel_sees_one_colour(self):
        light = np.zeros((60, 80))
        light[30, 40] = 1.0  # red in rggb
        image = image_pixels(light, CAMERA, Effects(bayer="rggb"), 0.0, generator())
        self.assertAlmostEqual(image[30, 40], 0.299 * 255.0, delta=1.0)
        self.assertAlmostEqual(image[30, 41], 0.5 * 0.299 * 255.0, delta=1.0)


class TurnTest(unittest.TestCase):
    """The mean over turns of the camera about its axis."""

    CAMERA = FisheyeCamera(120, 100, Lens(36.0, 30.0, 60.0, 48.0), 1.5)

    def spot(self, azimuth: float, off_axis: float = 1.1) -> np.ndarray:
        """Light of a round spot, FINENESS times as large as the image."""
        lens = finer(self.CAMERA, FINENESS).lens
        u, v = np.meshgrid(np.arange(FINENESS * 120), np.arange(FINENESS * 100))
        x, y = (u - lens.cx) / lens.fx, (v - lens.cy) / lens.fy
        squared = ((x - off_axis * math.cos(azimuth)) ** 2
                   + (y - off_axis * math.sin(azimuth)) ** 2)
        return np.exp(-0.5 * squared / 0.06**2)

    def test_is_the_mean_of_turned_images(self):
        turn = 0.14
        found = turned(self.spot(0.7), self.CAMERA, turn)
        angles = 0.7 + turn * ((np.arange(200) + 0.5) / 200.0 - 0.5)
        mean = sum(self.spot(angle) for angle in angles) / 200.0
        expected = cv2.resize(mean, (120, 100), interpolation=cv2.INTER_AREA)
        np.testing.assert_allclose(found, expected, atol=0.006)
        u, v = np.meshgrid(np.arange(120), np.arange(100))
        for axis in (u, v):
            self.assertAlmostEqual((found * axis).sum() / found.sum(),
                                   (expected * axis).sum() / expected.sum(), delta=0.005)


class EffectKeysTest(FileTest):
    """The keys of the world's images."""

    def read(self, text: str) -> Effects:
        value = read_yaml(self.write("world.yaml", text))
        return read_effects(value.mapping(("turn", "blur", "vignetting", "gain", "gamma",
                                           "bayer")))

    def test_all_keys(self):
        self.assertEqual(self.read("{}"), Effects())
        self.assertEqual(self.read("{turn: 0.02, blur: [0.5, 2], vignetting: 0.3, gain: 2, "
                                   "gamma: 2.2, bayer: rggb}"),
                         Effects(0.02, (0.5, 2.0), 0.3, 2.0, 2.2, "rggb"))
        self.assertEqual(self.read("{blur: 1.5}").blur, (1.5, 1.5))

    def test_wrong_values(self):
        for text, parts in (("{blur: -1}", ("blur", "at least 0", "-1")),
                            ("{blur: [1, 2, 3]}", ("blur", "2 numbers", "3")),
                            ("{blur: [1, -2]}", ("blur", "at least 0", "-2")),
                            ("{vignetting: 2}", ("vignetting", "0 to 1", "2")),
                            ("{gain: 0}", ("gain", "positive", "0")),
                            ("{gamma: sRGB}", ("gamma", "finite", "sRGB")),
                            ("{bayer: rgbg}", ("bayer", "rggb", "rgbg"))):
            with self.assert_error("world.yaml:1: ", *parts):
                self.read(text)


if __name__ == "__main__":
    unittest.main()
