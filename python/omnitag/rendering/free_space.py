"""Where in a world the robot can be."""

from typing import List

import cv2
import numpy as np

from omnitag.command_line import InputError
from omnitag.rendering.obstacles import cylinders, furniture_blocks, hung_blocks
from omnitag.rendering.route import Frame
from omnitag.rendering.world import World

# The robot can drive under what starts above this, such as lamps and signs.
HEADROOM = 2.0
MAX_ATTEMPTS = 10000


class FreeSpace:
    """The floor of a room without anything that ever stands or hangs in the robot's way."""

    def __init__(self, world: World) -> None:
        self._room = world.room
        self._discs = []
        self._polygons: List[np.ndarray] = []
        for shape in cylinders(world):
            if shape.parent_from_shape[2, 3] < HEADROOM:
                self._discs.append((shape.parent_from_shape[:2, 3], shape.radius))
        furniture = (block for block in furniture_blocks(world)
                     if block.map_from_block[2, 3] < HEADROOM)
        for block in (*furniture, *hung_blocks(world)):
            outline, lowest, _ = block.outline()
            if lowest < HEADROOM:
                self._polygons.append(outline)

    def clearance(self, x: float, y: float) -> float:
        """Metres to the nearest wall or obstacle; negative inside an obstacle or outside the room."""
        (x_lower, y_lower), (x_upper, y_upper) = self._room.lower, self._room.upper
        distances = [x - x_lower, x_upper - x, y - y_lower, y_upper - y]
        distances += [np.hypot(*(middle - (x, y))) - radius for middle, radius in self._discs]
        distances += [-cv2.pointPolygonTest(polygon, (x, y), True) for polygon in self._polygons]
        return float(min(distances))


def random_frames(world: World, count: int, interval: float, clearance: float,
                  generator: np.random.Generator) -> List[Frame]:
    """Poses uniform over the free space and all headings, `interval` seconds apart.

    The robot is carried from each to the next. Raises InputError if there is no free space.
    """
    space = FreeSpace(world)
    lower, upper = np.array(world.room.lower), np.array(world.room.upper)
    frames = []
    for index in range(count):
        for _ in range(MAX_ATTEMPTS):
            # With the precision of the route's file.
            x, y = (round(value, 4) for value in generator.uniform(lower, upper))
            if space.clearance(x, y) >= clearance:
                break
        else:
            raise InputError(f"expected free space with a clearance of {clearance:g} m, "
                             f"found none in {MAX_ATTEMPTS} attempts")
        yaw = generator.uniform(-np.pi, np.pi)
        frames.append(Frame(round(index * interval * 1e9), x, y, yaw, jump=index > 0))
    return frames
