"""The map.txt of fiducial_slam (UbiquityRobotics).

A line for each marker: id, x, y, z (m), roll, pitch, yaw (degrees, about the fixed axes x, y, z),
variance, number of observations, ids of the markers that were seen together with it. A marker's frame
is the same as in this package: seen from the front, x points to the right and y up; z points out of its
face. The file has neither a family (aruco_detect's `dictionary`) nor a size (its `fiducial_len`).
"""

from typing import List, Optional

import numpy as np

from omnitag.command_line import InputError
from omnitag.foreign_maps.placed_tags import (
    Given, ReadMap, check_id, checked_family, deviation_of, number, only_family, only_size, pose_of,
    unique_ids)
from omnitag.marker_map import Marker, MarkerMap
from omnitag.rotation import rotation_from_rpy, rpy_from_rotation

NAME = "fiducial_slam"
EXPECTED = ("id, x, y, z, roll, pitch, yaw, variance and the number of observations, and perhaps "
            "ids behind them")
COLUMNS = 9


def recognizes(text: str) -> bool:
    """Whether the text has this format, by its first line that is not empty."""
    for line in text.splitlines():
        if line.strip():
            words = line.split()
            return len(words) >= COLUMNS and _numbers(words[:COLUMNS]) is not None
    return False


def read(text: str, path: str, given: Given) -> ReadMap:
    """The map of a file's text; raises InputError naming file and line."""
    if given.family is None or given.size is None:
        missing = "--family" if given.family is None else "--size"
        raise InputError("{}: {}: expected, since a map of fiducial_slam does not have it; found "
                         "none".format(path, missing))
    family = checked_family(given.family)
    markers = []
    for index, line in enumerate(text.splitlines(), start=1):
        if line.strip():
            markers.append(_marker(line, "{}:{}".format(path, index), family, given.size))
    return ReadMap(MarkerMap(tuple(markers)))


def text_of(marker_map: MarkerMap, path: str) -> str:
    """A line for each marker, with one observation."""
    unique_ids(marker_map.markers, path, NAME)
    only_family(marker_map.markers, path, NAME)
    only_size(marker_map.markers, path, NAME)
    lines = []
    for marker in marker_map.markers:
        angles = np.degrees(rpy_from_rotation(marker.map_from_marker[:3, :3]))
        values = (*marker.position, *angles, deviation_of(marker) ** 2)
        lines.append(" ".join([str(marker.id), *map(number, values), "1"]))
    return "\n".join(lines) + "\n"


def _numbers(words: List[str]) -> Optional[List[float]]:
    try:
        numbers = [float(word) for word in words]
    except ValueError:
        return None
    return numbers if np.all(np.isfinite(numbers)) and numbers[0] == int(numbers[0]) else None


def _marker(line: str, place: str, family: str, size: float) -> Marker:
    def error(expected: str, found: str = "'{}'".format(line.strip())) -> InputError:
        return InputError("{}: expected {}, found {}".format(place, expected, found))

    words = line.split()
    numbers = _numbers(words[:COLUMNS]) if len(words) >= COLUMNS else None
    if numbers is None or numbers[7] < 0.0:
        raise error(EXPECTED)
    rotation = rotation_from_rpy(*np.radians(numbers[4:7]))
    # The marker that the map was started from has a variance of 0.
    deviation = float(np.sqrt(numbers[7]))
    return Marker(check_id(int(numbers[0]), family, error), family, "", size,
                  pose_of(rotation, numbers[1:4]), deviation)
