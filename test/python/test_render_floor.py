"""A floor that is not level, and settings in the place of the world file's."""

import unittest

from source_tree import FileTest

import numpy as np
from omnitag.rendering.floor import LEVEL, Floor, on_floor, read_floor
from omnitag.rendering.route import Frame
from omnitag.rendering.world import load_world
from omnitag.yaml_file import read_yaml
from test_render_changes import WORLD, WorldTest

QUARTER = 250000000


def route(count: int, step: float = 0.5) -> list:
    return [Frame(QUARTER * row, step * row, 0.0, 0.3, False, 0.1, 0.02, -0.03)
            for row in range(count)]


def leans(frames: list) -> np.ndarray:
    """Roll, pitch and z of each."""
    return np.array([(frame.roll, frame.pitch, frame.z) for frame in frames])


class FloorTest(FileTest):
    """What is added to the route."""

    def test_level(self):
        self.assertEqual(on_floor(LEVEL, route(5)), route(5))

    def test_constant(self):
        frames = on_floor(Floor(constant_lean=(0.01, -0.02), constant_height=0.3), route(3))
        np.testing.assert_allclose(leans(frames), [[0.03, -0.05, 0.4]] * 3)
        self.assertEqual([frame[:5] for frame in frames], [frame[:5] for frame in route(3)])

    def test_deviations_are_independent(self):
        frames = on_floor(Floor(lean_deviation=0.01, height_deviation=0.003, seed=4), route(4001))
        errors = leans(frames) - [0.02, -0.03, 0.1]
        np.testing.assert_allclose(errors.std(axis=0), [0.01, 0.01, 0.003], rtol=0.05)
        for other in (errors[1:, 0], errors[:-1, 1]):
            self.assertLess(abs(np.corrcoef(errors[:-1, 0], other)[0, 1]), 0.07)

    def test_walk_grows_with_the_way(self):
        frames = on_floor(Floor(lean_walk=0.01, height_walk=0.002), route(4001, 0.25))
        steps = np.diff(leans(frames), axis=0)
        np.testing.assert_allclose(steps.std(axis=0), 0.5 * np.array([0.01, 0.01, 0.002]),
                                   rtol=0.05)
        self.assertEqual(leans(frames)[0].tolist(), [0.02, -0.03, 0.1])
        resting = on_floor(Floor(lean_walk=0.01, height_walk=0.002), route(5, 0.0))
        self.assertEqual(resting, route(5, 0.0))

    def test_draws_belong_to_the_row_and_the_seed(self):
        floor = Floor(lean_deviation=0.01)
        self.assertEqual(on_floor(floor, route(9))[:4], on_floor(floor, route(4)))
        self.assertNotEqual(on_floor(floor._replace(seed=1), route(4)), on_floor(floor, route(4)))

    def test_keys(self):
        def read(text: str) -> Floor:
            root = read_yaml(self.write("world.yaml", "floor: " + text)).mapping(("floor",))
            return read_floor(root["floor"])

        self.assertEqual(read("{}"), LEVEL)
        self.assertEqual(
            read("{lean_deviation: 0.1, height_deviation: 0.2, lean_walk: 0.3, height_walk: 0.4, "
                 "constant_lean: [0.5, 0.6], constant_height: -0.7, seed: 8}"),
            Floor(0.1, 0.2, 0.3, 0.4, (0.5, 0.6), -0.7, 8))
        for text, parts in (("{lean_walk: -1}", ("floor.lean_walk", "at least 0", "-1")),
                            ("{constant_lean: 0.1}", ("floor.constant_lean", "2 numbers", "0.1")),
                            ("{tilt: 1}", ("floor.tilt", "unknown"))):
            with self.assert_error("world.yaml:1: ", *parts):
                read(text)


class SettingsTest(WorldTest):
    """KEY=VALUE in the place of what the file says."""

    def set(self, *settings: str):
        return load_world(self.write("world.yaml", WORLD), None, settings)

    def test_replaces_and_adds(self):
        world = self.set("images.noise=2.5", "images.blur=[0.5, 1]", "floor.lean_deviation=1e-2",
                         "floor.constant_lean=[0.1, 0]", "ambient=0.3", "odometry.rate=50",
                         "images.noise=4")
        self.assertEqual((world.noise, world.start), (4.0, 100 * 10**9))
        self.assertEqual(world.effects.blur, (0.5, 1.0))
        self.assertEqual(world.floor, Floor(lean_deviation=0.01, constant_lean=(0.1, 0.0)))
        self.assertEqual((world.ambient, world.odometry.rate), (0.3, 50.0))

    def test_over_a_world_that_is_extended(self):
        self.write("world.yaml", WORLD)
        world = load_world(self.write("other.yaml", "extends: world.yaml\nambient: 0.5\n"), None,
                           ["images.noise=1", "floor.constant_height=0.2"])
        self.assertEqual((world.noise, world.start, world.ambient), (1.0, 100 * 10**9, 0.5))
        self.assertEqual(world.floor.constant_height, 0.2)

    def test_wrong_settings(self):
        for setting, parts in (
                ("images.blurr=1", ("images.blurr", "blur", "unknown key")),
                ("image.blur=1", ("image", "images", "unknown key")),
                ("extends=paper.yaml", ("extends", "unknown key")),
                ("images.blur=much", ("images.blur", "a finite number", "much")),
                ("images.noise.more=1", ("images.noise.more", "of a mapping", "'0'")),
                ("images.blur", ("KEY=VALUE", "'images.blur'")),
                ("images.blur=[1", ("KEY=VALUE", "'images.blur=[1'"))):
            with self.assert_error("--set: ", *parts):
                self.set(setting)


if __name__ == "__main__":
    unittest.main()
