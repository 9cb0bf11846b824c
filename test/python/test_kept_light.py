"""Light that is kept so that it need not be rendered again."""

import os
import tempfile
import unittest

import numpy as np

from omnitag.rendering.sequence import kept_light


class KeptLightTest(unittest.TestCase):
    """One directory for each test."""

    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.path = os.path.join(directory.name, "light.png")

    def test_is_what_was_rendered(self):
        light = np.array([[0.0, 0.25, 1.0], [0.125, 0.7, 0.003]])
        np.testing.assert_allclose(kept_light(self.path, lambda: light), light, atol=1e-5)

    def test_is_rendered_once(self):
        first = kept_light(self.path, lambda: np.full((2, 3), 0.5))
        again = kept_light(self.path, self.fail)
        np.testing.assert_array_equal(again, first)

    def test_is_not_kept_where_rendering_fails(self):
        def fail_to_render() -> np.ndarray:
            raise OSError("no renderer")

        with self.assertRaises(OSError):
            kept_light(self.path, fail_to_render)
        self.assertEqual(os.listdir(os.path.dirname(self.path)), [])


if __name__ == "__main__":
    unittest.main()
