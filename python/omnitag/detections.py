"""The table of detections that localize_bag writes: one line for each marker and frame."""

import csv
import math
from dataclasses import dataclass
from typing import Dict, List, Optional

import numpy as np

from omnitag.command_line import InputError
from omnitag.marker_map import MarkerMap
from omnitag.trajectory import parse_stamp

CORNER_COLUMNS = ("u0", "v0", "u1", "v1", "u2", "v2", "u3", "v3")
COLUMNS = ("stamp", "id", "family", "name", "map_entry", "accepted", "reason", "bearing", "range",
           "residual") + CORNER_COLUMNS


@dataclass(frozen=True)
class Detection:
    """A marker that was looked for in one frame; NaN stands for an empty field of the table."""

    stamp: int  # ns
    id: int
    family: str
    name: str
    map_entry: int  # its index in the marker map, from 0
    accepted: bool
    reason: str  # why rejected
    bearing: float  # rad about base_link's z, counter-clockwise from its x
    range: float  # m, horizontal distance from the camera to the marker
    residual: float  # px, root mean square over its corners
    corners: np.ndarray  # (4, 2) px in the panoramic image, in the AprilTag library's order


def read_detections(path: str, marker_map: MarkerMap) -> List[Detection]:
    """Read a table of detections that was made with this map; raises InputError naming file and line."""
    try:
        with open(path, encoding="utf-8", newline="") as file:
            rows = csv.reader(file, strict=True)
            header: List[str] = next(rows, [])
            missing = [column for column in COLUMNS if column not in header]
            if missing:
                raise InputError("{}:1: expected a header line with {}, found no column {}".format(
                    path, ",".join(COLUMNS), missing[0]))
            detections = []
            for fields in rows:
                place = "{}:{}".format(path, rows.line_num)
                if len(fields) != len(header):
                    raise InputError("{}: expected {} fields, found {}".format(
                        place, len(header), len(fields)))
                row = _Row(place, dict(zip(header, fields)))
                detection = _detection(row)
                _check_entry(detection, marker_map, row)
                detections.append(detection)
            return detections
    except csv.Error as error:
        raise InputError("{}:{}: expected comma-separated values, found: {}".format(
            path, rows.line_num, error))
    except UnicodeDecodeError:
        raise InputError("{}: expected text, found bytes that are not UTF-8".format(path))
    except OSError as error:
        raise InputError("{}: cannot be read: {}".format(path, error.strerror))


def format_detection(detection: Detection) -> List[str]:
    """The fields of one line in the order of COLUMNS, without the stamp, which comes first."""
    numbers = (detection.bearing, detection.range, detection.residual, *detection.corners.ravel())
    return [str(detection.id), detection.family, detection.name, str(detection.map_entry),
            str(int(detection.accepted)), detection.reason,
            *("{:.9g}".format(number) if math.isfinite(number) else "" for number in numbers)]


class _Row:
    """The fields of one line, read with checks."""

    def __init__(self, place: str, fields: Dict[str, str]) -> None:
        self._place = place
        self._fields = fields

    def text(self, column: str) -> str:
        return self._fields[column]

    def stamp(self) -> int:
        try:
            return parse_stamp(self._fields["stamp"])
        except ValueError:
            raise self.error("stamp", "seconds")

    def integer(self, column: str) -> int:
        try:
            return int(self._fields[column])
        except ValueError:
            raise self.error(column, "an integer")

    def real(self, column: str) -> float:
        """The number of a column; NaN if the field is empty."""
        if not self._fields[column]:
            return math.nan
        try:
            number = float(self._fields[column])
        except ValueError:
            number = math.nan
        if not math.isfinite(number):
            raise self.error(column, "a finite number or nothing")
        return number

    def error(self, column: str, expected: str, found: Optional[str] = None) -> InputError:
        return InputError("{}: {}: expected {}, found {}".format(
            self._place, column, expected, found or repr(self._fields[column])))


def _detection(row: _Row) -> Detection:
    accepted = row.text("accepted")
    if accepted not in ("0", "1"):
        raise row.error("accepted", "0 or 1")
    corners = np.array([row.real(column) for column in CORNER_COLUMNS]).reshape(4, 2)
    detection = Detection(row.stamp(), row.integer("id"), row.text("family"), row.text("name"),
                          row.integer("map_entry"), accepted == "1", row.text("reason"),
                          row.real("bearing"), row.real("range"), row.real("residual"), corners)
    if detection.range < 0.0 or (detection.accepted and math.isnan(detection.range)):
        raise row.error("range", "a distance in metres")
    return detection


def _check_entry(detection: Detection, marker_map: MarkerMap, row: _Row) -> None:
    """Refuse detections that were made with another map: the picture would be wrong."""
    if not detection.accepted:
        return
    markers = marker_map.markers
    if not 0 <= detection.map_entry < len(markers):
        raise row.error("map_entry", "0 to {}, an entry of the map".format(len(markers) - 1))
    marker = markers[detection.map_entry]
    if (marker.id, marker.family) != (detection.id, detection.family):
        raise row.error("id", "{} {}, as entry {} of the map says".format(
            marker.family, marker.id, detection.map_entry),
            "{} {}".format(detection.family, detection.id))
