"""Conversion of marker maps between this package's format and those of other packages."""

import os
from typing import NamedTuple, Optional, Tuple

from omnitag.command_line import InputError
from omnitag.foreign_maps import apriltag_ros, fiducial_slam, tagslam, wpilib
from omnitag.foreign_maps.placed_tags import Given, ReadMap
from omnitag.map_text import map_text
from omnitag.marker_map import MarkerMap, load_marker_map
from omnitag.yaml_file import read_text, read_yaml

OWN = "omnitag"
WRITERS = {"wpilib": wpilib.text_of, "tagslam": tagslam.text_of,
           "fiducial_slam": fiducial_slam.text_of, "apriltag_ros": apriltag_ros.text_of}
FORMATS = (OWN, *WRITERS)


class Conversion(NamedTuple):
    """A map's text in a format, with remarks for the user, one per line."""

    text: str
    format: str
    remarks: Tuple[str, ...]
    marker_count: int


def convert(source: str, output: str, wanted: Optional[str], given: Given) -> Conversion:
    """Convert the map `source` to the format `wanted`, for the file `output`; None: this package's.

    Raises InputError if it is not a map, or one that the format cannot hold.
    """
    path, part = _place_of(source)
    own, read = _read(path, part, given)
    if wanted is None:
        if own:
            raise InputError("--to: expected one of {}, since {} is a map of this package "
                             "already; found none".format(", ".join(WRITERS), path))
        wanted = OWN
    marker_map = read.marker_map
    if wanted == OWN:
        text = map_text(marker_map, output)
    else:
        _refuse_patterns(marker_map, path, wanted)
        text = WRITERS[wanted](marker_map, path)
    return Conversion(text, wanted, read.remarks, len(marker_map.markers))


def _place_of(source: str) -> Tuple[str, Optional[str]]:
    """A file, and the part of it that is named after a '#'."""
    path, mark, part = source.rpartition("#")
    return (path, part) if mark and not os.path.exists(source) else (source, None)


def path_of(source: str) -> str:
    """The file of PATH#NAME."""
    return _place_of(source)[0]


def _read(path: str, part: Optional[str], given: Given) -> Tuple[bool, ReadMap]:
    """Whether the file has this package's format, and its map."""
    text = read_text(path)
    if fiducial_slam.recognizes(text):
        _refuse_part(path, part)
        return False, fiducial_slam.read(text, path, given)
    root = read_yaml(path).any_mapping()
    if apriltag_ros.recognizes(root):
        return False, apriltag_ros.read(root, given, part)
    _refuse_part(path, part)
    if wpilib.recognizes(root):
        return False, wpilib.read(root, given)
    if tagslam.recognizes(root):
        return False, tagslam.read(root, given)
    if "markers" not in root:
        raise root.error(
            "a map: the key 'markers', or 'tags' (WPILib), 'bodies' (tagslam) or 'tag_bundles' "
            "(apriltag_ros), or lines of numbers (fiducial_slam)", "none of these")
    for name, value in (("--family", given.family), ("--size", given.size)):
        if value is not None:
            raise InputError("{}: expected none, since {} has it; found {}".format(
                name, path, value))
    return True, ReadMap(load_marker_map(path))


def _refuse_patterns(marker_map: MarkerMap, path: str, wanted: str) -> None:
    for marker in marker_map.markers:
        if marker.pattern is not None:
            raise InputError("{}: expected markers that have ids, as {} needs them, found the pattern "
                             "{}".format(path, wanted, marker.pattern.name))


def _refuse_part(path: str, part: Optional[str]) -> None:
    if part is not None:
        raise InputError("{}: expected a file that has bundles, as apriltag_ros writes them, by "
                         "the name '{}', found another".format(path, part))
