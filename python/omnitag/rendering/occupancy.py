"""The occupancy grid of a world's floor, as map_server reads it."""

from typing import Optional, Tuple

import cv2
import numpy as np

from omnitag.command_line import InputError
from omnitag.rendering.obstacles import cylinders, furniture_blocks, hung_blocks
from omnitag.rendering.world import Cylinder, World

# Grey levels of map_server's trinary images.
FREE = 254
OCCUPIED = 0
UNKNOWN = 205

# Corners of shapes are placed to a sixteenth of a cell.
_SHIFT = 4


class FloorGrid:
    """The cells of a world's floor: what stands at a height is occupied, the rest of the room free.

    `grid` has row 0 in the north, y upward; its lower left corner is at `origin` in the map.
    """

    def __init__(self, world: World, resolution: float, height: float) -> None:
        margin = 2.0 * resolution
        self.resolution = resolution
        self.origin = np.array(world.room.lower) - margin
        columns, rows = np.ceil(
            (np.array(world.room.upper) + margin - self.origin) / resolution).astype(int)
        self.grid = np.full((rows, columns), UNKNOWN, np.uint8)
        self._fill(_rectangle(np.array(world.room.lower) - resolution,
                              np.array(world.room.upper) + resolution), OCCUPIED)
        self._fill(_rectangle(np.array(world.room.lower), np.array(world.room.upper)), FREE)
        for shape in cylinders(world):
            self._add_cylinder(shape, height)
        for block in (*furniture_blocks(world), *hung_blocks(world)):
            outline, lowest, highest = block.outline()
            if lowest <= height <= highest:
                self._fill(outline.astype(float), OCCUPIED)

    def keep_reachable(self, place: Tuple[float, float]) -> None:
        """Make all free cells unknown that cannot be reached from a place of the map (m)."""
        column, row = (int(value) for value in self._cells(np.array([place]))[0])
        rows, columns = self.grid.shape
        if not (0 <= row < rows and 0 <= column < columns) or self.grid[row, column] != FREE:
            raise InputError("--from: expected a free place, found {:g},{:g}".format(*place))
        _, labels = cv2.connectedComponents((self.grid == FREE).astype(np.uint8), connectivity=4)
        self.grid[(self.grid == FREE) & (labels != labels[row, column])] = UNKNOWN

    def write(self, path: str) -> None:
        """Write the YAML file, and beside it the image, a PNG of the same name."""
        stem = path[:-len(".yaml")] if path.endswith(".yaml") else path
        image = stem + ".png"
        if not cv2.imwrite(image, self.grid):
            raise InputError("{}: cannot be written".format(image))
        with open(path, "w", encoding="utf-8") as file:
            file.write("image: {}\nresolution: {:g}\norigin: [{:g}, {:g}, 0]\nnegate: 0\n"
                       "occupied_thresh: 0.65\nfree_thresh: 0.196\n".format(
                           image.rsplit("/", 1)[-1], self.resolution, *self.origin))

    def _add_cylinder(self, shape: Cylinder, height: float) -> None:
        bottom = shape.parent_from_shape[2, 3]
        if bottom <= height <= bottom + shape.height:
            circle = np.linspace(0.0, 2.0 * np.pi, 48, endpoint=False)
            rim = shape.radius * np.stack([np.cos(circle), np.sin(circle)], axis=1)
            self._fill(shape.parent_from_shape[:2, 3] + rim, OCCUPIED)

    def _cells(self, points: np.ndarray) -> np.ndarray:
        """Columns and rows of the image, real numbers from its upper left corner."""
        cells = (points - self.origin) / self.resolution
        return np.stack([cells[:, 0], self.grid.shape[0] - cells[:, 1]], axis=1)

    def _fill(self, polygon: np.ndarray, value: int) -> None:
        # To OpenCV, the middle of a cell is at an integer.
        corners = np.rint((self._cells(polygon) - 0.5) * (1 << _SHIFT)).astype(np.int32)
        cv2.fillConvexPoly(self.grid, corners, value, shift=_SHIFT)


def _rectangle(lower: np.ndarray, upper: np.ndarray) -> np.ndarray:
    return np.array([lower, (upper[0], lower[1]), upper, (lower[0], upper[1])])


def floor_grid(world: World, resolution: float, height: float,
               reachable_from: Optional[Tuple[float, float]]) -> FloorGrid:
    """The grid of a world. Raises InputError if `reachable_from` is not free."""
    grid = FloorGrid(world, resolution, height)
    if reachable_from is not None:
        grid.keep_reachable(reachable_from)
    return grid
