"""The markers that really hang in the room: those of the map, and the differences from it."""

from dataclasses import replace
from typing import List, NamedTuple, Optional, Tuple

import numpy as np

from omnitag.marker_map import (
    MARKER_KEYS, Marker, MarkerMap, read_marker, read_rotation, rotation_from_yaw_and_roll,
    yaw_and_roll_from_rotation)
from omnitag.rendering.stretches import ALWAYS, Stretches, read_during
from omnitag.yaml_file import Mapping, Value

UPRIGHT_TOLERANCE = 1e-3
_POSE_KEYS = ("position", "yaw", "roll", "orientation")


class Change(NamedTuple):
    """A map entry that does not match the room."""

    map_entry: int
    """Its index, from 0."""
    marker: Optional[Marker]
    """What hangs instead; None if the marker is missing."""
    during: Stretches


class Decoy(NamedTuple):
    """A marker that is not in the map."""

    marker: Marker
    during: Stretches


class HungMarkers(NamedTuple):
    """The markers in the room. If several changes of a marker apply at a time, the last one counts."""

    mapped: Tuple[Marker, ...]
    changes: Tuple[Change, ...]
    decoys: Tuple[Decoy, ...]

    def at(self, moment: int) -> List[Marker]:
        """What hangs at `moment`, in nanoseconds on the route's clock."""
        hung: List[Optional[Marker]] = list(self.mapped)
        for change in self.changes:
            if change.during.cover(moment):
                hung[change.map_entry] = change.marker
        hung += [decoy.marker for decoy in self.decoys if decoy.during.cover(moment)]
        return [marker for marker in hung if marker is not None]

    def ever(self) -> List[Marker]:
        """Every marker at every place where it ever hangs, and where it is mapped."""
        return [*self.mapped,
                *(change.marker for change in self.changes if change.marker is not None),
                *(decoy.marker for decoy in self.decoys)]


def read_hung_markers(root: Mapping, marker_map: MarkerMap) -> HungMarkers:
    """Read `displaced_markers`, `missing_markers` and `decoys` of a world file, all optional."""
    def items(key: str) -> List[Value]:
        return list(root[key].items()) if key in root else []

    # Absences come last: a missing marker hangs nowhere, even if it is displaced as well.
    changes = [_displacement(item, marker_map) for item in items("displaced_markers")]
    changes += [_absence(item, marker_map) for item in items("missing_markers")]
    decoys = [_decoy(item, marker_map) for item in items("decoys")]
    return HungMarkers(marker_map.markers, tuple(changes), tuple(decoys))


def _displacement(value: Value, marker_map: MarkerMap) -> Change:
    entry = value.mapping(("marker", *_POSE_KEYS, "during"))
    index = _index(entry["marker"], marker_map)
    if not any(key in entry for key in _POSE_KEYS):
        raise entry.error("one of the keys " + ", ".join(_POSE_KEYS), "none")
    marker = marker_map.markers[index]
    map_from_marker = marker.map_from_marker.copy()
    map_from_marker[:3, :3] = _displaced_rotation(entry, map_from_marker[:3, :3])
    if "position" in entry:
        map_from_marker[:3, 3] = entry["position"].reals(3)
    return Change(index, replace(marker, map_from_marker=map_from_marker), read_during(entry))


def _displaced_rotation(entry: Mapping, mapped: np.ndarray) -> np.ndarray:
    if "orientation" in entry or ("yaw" in entry and "roll" in entry):
        return read_rotation(entry)
    if "yaw" not in entry and "roll" not in entry:
        return mapped
    if abs(mapped[2, 2]) > UPRIGHT_TOLERANCE:
        raise entry.error("yaw and roll, or orientation, since the map has the marker on a "
                          "surface that is not vertical", "one of the angles")
    yaw, roll = yaw_and_roll_from_rotation(mapped)
    return rotation_from_yaw_and_roll(entry["yaw"].real() if "yaw" in entry else yaw,
                                      entry["roll"].real() if "roll" in entry else roll)


def _absence(value: Value, marker_map: MarkerMap) -> Change:
    if not value.is_mapping():
        return Change(_index(value, marker_map), None, ALWAYS)
    entry = value.mapping(("marker", "during"))
    return Change(_index(entry["marker"], marker_map), None, read_during(entry))


def _decoy(value: Value, marker_map: MarkerMap) -> Decoy:
    entry = value.mapping((*MARKER_KEYS, "during"))
    return Decoy(read_marker(entry, marker_map.defaults), read_during(entry))


def _index(value: Value, marker_map: MarkerMap) -> int:
    """The index of the map entry with this name or index."""
    markers = marker_map.markers
    if value.is_integer():
        index = value.integer()
        if not 0 <= index < len(markers):
            raise value.error(f"the index of a marker of the map, 0 to {len(markers) - 1}")
        return index
    names = [marker.name for marker in markers]
    name = value.text()
    if name not in names:
        raise value.error("the name or the index of a marker of the map")
    return names.index(name)
