"""Calibration boards: Kalibr's AprilGrid and OpenCV's ChArUco, from files of a few lines."""

import os
from dataclasses import dataclass
from typing import Callable, Dict, List, Sequence, Tuple

from omnitag.tag_bitmap import APRILGRID, FAMILIES, tag_family
from omnitag.yaml_file import Mapping, Value, read_yaml

CHARUCO = "charuco"
TYPE_KEY = "target_type"
APRILGRID_KEYS = ("tagCols", "tagRows", "tagSize", "tagSpacing")
CHARUCO_KEYS = ("columns", "rows", "square_size", "marker_size", "dictionary", "legacy")


@dataclass(frozen=True)
class BoardMarker:
    """A marker of a board, upright on the upright board."""

    family: str
    id: int
    size: float  # m, outer edge of the black border
    x: float  # m, of the centre, to the right
    y: float  # m, of the centre, upwards


@dataclass(frozen=True)
class BlackSquare:
    """A square of a board that is black throughout."""

    left: float  # m
    bottom: float  # m
    width: float  # m


@dataclass(frozen=True)
class Board:
    """A board as one looks at it, upright: x to the right and y up, in metres.

    The origin is Kalibr's for an AprilGrid, the lower left corner of tag 0's black border; for ChArUco, it
    is the lower left corner of the board.
    """

    name: str
    """Of its file, without the folder."""
    kind: str
    """`aprilgrid` or `charuco`."""
    left: float
    """m: the left edge of what is drawn, black squares at the rim included."""
    bottom: float
    """m: the lower edge of what is drawn."""
    width: float
    """m, of what is drawn."""
    height: float
    """m, of what is drawn."""
    markers: Tuple[BoardMarker, ...]
    """By id: an AprilGrid's from the lower left, row by row upwards; ChArUco's from the upper left."""
    squares: Tuple[BlackSquare, ...]
    label: Tuple[str, ...]
    """Type, sizes in mm and ids, in two lines to be printed."""


def load_board(path: str) -> Board:
    """Read a board file, Kalibr's for an AprilGrid; raises InputError naming file, line and key."""
    value = read_yaml(path)
    kind_value = value.any_mapping()[TYPE_KEY]
    kind = kind_value.text()
    readers: Dict[str, Tuple[Sequence[str], Callable[[str, Mapping], Board]]] = {
        APRILGRID: (APRILGRID_KEYS, _aprilgrid), CHARUCO: (CHARUCO_KEYS, _charuco)}
    if kind not in readers:
        raise kind_value.error("one of " + ", ".join(readers))
    keys, read = readers[kind]
    return read(os.path.basename(path), value.mapping((TYPE_KEY, *keys)))


def _aprilgrid(name: str, root: Mapping) -> Board:
    """The board as Kalibr's GridCalibrationTargetAprilgrid and kalibr_create_target_pdf have it.

    Ids run from the lower left to the right, row by row upwards. Each tag has a black square at each
    corner, also at the rim, as wide as the gap: each black corner meets a black corner there, so that
    blur does not shift where they meet.
    """
    columns, rows = _count(root["tagCols"], 1), _count(root["tagRows"], 1)
    size, spacing = _length(root["tagSize"]), root["tagSpacing"].real()
    if not 0.0 < spacing <= 1.0:
        raise root["tagSpacing"].error("a share of tagSize above 0, up to 1")
    last_id = tag_family(APRILGRID).number_of_ids - 1
    if columns * rows - 1 > last_id:
        raise root["tagRows"].error("at most {} tags, ids 0 to {}".format(last_id + 1, last_id),
                                    "{} x {}".format(columns, rows))
    gap = spacing * size
    pitch = size + gap
    markers = tuple(BoardMarker(APRILGRID, columns * row + column, size,
                                column * pitch + 0.5 * size, row * pitch + 0.5 * size)
                    for row in range(rows) for column in range(columns))
    squares = tuple(BlackSquare(column * pitch - gap, row * pitch - gap, gap)
                    for row in range(rows + 1) for column in range(columns + 1))
    label = ("AprilGrid of {} x {} tags".format(columns, rows),
             "tagSize {} mm, tagSpacing {:.6g} ({} mm); ids 0 to {} from the lower left".format(
                 _mm(size), spacing, _mm(gap), len(markers) - 1))
    return Board(name, APRILGRID, -gap, -gap, columns * pitch + gap, rows * pitch + gap, markers,
                 squares, label)


def _charuco(name: str, root: Mapping) -> Board:
    """The board as OpenCV's CharucoBoard draws it (objdetect/src/aruco/aruco_board.cpp).

    From the upper left, squares whose row and column are both even or both odd are black; the others
    are white with a marker in the middle, whose ids run to the right, row by row downwards. Before
    OpenCV 4.6 (`legacy`) the square at the lower left was black, so that a board with an even number of
    rows began with a white one.
    """
    columns, rows = _count(root["columns"], 2), _count(root["rows"], 2)
    square, size = _length(root["square_size"]), _length(root["marker_size"])
    if size >= square:
        raise root["marker_size"].error("less than square_size, {:g}".format(square))
    legacy = "legacy" in root and root["legacy"].boolean()
    first_black = 1 if legacy and rows % 2 == 0 else 0
    places: List[Tuple[int, int]] = []
    squares: List[BlackSquare] = []
    for row in range(rows):
        for column in range(columns):
            if (row + column) % 2 == first_black:
                squares.append(BlackSquare(column * square, (rows - 1 - row) * square, square))
            else:
                places.append((row, column))
    family = _dictionary(root["dictionary"], len(places))
    markers = tuple(BoardMarker(family, index, size, (column + 0.5) * square,
                                (rows - row - 0.5) * square)
                    for index, (row, column) in enumerate(places))
    label = ("ChArUco of {} x {} squares{}".format(
                 columns, rows, ", as before OpenCV 4.6" if first_black else ""),
             "square_size {} mm, marker_size {} mm; {} ids 0 to {} from the upper left".format(
                 _mm(square), _mm(size), family, len(places) - 1))
    return Board(name, CHARUCO, 0.0, 0.0, columns * square, rows * square, markers, tuple(squares),
                 label)


def _count(value: Value, least: int) -> int:
    count = value.integer()
    if count < least:
        raise value.error("an integer of at least {}".format(least))
    return count


def _length(value: Value) -> float:
    length = value.real()
    if length <= 0.0:
        raise value.error("a positive number of metres")
    return length


def _dictionary(value: Value, count: int) -> str:
    name = value.text()
    dictionaries = [family for family in FAMILIES if family.startswith("DICT_")]
    if name not in dictionaries:
        raise value.error("one of " + ", ".join(dictionaries))
    available = tag_family(name).number_of_ids
    if available < count:
        raise value.error("a dictionary of at least {} markers".format(count),
                          "{}, which has {}".format(name, available))
    return name


def _mm(metres: float) -> str:
    return "{:.9g}".format(1e3 * metres)
