"""A list of the markers with their places, for hanging them and ticking them off."""

import math
from typing import List, NamedTuple, Sequence, Tuple

from matplotlib.figure import Figure

from omnitag.marker_map import Marker, MarkerMap
from omnitag.printing.paper import MARGIN, blank_page, points

ROW = 7.0  # mm
HEAD = 22.0  # mm
TITLES = ("", "marker", "family, id or pattern", "size", "x", "y", "centre", "lower edge", "faces")


class Part(NamedTuple):
    """The part of the list that is on one page."""

    title: str
    markers: Sequence[Marker]


def checklist_pages(marker_map: MarkerMap, paper: Tuple[float, float]) -> List[Part]:
    """The pages of the list, on sheets of that width and height in mm."""
    markers = marker_map.markers
    per_page = max(1, int((paper[1] - 2.0 * MARGIN - HEAD) / ROW))
    count = math.ceil(len(markers) / per_page)
    title = "Markers in the frame '{}', in metres".format(marker_map.frame_id)
    return [Part(title + (" ({} of {})".format(page + 1, count) if count > 1 else ""),
                 markers[page * per_page:(page + 1) * per_page]) for page in range(count)]


def row_of(marker: Marker) -> Tuple[str, ...]:
    """A marker's row of the list, from its name on."""
    lowest = float(marker.corners[:, 2].min())
    x, y, height = marker.position
    return (marker.name, "{} {}".format(marker.family, marker.text), "{:g}".format(marker.size),
            "{:.3f}".format(x), "{:.3f}".format(y), "{:.3f}".format(height),
            "{:.3f}".format(lowest), _facing(marker))


def _facing(marker: Marker) -> str:
    """Which way the marker faces, and how it is rolled."""
    x, y, up = marker.normal
    if abs(up) > math.sin(math.radians(80.0)):
        return "up" if up > 0.0 else "down"
    text = "{:.1f}°".format(math.degrees(math.atan2(y, x)))
    right, top = marker.map_from_marker[2, :2]
    roll = math.degrees(math.atan2(right, top))
    tilt = math.degrees(math.asin(max(-1.0, min(1.0, up))))
    if abs(roll) > 0.05:
        text += ", turned {:.1f}°".format(roll)
    if abs(tilt) > 0.05:
        text += ", tilted {:.1f}°".format(tilt)
    return text


def draw_checklist(part: Part, paper: Tuple[float, float]) -> Figure:
    """Draw one page of the list."""
    width, height = paper
    figure, axes = blank_page(paper)
    left, right = MARGIN, width - MARGIN
    # The left ends of the columns, as shares of the width.
    columns = [left + share * (right - left)
               for share in (0.0, 0.04, 0.22, 0.41, 0.48, 0.56, 0.64, 0.72, 0.82)]
    y = height - MARGIN - 6.0
    axes.text(left, y, part.title, fontsize=points(3.6), fontweight="bold", va="center")
    axes.text(left, y - 6.0, "Heights are of the centre and of the lower edge of the pattern above "
              "the floor; 'faces' is the heading of the face, from x to y.", fontsize=points(2.2),
              color="0.3", va="center")
    y = height - MARGIN - HEAD
    style = {"fontsize": points(2.2), "va": "center"}
    for x, words in zip(columns, TITLES):
        axes.text(x, y + 4.0, words, fontweight="bold", **style)
    for marker in part.markers:
        axes.plot([left, right], [y, y], color="0.8", linewidth=0.3)
        middle = y - 0.5 * ROW
        axes.plot([left, left + 3.0, left + 3.0, left, left],
                  [middle - 1.5, middle - 1.5, middle + 1.5, middle + 1.5, middle - 1.5],
                  color="0.3", linewidth=0.5)
        for x, words in zip(columns[1:], row_of(marker)):
            axes.text(x, middle, words, **style)
        y -= ROW
    return figure
