"""The marker map: which markers hang where."""

import os
from collections import Counter
from dataclasses import dataclass, replace
from typing import Dict, Hashable, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from omnitag.command_line import InputError
from omnitag.pattern_file import Pattern, read_pattern
from omnitag.rotation import rotation_from_quaternion
from omnitag.tag_bitmap import FAMILIES, tag_family
from omnitag.yaml_file import Mapping, Value, read_yaml

MAP_KEYS = ("frame_id", "family", "size", "border", "deviation", "orientation_deviation", "markers",
            "constraints")
MARKER_KEYS = ("id", "name", "family", "pattern", "border", "size", "position", "yaw", "roll",
               "orientation", "deviation", "orientation_deviation")
QUATERNION_TOLERANCE = 1e-3

ARTOOLKIT = "artoolkit"
"""The family of markers that have a pattern instead of an id."""

BORDER = 0.25
LEAST_BORDER, LARGEST_BORDER = 0.05, 0.4

Key = Tuple[str, int]
"""Family and id of a marker."""

# In the AprilTag library's order, in the marker's frame, in units of half the size.
_CORNER_SIGNS = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])


@dataclass(frozen=True)
class BorderedPattern:
    """What an ARToolKit marker shows: a pattern within a black border."""

    path: str  # of the pattern's file
    border: float  # width as a share of the marker's edge, on each side
    picture: Pattern

    @property
    def name(self) -> str:
        """The file's name without its ending."""
        return os.path.splitext(os.path.basename(self.path))[0]

    @property
    def file_key(self) -> Tuple[str, float]:
        """What tells patterns of one map apart: the file and the border."""
        return os.path.realpath(self.path), self.border

    @property
    def looks(self) -> Hashable:
        """What tells patterns of several maps apart, wherever their files are."""
        return self.picture.colours.tobytes(), self.border


@dataclass(frozen=True)
class Marker:
    """One entry of the map.

    The marker's frame has its origin at the centre. Seen from the front, with the marker upright, x
    points to the right and y up; z points out of its face.
    """

    id: int  # of a pattern: the index of the map's first entry that has it
    family: str
    name: str  # empty if the map gives none
    size: float  # m, edge of the square between the corners that the detector reports
    map_from_marker: np.ndarray  # (4, 4)
    deviation: Optional[float] = None  # m, along each axis; None: not in the map
    orientation_deviation: Optional[float] = None  # rad
    pattern: Optional[BorderedPattern] = None  # of the family artoolkit, only

    @property
    def key(self) -> Key:
        """Family and id, which a map may have at several places."""
        return self.family, self.id

    @property
    def identity(self) -> Hashable:
        """What it has in common with the same marker in another map: family and id, or its looks."""
        return self.key if self.pattern is None else (self.family, self.pattern.looks)

    @property
    def kind(self) -> str:
        """Family and id to read, as 'tag36h11 id 3', or family and pattern, as 'artoolkit hiro'."""
        return "{} {}{}".format(self.family, "" if self.pattern else "id ", self.text)

    @property
    def text(self) -> str:
        """Its id, or its pattern's name."""
        return str(self.id) if self.pattern is None else self.pattern.name

    @property
    def position(self) -> np.ndarray:
        """The centre in the map, in m."""
        return self.map_from_marker[:3, 3]

    @property
    def normal(self) -> np.ndarray:
        """The outward normal in the map, of unit length."""
        return self.map_from_marker[:3, 2]

    @property
    def corners(self) -> np.ndarray:
        """(4, 3), in m: the corners in the map, in the AprilTag library's order.

        Seen from the front, with the marker upright: lower left, lower right, upper right, upper
        left.
        """
        in_marker = np.zeros((4, 3))
        in_marker[:, :2] = 0.5 * self.size * _CORNER_SIGNS
        return in_marker @ self.map_from_marker[:3, :3].T + self.position

    @property
    def label(self) -> str:
        """Its name, or its id or its pattern's name if it has none."""
        return self.name or self.text


class MarkerDefaults(NamedTuple):
    """Defaults of the entries; None: each entry must state it."""

    family: Optional[str] = None
    size: Optional[float] = None  # m
    deviation: Optional[float] = None  # m
    orientation_deviation: Optional[float] = None  # rad
    border: float = BORDER  # of patterns, as a share of the marker's edge


@dataclass(frozen=True)
class MarkerMap:
    """Markers in the frame `frame_id`, in the order of the file."""

    markers: Tuple[Marker, ...]
    frame_id: str = "map"
    defaults: MarkerDefaults = MarkerDefaults()


def unique_markers(marker_map: MarkerMap) -> Dict[Hashable, Marker]:
    """The markers that the map has exactly once, by their `identity`."""
    counts = Counter(marker.identity for marker in marker_map.markers)
    return {marker.identity: marker for marker in marker_map.markers
            if counts[marker.identity] == 1}


def with_pattern_ids(markers: Sequence[Marker]) -> Tuple[Marker, ...]:
    """The entries of a map; the id of each pattern becomes the index of its first entry."""
    first: Dict[Tuple[str, float], int] = {}
    return tuple(
        marker if marker.pattern is None
        else replace(marker, id=first.setdefault(marker.pattern.file_key, index))
        for index, marker in enumerate(markers))


