"""What a marker looks like, for printing and rendering: the same for all families."""

import zlib
from dataclasses import dataclass
from typing import List, Tuple

import numpy as np

from omnitag.marker_map import BorderedPattern, Marker
from omnitag.tag_bitmap import tag_bitmap

PATTERN_MODULES = 8
"""Modules along the edge of a pattern's border, for the quiet zone to be as wide as a tag36h11's."""


@dataclass(frozen=True)
class Square:
    """A square of equal cells, centred on the marker."""

    width: float
    """Its edge as a share of the marker's size."""
    cells: np.ndarray
    """(n, n): what share of the paper's white they reflect, from 0 (black) to 1; row 0 is on top."""


@dataclass(frozen=True)
class Drawing:
    """A marker with its quiet zone, upright."""

    name: str
    """Differs from those of all other drawings; letters, digits and underscores."""
    squares: Tuple[Square, ...]
    """The first is the widest; each lies upon the one before."""
    module: float
    """Edge of a module, in which quiet zones are counted, as a share of the marker's size."""
    measured: str
    """Where the marker's size is measured, in words."""

    @property
    def width(self) -> float:
        """Its edge as a share of the marker's size."""
        return self.squares[0].width

    @property
    def has_greys(self) -> bool:
        """Whether a cell is neither black nor white."""
        return any(bool(np.any((square.cells > 0.0) & (square.cells < 1.0)))
                   for square in self.squares)


def drawing_of(marker: Marker, quiet_modules: int) -> Drawing:
    """The marker's drawing with this many white modules on each side."""
    if marker.pattern is not None:
        return _pattern_drawing(marker.pattern, quiet_modules)
    bitmap = tag_bitmap(marker.family, marker.id)
    modules = bitmap.modules
    while all(edge.all() for edge in (modules[0], modules[-1], modules[:, 0], modules[:, -1])):
        modules = modules[1:-1, 1:-1]
    modules = np.pad(modules, quiet_modules, constant_values=True)
    at_border = bitmap.family.width_at_border
    return Drawing("{}_{}".format(marker.family, marker.id),
                   (Square(len(modules) / at_border, modules.astype(float)),), 1.0 / at_border,
                   "the edge,\n{} modules, of the square between the corners that the detector "
                   "reports".format(at_border))


def _pattern_drawing(pattern: BorderedPattern, quiet_modules: int) -> Drawing:
    squares: List[Square] = []
    if quiet_modules:
        squares.append(Square(1.0 + 2.0 * quiet_modules / PATTERN_MODULES, np.ones((1, 1))))
    squares.append(Square(1.0, np.zeros((1, 1))))
    squares.append(Square(1.0 - 2.0 * pattern.border, pattern.picture.luma / 255.0))
    # Files of one name may come from several folders.
    looks = pattern.picture.luma.tobytes() + str(pattern.border).encode()
    return Drawing("pattern_{:08x}".format(zlib.crc32(looks)), tuple(squares), 1.0 / PATTERN_MODULES,
                   "the outer edge\nof the black border")
