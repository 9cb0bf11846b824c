"""TagSLAM's tagslam.yaml, and its poses.yaml, which has the same bodies.

A body has tags at poses in its own frame; a static body has a pose in the map. Rotations are vectors:
axis times angle. A tag's frame is the same as a marker's in this package: seen from the front, x points
to the right and y up; z points out of its face.
"""

from typing import List, Optional, Tuple

import numpy as np

from omnitag.command_line import InputError
from omnitag.foreign_maps.placed_tags import (
    Given, ReadMap, check_id, checked_family, deviation_of, number, only_family,
    orientation_deviation_of, pose_of, unique_ids)
from omnitag.marker_map import Marker, MarkerMap
from omnitag.rotation import rotation_from_vector, vector_from_rotation
from omnitag.yaml_file import Mapping, Value

NAME = "tagslam"
FAMILY = "tag36h11"
BODY = "map"


def recognizes(root: Mapping) -> bool:
    """Whether the file has this format."""
    return "bodies" in root


def read(root: Mapping, given: Given) -> ReadMap:
    """The map of all static bodies; raises InputError naming file, line and key."""
    family = checked_family(given.family or FAMILY)
    markers: List[Marker] = []
    left_out: List[str] = []
    for value in root["bodies"].items("a list of bodies"):
        item = value.any_mapping()
        for name in item.keys():
            body = item[name].any_mapping()
            if "tags" not in body:
                continue
            if "is_static" not in body or body["is_static"].text() != "true":
                left_out.append("tags of '{}', which moves".format(name))
                continue
            map_from_body = _pose(body["pose"])
            for tag_value in body["tags"].items("a list of tags"):
                tag = tag_value.any_mapping()
                if "pose" not in tag:
                    left_out.append("tag {}, which has no pose".format(tag["id"].integer()))
                    continue
                size = _size(tag, body, given.size)
                markers.append(_marker(tag, map_from_body, family, size))
    if not markers:
        raise root["bodies"].error("a static body that has a tag with a pose", "none")
    remarks = ("left out: " + ", ".join(left_out),) if left_out else ()
    return ReadMap(MarkerMap(tuple(markers)), remarks)


def text_of(marker_map: MarkerMap, path: str) -> str:
    """One static body at the map's origin, with all markers."""
    unique_ids(marker_map.markers, path, NAME)
    only_family(marker_map.markers, path, NAME)
    lines = ["default_body: " + BODY, "bodies:", " - " + BODY + ":", "     type: simple",
             "     is_static: true",
             "     default_tag_size: " + number(marker_map.markers[0].size), "     pose:"]
    lines += _pose_lines("       ", np.eye(4), 1e-6, 1e-6)
    lines.append("     tags:")
    for marker in marker_map.markers:
        lines += ["     - id: {}".format(marker.id), "       size: " + number(marker.size),
                  "       pose:"]
        lines += _pose_lines("         ", marker.map_from_marker, deviation_of(marker),
                             orientation_deviation_of(marker))
    return "\n".join(lines) + "\n"


def _size(tag: Mapping, body: Mapping, given: Optional[float]) -> float:
    """In m: the tag's own size, else its body's, else the given one."""
    value = tag["size"] if "size" in tag else body.get("default_tag_size")
    if value is not None:
        size = value.real()
        if size <= 0.0:
            raise value.error("a positive number of metres")
        return size
    if given is None:
        raise tag.error("'size' or the body's 'default_tag_size', or --size", "none")
    return given


def _marker(tag: Mapping, map_from_body: np.ndarray, family: str, size: float) -> Marker:
    noise = tag["pose"].any_mapping()
    return Marker(check_id(tag["id"].integer(), family, tag["id"].error), family, "", size,
                  map_from_body @ _pose(tag["pose"]), _deviation(noise, "position_noise"),
                  _deviation(noise, "rotation_noise"))


def _pose(value: Value) -> np.ndarray:
    pose = value.any_mapping()
    return pose_of(rotation_from_vector(_vector(pose["rotation"])), _vector(pose["position"]))


def _vector(value: Value) -> Tuple[float, float, float]:
    entry = value.any_mapping()
    return entry["x"].real(), entry["y"].real(), entry["z"].real()


def _deviation(pose: Mapping, key: str) -> Optional[float]:
    if key not in pose:
        return None
    noise = np.array(_vector(pose[key]))
    if np.any(noise < 0.0):
        raise InputError(str(pose[key].error("numbers of at least 0", "one below")))
    return float(np.sqrt(np.mean(noise ** 2)))


def _pose_lines(indent: str, pose: np.ndarray, deviation: float,
                orientation_deviation: float) -> List[str]:
    vectors = (("position", pose[:3, 3]), ("rotation", vector_from_rotation(pose[:3, :3])),
               ("position_noise", np.full(3, max(deviation, 1e-6))),
               ("rotation_noise", np.full(3, max(orientation_deviation, 1e-6))))
    lines = []
    for name, vector in vectors:
        lines.append(indent + name + ":")
        lines += ["{}  {}: {}".format(indent, axis, number(value))
                  for axis, value in zip("xyz", vector)]
    return lines
