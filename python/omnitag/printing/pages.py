"""The pages of a map or a board, whole or split over several sheets, and the list of a map's places."""

from functools import partial
from typing import Callable, List, NamedTuple, Tuple

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from omnitag.board_file import Board
from omnitag.marker_map import MarkerMap
from omnitag.printing.board_page import BoardSheet, draw_board_on
from omnitag.printing.checklist import checklist_pages, draw_checklist
from omnitag.printing.paper import PAPERS, blank_page, fitting_page, page_size
from omnitag.printing.poster import Tile, tile_figure, tiles
from omnitag.printing.tag_page import Sheet, draw_on, sheets


class Page(NamedTuple):
    """A page that is drawn when it is needed."""

    name: str  # used in the file's name
    draw: Callable[[], Figure]


def pages_of(marker_map: MarkerMap, paper: str, poster: bool, with_checklist: bool) -> List[Page]:
    """All pages on that paper.

    `poster`: split what is too large for the paper over several sheets. Without it, raises InputError if
    the paper is too small.
    """
    pages: List[Page] = []
    for sheet in sheets(marker_map.markers):
        pages += _pages_of_sheet(sheet, paper, poster)
    if with_checklist:
        size = PAPERS["a4" if paper == "fit" else paper]
        pages += [Page("checklist", partial(draw_checklist, part, size))
                  for part in checklist_pages(marker_map, size)]
    return pages


def pages_of_board(board: Board, paper: str, poster: bool) -> List[Page]:
    """The board on one page, upright or on its side, or with `poster` on as many as it takes.

    Without `poster`, raises InputError if the paper is too small.
    """
    sheet = BoardSheet(board)
    what = "a board of {:.0f} x {:.0f} mm".format(1e3 * board.width, 1e3 * board.height)
    return _pages(_Drawn(board.kind, what, sheet.least_page, partial(_draw_board, sheet), True), paper,
                  poster)


class _Drawn(NamedTuple):
    """What is drawn on one page if the paper is large enough."""

    name: str
    what: str  # for errors
    least_page: Tuple[float, float]  # width and height in mm
    draw_on: Callable[[Axes, Tuple[float, float]], None]  # a page of that width and height in mm
    turned: bool  # may lie on its side


def _pages_of_sheet(sheet: Sheet, paper: str, poster: bool) -> List[Page]:
    name = "{}-{}".format(sheet.marker.family, sheet.marker.text)
    what = "{}: a size of {:g} m".format(sheet.marker.kind, sheet.marker.size)
    return _pages(_Drawn(name, what, sheet.least_page, partial(_draw_marker, sheet), False), paper, poster)


def _pages(drawn: _Drawn, paper: str, poster: bool) -> List[Page]:
    least = drawn.least_page
    if poster and paper != "fit" and not fitting_page(least, paper, drawn.turned):
        return [Page("{}-{}-{}".format(drawn.name, tile.row + 1, tile.column + 1),
                     partial(_draw_tile, drawn, tile)) for tile in tiles(least, PAPERS[paper])]
    size = page_size(least, paper, drawn.what, drawn.turned)
    return [Page(drawn.name, partial(_draw_page, drawn, size))]


def _draw_page(drawn: _Drawn, size: Tuple[float, float]) -> Figure:
    figure, axes = blank_page(size)
    drawn.draw_on(axes, size)
    return figure


def _draw_tile(drawn: _Drawn, tile: Tile) -> Figure:
    figure = tile_figure(tile)
    drawn.draw_on(figure.axes[0], drawn.least_page)
    return figure


def _draw_marker(sheet: Sheet, axes: Axes, size: Tuple[float, float]) -> None:
    draw_on(axes, sheet, size)


def _draw_board(sheet: BoardSheet, axes: Axes, size: Tuple[float, float]) -> None:
    draw_board_on(axes, sheet, size)
