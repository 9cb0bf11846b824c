"""What stands or hangs in a world, as blocks."""

from typing import Iterator, NamedTuple, Tuple

import cv2
import numpy as np

from omnitag.rendering.scene import board_size, board_width
from omnitag.rendering.world import Cylinder, World


class Block(NamedTuple):
    """A box with its faces along the axes of its own frame, in metres."""

    map_from_block: np.ndarray  # (4, 4)
    lower: Tuple[float, float, float]
    upper: Tuple[float, float, float]

    def outline(self) -> Tuple[np.ndarray, float, float]:
        """Its outline from above, (n, 2) in the map, and its lowest and highest point."""
        corners = np.array([(x, y, z, 1.0) for x in (self.lower[0], self.upper[0])
                            for y in (self.lower[1], self.upper[1])
                            for z in (self.lower[2], self.upper[2])])
        in_map = corners @ self.map_from_block.T
        hull = cv2.convexHull(in_map[:, :2].astype(np.float32))
        return hull[:, 0, :], in_map[:, 2].min(), in_map[:, 2].max()


def cylinders(world: World) -> Iterator[Cylinder]:
    """The furniture that is round."""
    return (shape for shape in world.furniture if isinstance(shape, Cylinder))


def furniture_blocks(world: World) -> Iterator[Block]:
    """The other furniture; the origin of each is the middle of its lower face."""
    for shape in world.furniture:
        if not isinstance(shape, Cylinder):
            x, y, z = shape.size
            yield Block(shape.parent_from_shape, (-x / 2, -y / 2, 0), (x / 2, y / 2, z))


def hung_blocks(world: World) -> Iterator[Block]:
    """The boards of all markers that ever hang, and the calibration boards."""
    for marker in world.hung_markers.ever():
        width = board_width(marker, world.boards)
        yield _board(marker.map_from_marker, width, width, world.boards.thickness)
    for hung in world.hung_boards:
        yield _board(hung.map_from_board, *board_size(hung.board, world.boards),
                     world.boards.thickness)


def _board(map_from_board: np.ndarray, width: float, height: float, thickness: float) -> Block:
    return Block(map_from_board, (-width / 2, -height / 2, -thickness), (width / 2, height / 2, 0))
