"""A page with a marker to print, drawn as vectors at its true size."""

from dataclasses import dataclass
from typing import Dict, List, Tuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import PathPatch, Rectangle
from matplotlib.path import Path

from omnitag.marker_drawing import Drawing, Square, drawing_of
from omnitag.marker_map import Marker
from omnitag.printing.paper import MARGIN, points
from omnitag.printing.ruler import RULER_LENGTH, draw_ruler

CAPTION_HEIGHT = 42.0  # mm, below the cut line
SMALLEST_WIDTH = RULER_LENGTH + 30.0  # mm, of a page without margins, for the ruler to fit


@dataclass(frozen=True)
class Sheet:
    """What is printed on one page."""

    marker: Marker
    labels: Tuple[str, ...]  # of the map entries that look like this

    @property
    def drawing(self) -> Drawing:
        """The marker with a quiet zone of one module."""
        return drawing_of(self.marker, 1)

    @property
    def module(self) -> float:
        """Edge of one module in mm."""
        return 1e3 * self.marker.size * self.drawing.module

    @property
    def cut_width(self) -> float:
        """Edge in mm of the square to cut out: the marker with its quiet zone."""
        return 1e3 * self.marker.size * self.drawing.width

    @property
    def least_page(self) -> Tuple[float, float]:
        """Width and height in mm of the smallest page that the sheet fits on."""
        return (max(self.cut_width, SMALLEST_WIDTH) + 2.0 * MARGIN,
                self.cut_width + CAPTION_HEIGHT + 2.0 * MARGIN)


def sheets(markers: Tuple[Marker, ...]) -> List[Sheet]:
    """One sheet for each family, id (or pattern) and size, in the order of the map."""
    served: Dict[Tuple[str, int, float], List[Marker]] = {}
    for marker in markers:
        served.setdefault((marker.family, marker.id, marker.size), []).append(marker)
    return [Sheet(same[0], tuple(marker.name for marker in same if marker.name))
            for same in served.values()]


def draw_on(axes: Axes, sheet: Sheet, size: Tuple[float, float]) -> None:
    """Draw on a page of that width and height, in millimetres from its lower left corner."""
    width, height = size
    left = 0.5 * (width - sheet.cut_width)
    bottom = 0.5 * (height - sheet.cut_width - CAPTION_HEIGHT) + CAPTION_HEIGHT
    axes.add_patch(Rectangle((left, bottom), sheet.cut_width, sheet.cut_width, fill=False,
                             edgecolor="0.6", linewidth=0.4, linestyle=(0, (6, 4))))
    _draw_marker(axes, sheet, 0.5 * width, bottom + 0.5 * sheet.cut_width)
    _draw_note(axes, sheet, 0.5 * width, bottom)
    _draw_dimension(axes, sheet, 0.5 * width, bottom - 5.0)
    _draw_caption(axes, sheet, 0.5 * width, bottom - 13.0)
    draw_ruler(axes, 0.5 * (width - RULER_LENGTH), bottom - CAPTION_HEIGHT + 6.0)


def _draw_marker(axes: Axes, sheet: Sheet, x: float, y: float) -> None:
    """Draw the squares of the marker around (x, y), each over the one before, on white paper."""
    on_paper = True
    for square in sheet.drawing.squares:
        _draw_square(axes, square, 1e3 * sheet.marker.size * square.width, x, y, on_paper)
        on_paper = on_paper and bool(np.all(square.cells == 1.0))


def _draw_square(axes: Axes, square: Square, width: float, x: float, y: float,
                 on_paper: bool) -> None:
    """Draw from light to dark: each grey as one path of its cells and of all darker ones.

    Cells that only touch would show seams on a screen.
    """
    levels = np.rint(255.0 * square.cells).astype(int)
    count = len(levels)
    turn = np.array([(0, 0), (1, 0), (1, 1), (0, 1), (0, 0)])
    for level in np.unique(levels)[::-1]:
        if level == 255 and on_paper:
            continue
        rows, columns = np.nonzero(levels <= level)
        corner = np.column_stack([columns, count - 1 - rows]) - 0.5 * count
        vertices = (x, y) + width / count * (corner[:, None, :] + turn)
        codes = [Path.MOVETO, Path.LINETO, Path.LINETO, Path.LINETO, Path.CLOSEPOLY] * len(corner)
        axes.add_patch(PathPatch(Path(vertices.reshape(-1, 2), codes),
                                 facecolor=str(level / 255.0), linewidth=0.0))


def _draw_note(axes: Axes, sheet: Sheet, centre: float, bottom: float) -> None:
    """A small, pale note on the quiet zone, which stays after cutting: what it is, how it hangs."""
    height = min(2.5, 0.3 * sheet.module)
    axes.text(centre, bottom + 0.1 * sheet.module, sheet.marker.kind + "  ·  lower edge",
              fontsize=points(height), color="0.55", ha="center", va="bottom")


def _draw_dimension(axes: Axes, sheet: Sheet, centre: float, y: float) -> None:
    """The marker's size, between the edges where it is measured."""
    half = 0.5e3 * sheet.marker.size
    axes.plot([centre - half, centre + half], [y, y], color="0.35", linewidth=0.5)
    for x in (centre - half, centre + half):
        axes.plot([x, x], [y - 2.0, y + 4.0], color="0.35", linewidth=0.5)
    axes.text(centre, y - 2.4, "size {:.9g} mm".format(1e3 * sheet.marker.size),
              fontsize=points(2.8), color="0.35", ha="center", va="top")


def _draw_caption(axes: Axes, sheet: Sheet, centre: float, y: float) -> None:
    names = ", ".join(sheet.labels)
    title = sheet.marker.kind + ("   " + names if names else "")
    explanation = (
        "Print at 100 %, not fitted to the page. Its size in the map is {:.9g} m: {}."
    ).format(sheet.marker.size, sheet.drawing.measured)
    axes.text(centre, y, title, fontsize=points(4.6), fontweight="bold", ha="center", va="top")
    axes.text(centre, y - 7.5, explanation, fontsize=points(2.6), color="0.25", ha="center",
              va="top", linespacing=1.3)
