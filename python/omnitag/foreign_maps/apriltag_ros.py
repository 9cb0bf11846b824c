"""The bundles of apriltag_ros's tags.yaml (ROS 1).

A bundle's tags have poses in the bundle's frame, as x, y, z and qw, qx, qy, qz. A tag's frame is the
same as a marker's in this package: seen from the front, x points to the right and y up; z points out of
its face. The family is in another file (settings.yaml).
"""

from typing import List, Optional

from omnitag.command_line import InputError
from omnitag.foreign_maps.placed_tags import (
    Given, ReadMap, check_id, checked_family, number, only_family, pose_of, unique_ids,
    unit_quaternion)
from omnitag.marker_map import Marker, MarkerMap
from omnitag.rotation import quaternion_from_rotation, rotation_from_quaternion
from omnitag.yaml_file import Mapping

NAME = "apriltag_ros"
FAMILY = "tag36h11"
IDENTITY = (0.0, 0.0, 0.0, 1.0)


def recognizes(root: Mapping) -> bool:
    """Whether the file has this format."""
    return "tag_bundles" in root or "standalone_tags" in root


def read(root: Mapping, given: Given, name: Optional[str]) -> ReadMap:
    """The map of the bundle of this name, or of the only bundle; raises InputError."""
    family = checked_family(given.family or FAMILY)
    bundle = _chosen(root, name)
    markers = tuple(_marker(value.any_mapping(), family)
                    for value in bundle["layout"].items("a list of tags"))
    if not markers:
        raise bundle["layout"].error("at least one tag", "an empty list")
    standalone = root.get("standalone_tags")
    count = len(list(standalone.items())) if standalone is not None else 0
    remarks = ("left out: {} standalone tags, which have no place".format(count),) if count else ()
    return ReadMap(MarkerMap(markers), remarks)


def text_of(marker_map: MarkerMap, path: str) -> str:
    """One bundle with all markers, named after the map's frame."""
    unique_ids(marker_map.markers, path, NAME)
    only_family(marker_map.markers, path, NAME)
    lines = ["standalone_tags:", "  [", "  ]", "tag_bundles:", "  [", "    {",
             "      name: '{}',".format(marker_map.frame_id.replace("'", "''")), "      layout:",
             "        ["]
    lines += ["          " + _entry(marker) for marker in marker_map.markers]
    lines += ["        ]", "    }", "  ]"]
    return "\n".join(lines) + "\n"


def _chosen(root: Mapping, name: Optional[str]) -> Mapping:
    if "tag_bundles" not in root:
        raise root.error("the key 'tag_bundles'", "standalone tags alone, which have no place")
    bundles = [value.any_mapping() for value in root["tag_bundles"].items("a list of bundles")]
    names: List[str] = [bundle["name"].text() if "name" in bundle else "bundle_{}".format(index)
                        for index, bundle in enumerate(bundles)]
    if name is None and len(bundles) == 1:
        return bundles[0]
    if name in names:
        return bundles[names.index(name)]
    raise InputError(str(root["tag_bundles"].error(
        "one of its bundles behind the file's name, as #{} (it has {})".format(
            names[0] if names else "NAME", ", ".join(names) or "none"),
        "none" if name is None else "'{}'".format(name))))


def _marker(tag: Mapping, family: str) -> Marker:
    size = tag["size"].real()
    if size <= 0.0:
        raise tag["size"].error("a positive number of metres")
    position = [_real(tag, key, 0.0) for key in "xyz"]
    quaternion = [_real(tag, key, value) for key, value in zip(("qx", "qy", "qz", "qw"), IDENTITY)]
    rotation = rotation_from_quaternion(unit_quaternion(quaternion, tag.error))
    return Marker(check_id(tag["id"].integer(), family, tag["id"].error), family, "", size,
                  pose_of(rotation, position))


def _real(tag: Mapping, key: str, default: float) -> float:
    return tag[key].real() if key in tag else default


def _entry(marker: Marker) -> str:
    x, y, z = marker.position
    qx, qy, qz, qw = quaternion_from_rotation(marker.map_from_marker[:3, :3])
    values = (("size", marker.size), ("x", x), ("y", y), ("z", z), ("qw", qw), ("qx", qx),
              ("qy", qy), ("qz", qz))
    return "{{id: {}, {}}},".format(
        marker.id, ", ".join("{}: {}".format(key, number(value)) for key, value in values))
