"""Where in a world the robot can be."""

from typing import List

import cv2
import numpy as np

from omnitag.command_line import InputError
from omnitag.rendering.route import Frame
from omnitag.rendering.scene import board_size, board_width
from omnitag.rendering.world import Cylinder, World

# The robot can drive under what starts above this, such as lamps and signs.
HEADROOM = 2.0
MAX_ATTEMPTS = 10000


class FreeSpace:
    """The floor of a room without anything that ever stands or hangs in the robot's way."""

    def __init__(self, world: World) -> None:
        self._room = world.room
        self._discs = []
        self._polygons: List[np.ndarray] = []
        for shape in world.furniture:
            if shape.parent_from_shape[2, 3] >= HEADROOM:
                continue
            if isinstance(shape, Cylinder):
                self._discs.append((shape.parent_from_shape[:2, 3], shape.radius))
            else:
                x, y, z = shape.size
                self._add_block(shape.parent_from_shape, (-x / 2, -y / 2, 0), (x / 2, y / 2, z))
        for marker in world.hung_markers.ever():
            half = 0.5 * board_width(marker, world.boards)
            self._add_block(marker.map_from_marker, (-half, -half, -world.boards.thickness),
                            (half, half, 0))
        for hung in world.hung_boards:
            width, height = board_size(hung.board, world.boards)
            self._add_block(hung.map_from_board, (-width / 2, -height / 2, -world.boards.thickness),
                            (width / 2, height / 2, 0))

    def clearance(self, x: float, y: float) -> float:
        """Metres to the nearest wall or obstacle; negative inside an obstacle or outside the room."""
        (x_lower, y_lower), (x_upper, y_upper) = self._room.lower, self._room.upper
        distances = [x - x_lower, x_upper - x, y - y_lower, y_upper - y]
        distances += [np.hypot(*(middle - (x, y))) - radius for middle, radius in self._discs]
        distances += [-cv2.pointPolygonTest(polygon, (x, y), True) for polygon in self._polygons]
        return float(min(distances))

    def _add_block(self, map_from_block: np.ndarray, lower, upper) -> None:
        corners = np.array([(x, y, z, 1.0) for x in (lower[0], upper[0])
                            for y in (lower[1], upper[1]) for z in (lower[2], upper[2])])
        in_map = corners @ map_from_block.T
        if in_map[:, 2].min() < HEADROOM:
            self._polygons.append(cv2.convexHull(in_map[:, :2].astype(np.float32)))


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
