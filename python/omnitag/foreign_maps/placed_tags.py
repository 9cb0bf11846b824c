"""What the formats of all other packages share."""

from typing import Dict, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from omnitag.command_line import InputError
from omnitag.marker_map import Marker, MarkerMap
from omnitag.rotation import Numbers
from omnitag.tag_bitmap import FAMILIES, tag_family

QUATERNION_TOLERANCE = 1e-3

# Of a map that does not state them: a careful survey with a tape.
USUAL_DEVIATION = 0.005  # m
USUAL_ORIENTATION_DEVIATION = 0.0175  # rad


class Given(NamedTuple):
    """What the command line states about a map because its format cannot."""

    family: Optional[str] = None
    size: Optional[float] = None  # m


class ReadMap(NamedTuple):
    """A map, with remarks for the user on how it was read, one per line."""

    marker_map: MarkerMap
    remarks: Tuple[str, ...] = ()


def pose_of(rotation: np.ndarray, position: Sequence[float]) -> np.ndarray:
    """(4, 4) transform."""
    pose = np.eye(4)
    pose[:3, :3] = rotation
    pose[:3, 3] = position
    return pose


def unit_quaternion(quaternion: Numbers, error) -> np.ndarray:
    """The quaternion, normalized; raises what `error` returns if its length is not nearly 1."""
    length = float(np.linalg.norm(quaternion))
    if abs(length - 1.0) > QUATERNION_TOLERANCE:
        raise error("a quaternion of length 1", "length {:.6g}".format(length))
    return np.asarray(quaternion) / length


def checked_family(family: str) -> str:
    """The name, checked to be a family of the AprilTag library or a dictionary of OpenCV."""
    if family not in FAMILIES and not family.startswith("DICT_"):
        raise InputError("--family: expected one of {} or OpenCV's name of a dictionary, DICT_..., "
                         "found '{}'".format(", ".join(FAMILIES), family))
    return family


def check_id(tag_id: int, family: str, error) -> int:
    """The id; raises what `error` returns if the family does not have it."""
    last = tag_family(family).number_of_ids - 1 if family in FAMILIES else None
    if tag_id < 0 or (last is not None and tag_id > last):
        raise error("an id of {}{}".format(family, "" if last is None else ", 0 to %d" % last))
    return tag_id


def unique_ids(markers: Sequence[Marker], path: str, format_name: str) -> None:
    """Raises InputError if two markers have the same id: the format cannot tell them apart."""
    seen: Dict[int, Marker] = {}
    for marker in markers:
        if marker.id in seen:
            raise InputError("{}: expected each id once, as {} needs it, found {} twice".format(
                path, format_name, marker.id))
        seen[marker.id] = marker


def only_family(markers: Sequence[Marker], path: str, format_name: str) -> str:
    """The family of all markers; raises InputError if there are several."""
    families: List[str] = sorted({marker.family for marker in markers})
    if len(families) > 1:
        raise InputError("{}: expected markers of one family, as {} needs it, found {}".format(
            path, format_name, ", ".join(families)))
    return families[0]


def only_size(markers: Sequence[Marker], path: str, format_name: str) -> float:
    """The size of all markers, in m; raises InputError if there are several."""
    sizes = sorted({marker.size for marker in markers})
    if len(sizes) > 1:
        raise InputError("{}: expected markers of one size, as {} needs it, found {}".format(
            path, format_name, ", ".join("{:g}".format(size) for size in sizes)))
    return sizes[0]


def deviation_of(marker: Marker) -> float:
    """In m, along each axis."""
    return USUAL_DEVIATION if marker.deviation is None else marker.deviation


def orientation_deviation_of(marker: Marker) -> float:
    """In rad, about each axis."""
    return (USUAL_ORIENTATION_DEVIATION if marker.orientation_deviation is None
            else marker.orientation_deviation)


def number(value: float) -> str:
    """Rounded to a billionth."""
    return "{:.9f}".format(round(float(value), 9) + 0.0)
