"""WPILib's field layout (AprilTagFieldLayout), used by FRC teams and PhotonVision.

JSON. The field's frame has x along the field, y to the left, z up, and its origin in a corner. A tag's
frame has x out of its face and z up; y then points to the viewer's right. The game determines family
and size: since 2024 tag36h11, whose black border is 6.5 inches wide.
"""

import json
from typing import Dict

import numpy as np

from omnitag.foreign_maps.placed_tags import (
    Given, ReadMap, check_id, checked_family, only_family, only_size, pose_of, unique_ids,
    unit_quaternion)
from omnitag.marker_map import Marker, MarkerMap
from omnitag.rotation import quaternion_from_rotation, rotation_from_quaternion
from omnitag.yaml_file import Mapping, Value

NAME = "WPILib's field layout"
FAMILY = "tag36h11"
SIZE = 0.1651  # m

TAG_FROM_MARKER = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])


def recognizes(root: Mapping) -> bool:
    """Whether the file has this format."""
    return "tags" in root


def read(root: Mapping, given: Given) -> ReadMap:
    """The map of a layout; raises InputError naming file, line and key."""
    family = checked_family(given.family or FAMILY)
    size = given.size or SIZE
    markers = tuple(_marker(value.any_mapping(), family, size)
                    for value in root["tags"].items("a list of tags"))
    if not markers:
        raise root["tags"].error("at least one tag", "an empty list")
    remarks = []
    if given.family is None or given.size is None:
        remarks.append("a field layout has no family and size: taken as {} of {:g} m".format(
            family, size))
    return ReadMap(MarkerMap(markers), tuple(remarks))


def text_of(marker_map: MarkerMap, path: str) -> str:
    """The layout of a map; the field extends to the farthest marker."""
    unique_ids(marker_map.markers, path, NAME)
    only_family(marker_map.markers, path, NAME)
    only_size(marker_map.markers, path, NAME)
    far = np.max([marker.position for marker in marker_map.markers], axis=0)
    layout = {"tags": [_tag(marker) for marker in marker_map.markers],
              "field": {"length": _rounded(max(far[0], 0.0)), "width": _rounded(max(far[1], 0.0))}}
    return json.dumps(layout, indent=2) + "\n"


def _marker(tag: Mapping, family: str, size: float) -> Marker:
    tag_id = check_id(tag["ID"].integer(), family, tag["ID"].error)
    pose = tag["pose"].any_mapping()
    translation = pose["translation"].any_mapping()
    rotation = pose["rotation"].any_mapping()["quaternion"]
    quaternion = unit_quaternion(_reals(rotation, "XYZW"), rotation.error)
    return Marker(tag_id, family, "", size,
                  pose_of(rotation_from_quaternion(quaternion) @ TAG_FROM_MARKER,
                          [translation[axis].real() for axis in "xyz"]))


def _reals(value: Value, keys: str) -> np.ndarray:
    entry = value.any_mapping()
    return np.array([entry[key].real() for key in keys])


def _tag(marker: Marker) -> Dict[str, object]:
    x, y, z, w = quaternion_from_rotation(marker.map_from_marker[:3, :3] @ TAG_FROM_MARKER.T)
    translation = {axis: _rounded(value) for axis, value in zip("xyz", marker.position)}
    return {"ID": marker.id,
            "pose": {"translation": translation,
                     "rotation": {"quaternion": {"W": _rounded(w), "X": _rounded(x),
                                                 "Y": _rounded(y), "Z": _rounded(z)}}}}


def _rounded(value: float) -> float:
    return round(float(value), 12) + 0.0
