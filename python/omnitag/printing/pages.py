"""The pages of a map: its markers, whole or split over several sheets, and the list of their places."""

from functools import partial
from typing import Callable, List, NamedTuple, Tuple

from matplotlib.figure import Figure

from omnitag.marker_map import MarkerMap
from omnitag.printing.checklist import checklist_pages, draw_checklist
from omnitag.printing.paper import PAPERS, page_size
from omnitag.printing.poster import Tile, tile_figure, tiles
from omnitag.printing.tag_page import Sheet, draw_on, draw_page, sheets


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


def _pages_of_sheet(sheet: Sheet, paper: str, poster: bool) -> List[Page]:
    name = "{}-{}".format(sheet.marker.family, sheet.marker.text)
    least = sheet.least_page
    if poster and paper != "fit":
        parts = tiles(least, PAPERS[paper])
        if len(parts) > 1:
            return [Page("{}-{}-{}".format(name, tile.row + 1, tile.column + 1),
                         partial(_draw_tile, sheet, least, tile)) for tile in parts]
    what = "{}: a size of {:g} m".format(sheet.marker.kind, sheet.marker.size)
    return [Page(name, partial(draw_page, sheet, page_size(least, paper, what)))]


def _draw_tile(sheet: Sheet, page: Tuple[float, float], tile: Tile) -> Figure:
    figure = tile_figure(tile)
    draw_on(figure.axes[0], sheet, page)
    return figure
