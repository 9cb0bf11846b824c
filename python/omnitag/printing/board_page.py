"""A page with a calibration board to print, drawn as vectors at its true size."""

from dataclasses import dataclass
from typing import List, Tuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import PathPatch, Rectangle
from matplotlib.path import Path

from omnitag.board_file import Board, BoardMarker
from omnitag.printing.paper import MARGIN, points
from omnitag.printing.ruler import RULER_LENGTH, draw_ruler
from omnitag.tag_bitmap import tag_bitmap, tag_family

CAPTION_HEIGHT = 29.0  # mm, below the cut line
LEAST_QUIET_ZONE = 5.0  # mm, for the note that stays on the board
SMALLEST_WIDTH = RULER_LENGTH + 30.0  # mm, of a page without margins, for the ruler to fit
LETTER_WIDTH = 0.8  # of the mean letter, as a share of its height: for texts that must fit a width


@dataclass(frozen=True)
class BoardSheet:
    """A board with the white zone around it, as it is cut out; all in mm."""

    board: Board

    @property
    def quiet_zone(self) -> float:
        """Width of the white zone on each side: at least a module of the markers."""
        module = max(1e3 * marker.size / tag_family(marker.family).width_at_border
                     for marker in self.board.markers)
        return max(module, LEAST_QUIET_ZONE)

    @property
    def cut_size(self) -> Tuple[float, float]:
        """Width and height of the rectangle to cut out."""
        return (1e3 * self.board.width + 2.0 * self.quiet_zone,
                1e3 * self.board.height + 2.0 * self.quiet_zone)

    @property
    def least_page(self) -> Tuple[float, float]:
        """Width and height of the smallest page that the sheet fits on."""
        width, height = self.cut_size
        return (max(width, SMALLEST_WIDTH) + 2.0 * MARGIN, height + CAPTION_HEIGHT + 2.0 * MARGIN)


def draw_board_on(axes: Axes, sheet: BoardSheet, size: Tuple[float, float]) -> None:
    """Draw on a page of that width and height, in millimetres from its lower left corner."""
    cut_width, cut_height = sheet.cut_size
    left = 0.5 * (size[0] - cut_width)
    bottom = 0.5 * (size[1] - cut_height - CAPTION_HEIGHT) + CAPTION_HEIGHT
    axes.add_patch(Rectangle((left, bottom), cut_width, cut_height, fill=False, edgecolor="0.6",
                             linewidth=0.4, linestyle=(0, (6, 4))))
    axes.add_patch(_black(sheet.board, left + sheet.quiet_zone, bottom + sheet.quiet_zone))
    _draw_note(axes, sheet, left + 0.5 * cut_width, bottom)
    _draw_caption(axes, sheet.board, min(left, 0.5 * (size[0] - SMALLEST_WIDTH)), bottom,
                  max(cut_width, SMALLEST_WIDTH))


def black_cells(board: Board) -> np.ndarray:
    """(n, 3), in m: left, bottom and width of the squares that make up what is black.

    They lie side by side: a marker is drawn module by module.
    """
    rows: List[np.ndarray] = [np.array([[square.left, square.bottom, square.width]])
                              for square in board.squares]
    return np.concatenate(rows + [_marker_cells(marker) for marker in board.markers])


def _marker_cells(marker: BoardMarker) -> np.ndarray:
    bitmap = tag_bitmap(marker.family, marker.id)
    module = marker.size / bitmap.family.width_at_border
    count = len(bitmap.modules)
    rows, columns = np.nonzero(~bitmap.modules)
    return np.column_stack([marker.x + (columns - 0.5 * count) * module,
                            marker.y + (0.5 * count - 1.0 - rows) * module,
                            np.full(len(rows), module)])


def _black(board: Board, left: float, bottom: float) -> PathPatch:
    """All that is black, as one path: cells that only touch would show seams on a screen."""
    cells = 1e3 * black_cells(board)
    turn = np.array([(0, 0), (1, 0), (1, 1), (0, 1), (0, 0)])
    origin = np.array([left, bottom]) - 1e3 * np.array([board.left, board.bottom])
    vertices = origin + cells[:, None, :2] + cells[:, None, 2:] * turn
    codes = [Path.MOVETO, Path.LINETO, Path.LINETO, Path.LINETO, Path.CLOSEPOLY] * len(cells)
    # In a picture, edges stay where they are instead of moving to the next pixel.
    return PathPatch(Path(vertices.reshape(-1, 2), codes), facecolor="black", linewidth=0.0,
                     snap=False)


def _draw_note(axes: Axes, sheet: BoardSheet, centre: float, bottom: float) -> None:
    """A small, pale note on the quiet zone, which stays after cutting: what it is, how it hangs."""
    text = "  ·  ".join((sheet.board.name, *sheet.board.label, "lower edge"))
    height = min(2.5, 0.3 * sheet.quiet_zone, _fitting(text, sheet.cut_size[0]))
    axes.text(centre, bottom + 0.15 * sheet.quiet_zone, text, fontsize=points(height), color="0.55",
              ha="center", va="bottom")


def _draw_caption(axes: Axes, board: Board, left: float, bottom: float, width: float) -> None:
    """At the left: if a poster is cut there, each line is whole on one sheet of the first column."""
    style = {"ha": "left", "va": "top"}
    title = "{}   {}".format(board.name, board.label[0])
    axes.text(left, bottom - 3.0, title, fontsize=points(min(4.6, _fitting(title, width))),
              fontweight="bold", **style)
    height = min(2.6, _fitting(board.label[1], width))
    axes.text(left, bottom - 10.5, board.label[1] + "\nPrint at 100 %, not fitted to the page.",
              fontsize=points(height), color="0.25", linespacing=1.3, **style)
    draw_ruler(axes, left, bottom - CAPTION_HEIGHT + 5.0)


def _fitting(text: str, width: float) -> float:
    """The height in mm of letters with which the text is about that width."""
    return width / (LETTER_WIDTH * len(text))