def load_marker_map(path: str) -> MarkerMap:
    """Read a marker map; raises InputError naming file, line and key."""
    root = read_yaml(path).mapping(MAP_KEYS)
    frame_id = root["frame_id"].text() if "frame_id" in root else MarkerMap.frame_id
    defaults = MarkerDefaults(_family(root["family"]) if "family" in root else None,
                              _size(root["size"]) if "size" in root else None,
                              *_deviations(root),
                              _border(root["border"]) if "border" in root else BORDER)
    markers: List[Marker] = []
    names: Dict[str, int] = {}
    for value in root["markers"].items("a list of markers"):
        entry = value.mapping(MARKER_KEYS)
        marker = read_marker(entry, defaults)
        if marker.name:
            if marker.name in names:
                raise entry["name"].error(
                    "a name of its own",
                    "'{}', the name of markers[{}]".format(marker.name, names[marker.name]))
            names[marker.name] = len(markers)
        markers.append(marker)
    if not markers:
        raise root["markers"].error("at least one marker", "an empty list")
    return MarkerMap(with_pattern_ids(markers), frame_id, defaults)


def rotation_from_yaw_and_roll(yaw: float, roll: float = 0.0) -> np.ndarray:
    """map_from_marker, (3, 3), of a marker on a vertical surface; angles in rad."""
    sine, cosine = np.sin(yaw), np.cos(yaw)
    upright = np.array([[-sine, 0.0, cosine], [cosine, 0.0, sine], [0.0, 1.0, 0.0]])
    return upright @ np.array([[np.cos(roll), -np.sin(roll), 0.0],
                               [np.sin(roll), np.cos(roll), 0.0], [0.0, 0.0, 1.0]])


def yaw_and_roll_from_rotation(map_from_marker: np.ndarray) -> Tuple[float, float]:
    """The inverse of `rotation_from_yaw_and_roll`, only for a marker on a vertical surface."""
    return (float(np.arctan2(map_from_marker[1, 2], map_from_marker[0, 2])),
            float(np.arctan2(map_from_marker[2, 0], map_from_marker[2, 1])))


def read_marker(entry: Mapping, defaults: MarkerDefaults) -> Marker:
    """Read an entry in the map's format; raises InputError naming file, line and key.

    A pattern's id is 0: it depends on the map's other entries, see `with_pattern_ids`.
    """
    family, size = defaults.family, defaults.size
    if "family" in entry or family is None:
        family = _family(entry["family"])
    if "size" in entry or size is None:
        size = _size(entry["size"])
    pattern = _bordered_pattern(entry, defaults) if family == ARTOOLKIT else None
    tag_id = 0 if pattern else _id(entry, family)
    map_from_marker = np.eye(4)
    map_from_marker[:3, :3] = read_rotation(entry)
    map_from_marker[:3, 3] = entry["position"].reals(3)
    name = entry["name"].text() if "name" in entry else ""
    deviation, orientation_deviation = _deviations(entry)
    return Marker(tag_id, family, name, size, map_from_marker,
                  defaults.deviation if deviation is None else deviation,
                  defaults.orientation_deviation if orientation_deviation is None
                  else orientation_deviation, pattern)


def read_rotation(entry: Mapping) -> np.ndarray:
    """map_from_marker, (3, 3), from an entry's `yaw` and `roll` or its `orientation`."""
    if "orientation" not in entry:
        if "yaw" not in entry:
            raise entry.error("'yaw' or 'orientation'", "neither")
        return rotation_from_yaw_and_roll(entry["yaw"].real(),
                                          entry["roll"].real() if "roll" in entry else 0.0)
    for key in ("yaw", "roll"):
        if key in entry:
            raise entry[key].error("either yaw and roll or orientation", "both")
    quaternion = np.array(entry["orientation"].reals(4))
    length = float(np.linalg.norm(quaternion))
    if abs(length - 1.0) > QUATERNION_TOLERANCE:
        raise entry["orientation"].error("a quaternion of length 1",
                                         "length {:.6g}".format(length))
    return rotation_from_quaternion(quaternion / length)


def _id(entry: Mapping, family: str) -> int:
    for key in ("pattern", "border"):
        if key in entry:
            raise entry[key].error("this key only in the family " + ARTOOLKIT,
                                   "it in {}".format(family))
    tag_id = entry["id"].integer()
    last_id = tag_family(family).number_of_ids - 1
    if not 0 <= tag_id <= last_id:
        raise entry["id"].error("0 to {} in {}".format(last_id, family))
    return tag_id


def _bordered_pattern(entry: Mapping, defaults: MarkerDefaults) -> BorderedPattern:
    if "id" in entry:
        raise entry["id"].error("a pattern instead, in the family " + ARTOOLKIT)
    border = _border(entry["border"]) if "border" in entry else defaults.border
    path = entry["pattern"].path()
    try:
        return BorderedPattern(path, border, read_pattern(path))
    except InputError as error:
        raise entry["pattern"].error("a pattern file", str(error))


def _border(value: Value) -> float:
    border = value.real()
    if not LEAST_BORDER <= border <= LARGEST_BORDER:
        raise value.error("a share of the marker's edge from {:g} to {:g}".format(
            LEAST_BORDER, LARGEST_BORDER))
    return border


def _deviations(entry: Mapping) -> Tuple[Optional[float], Optional[float]]:
    deviations = []
    for key in ("deviation", "orientation_deviation"):
        number = entry[key].real() if key in entry else None
        if number is not None and number < 0.0:
            raise entry[key].error("a number of at least 0")
        deviations.append(number)
    return deviations[0], deviations[1]


def _family(value: Value) -> str:
    family = value.text()
    if family not in FAMILIES and family != ARTOOLKIT:
        raise value.error("one of {}, {}".format(", ".join(FAMILIES), ARTOOLKIT))
    return family


def _size(value: Value) -> float:
    size = value.real()
    if size <= 0.0:
        raise value.error("a positive number of metres")
    return size
