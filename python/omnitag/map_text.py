"""The text of a marker map file."""

import os
from typing import Callable, List, Optional, Tuple

import numpy as np

from omnitag.marker_map import Marker, MarkerMap, yaw_and_roll_from_rotation
from omnitag.rotation import quaternion_from_rotation

VERTICAL = 1e-9
"""How far the normal of a marker on a vertical surface may lean, in rad."""


def map_text(marker_map: MarkerMap, path: str, remark: str = "") -> str:
    """The text of the map file `path`, which the paths of patterns are relative to.

    Values that all markers share are at its top, below the remark, if any.
    """
    lines = ["# " + line for line in remark.splitlines()]
    lines.append("frame_id: " + _quoted(marker_map.frame_id))
    markers = marker_map.markers
    with_patterns = tuple(marker for marker in markers if marker.pattern)
    shared = [_Shared("family", markers, lambda marker: marker.family),
              _Shared("size", markers, lambda marker: "{:.9g}".format(marker.size)),
              _Shared("border", with_patterns, _border),
              _Shared("deviation", markers, lambda marker: _said(marker.deviation)),
              _Shared("orientation_deviation", markers,
                      lambda marker: _said(marker.orientation_deviation))]
    lines += [line for each in shared for line in each.top()]
    lines.append("markers:")
    for marker in markers:
        words = [_what(marker, path)]
        if marker.name:
            words.append("name: " + _quoted(marker.name))
        words += [word for each in shared for word in each.of(marker)]
        words += ["position: " + _numbers(marker.position, 6), _orientation(marker)]
        lines.append("  - {" + ", ".join(words) + "}")
    return "\n".join(lines) + "\n"


class _Shared:
    """A key that is at the top if all markers have the same value, otherwise at each marker."""

    def __init__(self, key: str, markers: Tuple[Marker, ...],
                 text_of: Callable[[Marker], Optional[str]]) -> None:
        self._key = key
        self._text_of = text_of
        texts = {text_of(marker) for marker in markers}
        self._is_shared = len(texts) == 1
        self._text = texts.pop() if self._is_shared else None

    def top(self) -> List[str]:
        return [self._key + ": " + self._text] if self._text is not None else []

    def of(self, marker: Marker) -> List[str]:
        text = self._text_of(marker)
        return [] if self._is_shared or text is None else [self._key + ": " + text]


def _what(marker: Marker, map_path: str) -> str:
    if marker.pattern is None:
        return "id: {}".format(marker.id)
    # The system follows links before '..': so must the path.
    directory, name = os.path.split(marker.pattern.path)
    relative = os.path.relpath(os.path.realpath(directory),
                               os.path.realpath(os.path.dirname(map_path)))
    return "pattern: " + _quoted(os.path.normpath(os.path.join(relative, name)))


def _border(marker: Marker) -> Optional[str]:
    return "{:.9g}".format(marker.pattern.border) if marker.pattern else None


def _said(deviation: Optional[float]) -> Optional[str]:
    return None if deviation is None else "{:g}".format(deviation)


def _orientation(marker: Marker) -> str:
    rotation = marker.map_from_marker[:3, :3]
    if abs(rotation[2, 2]) > VERTICAL:
        return "orientation: " + _numbers(quaternion_from_rotation(rotation), 9)
    yaw, roll = yaw_and_roll_from_rotation(rotation)
    text = "yaw: {:.9f}".format(yaw + 0.0)
    return text if abs(roll) < 1e-9 else text + ", roll: {:.9f}".format(roll)


def _numbers(values: np.ndarray, decimals: int) -> str:
    return "[" + ", ".join("{:.{}f}".format(round(value, decimals) + 0.0, decimals)
                           for value in values) + "]"


def _quoted(text: str) -> str:
    return "'" + text.replace("'", "''") + "'"
