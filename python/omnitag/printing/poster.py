"""A page that is larger than the paper, split over several sheets."""

import math
from dataclasses import dataclass
from typing import List, Tuple

from matplotlib.figure import Figure

from omnitag.printing.paper import MARGIN, MM_PER_INCH, points

OVERLAP = 10.0  # mm that neighbouring sheets share: cut off one of them, so that no gap is left


@dataclass(frozen=True)
class Tile:
    """The part of the page that is on one sheet; in mm from the page's lower left corner."""

    paper: Tuple[float, float]  # width and height
    left: float
    bottom: float
    row: int  # from 0 at the top
    column: int
    rows: int
    columns: int

    @property
    def printed(self) -> Tuple[float, float]:
        """Width and height of the printed area."""
        return self.paper[0] - 2.0 * MARGIN, self.paper[1] - 2.0 * MARGIN

    @property
    def name(self) -> str:
        """The name of the sheet."""
        return "row {} of {}, column {} of {}".format(self.row + 1, self.rows, self.column + 1,
                                                      self.columns)


def tiles(page: Tuple[float, float], paper: Tuple[float, float]) -> List[Tile]:
    """The sheets for a page, row by row; portrait or landscape, whichever takes fewer sheets."""
    upright, across = (_tiles(page, side) for side in (paper, paper[::-1]))
    return across if len(across) < len(upright) else upright


def tile_figure(tile: Tile) -> Figure:
    """An empty sheet; its axes have the page's coordinates.

    It has lines to cut along at the left and the top, where there are neighbours. Their cut edges come to
    lie on lines at the right and the bottom, at the end of what is printed: the sheets meet there, and
    the margin is for the glue.
    """
    width, height = tile.paper
    figure = Figure(figsize=(width / MM_PER_INCH, height / MM_PER_INCH))
    printed = tile.printed
    axes = figure.add_axes((MARGIN / width, MARGIN / height, printed[0] / width,
                            printed[1] / height))
    right, top = tile.left + printed[0], tile.bottom + printed[1]
    axes.set(xlim=(tile.left, right), ylim=(tile.bottom, top))
    axes.set_axis_off()
    line = {"color": "0.6", "linewidth": 0.4}
    if tile.column > 0:
        axes.plot([tile.left + OVERLAP] * 2, [tile.bottom, top], **line)
    if tile.row > 0:
        axes.plot([tile.left, right], [top - OVERLAP] * 2, **line)
    if tile.column < tile.columns - 1:
        axes.plot([right] * 2, [tile.bottom, top], clip_on=False, **line)
    if tile.row < tile.rows - 1:
        axes.plot([tile.left, right], [tile.bottom] * 2, clip_on=False, **line)
    figure.text(MARGIN / width, 0.3 * MARGIN / height, tile.name + ": cut along the lines at the left and "
                "the top, glue onto the lines of the sheets there", fontsize=points(2.2), color="0.4")
    return figure


def _tiles(page: Tuple[float, float], paper: Tuple[float, float]) -> List[Tile]:
    printed = [side - 2.0 * MARGIN for side in paper]
    step = [side - OVERLAP for side in printed]
    columns, rows = (max(1, math.ceil((whole - OVERLAP) / each)) for whole, each in zip(page, step))
    return [Tile((paper[0], paper[1]), column * step[0], page[1] - printed[1] - row * step[1], row,
                 column, rows, columns)
            for row in range(rows) for column in range(columns)]
