"""The route: where the robot is in each frame."""

import csv
from typing import Iterable, List, NamedTuple

import numpy as np

from omnitag.command_line import InputError
from omnitag.rendering.poses import upright_transform
from omnitag.trajectory import Trajectory, format_stamp, parse_stamp, planar_trajectory

POSE_FIELDS = ["stamp", "x", "y", "yaw"]
FIELDS = POSE_FIELDS + ["jump"]


class Frame(NamedTuple):
    """One moment of the route: the pose of base_link in map, in metres and radians."""

    stamp: int
    x: float
    y: float
    yaw: float
    jump: bool = False
    """Whether the robot was carried here from the frame before."""

    @property
    def map_from_base(self) -> np.ndarray:
        """(4, 4) transform."""
        return upright_transform(np.array([self.x, self.y, 0.0]), self.yaw)


def read_route(path: str, start: int) -> List[Frame]:
    """Reads a CSV file `stamp,x,y,yaw[,jump]`, one row per image, and adds `start` nanoseconds.

    Raises InputError naming file, line and field.
    """
    frames: List[Frame] = []
    with open(path, newline="", encoding="utf-8") as file:
        reader = csv.reader(file)
        try:
            rows = [(reader.line_num, row) for row in reader if row]
        except (UnicodeDecodeError, csv.Error) as error:
            raise InputError(f"{path}: expected CSV, found: {error}")
    fields = [field.strip() for field in rows[0][1]] if rows else []
    if fields not in (POSE_FIELDS, FIELDS):
        raise InputError(f"{path}:1: expected the header {','.join(POSE_FIELDS)} or "
                         f"{','.join(FIELDS)}, found '{','.join(rows[0][1]) if rows else ''}'")
    for line, row in rows[1:]:
        frame = _parse_frame(row, fields, start, f"{path}:{line}")
        if frames and frame.stamp <= frames[-1].stamp:
            raise InputError(f"{path}:{line}: stamp: expected one after "
                             f"{format_stamp(frames[-1].stamp - start)}, found {row[0]}")
        frames.append(frame)
    if not frames:
        raise InputError(f"{path}: expected poses, found none")
    return frames


def write_route(path: str, frames: Iterable[Frame]) -> None:
    """Writes a route, to a tenth of a millimetre and 1e-5 rad."""
    with open(path, "w", encoding="utf-8") as file:
        file.write(",".join(FIELDS) + "\n")
        for frame in frames:
            file.write(f"{format_stamp(frame.stamp)},{frame.x:.4f},{frame.y:.4f},"
                       f"{frame.yaw:.5f},{frame.jump:d}\n")


def trajectory_of(frames: List[Frame]) -> Trajectory:
    """The ground truth of the frames."""
    stamps, x, y, yaw, _ = zip(*frames)
    return planar_trajectory(np.array(stamps), np.array(x), np.array(y), np.array(yaw))


def _parse_frame(row: List[str], fields: List[str], start: int, place: str) -> Frame:
    if len(row) != len(fields):
        raise InputError(f"{place}: expected {len(fields)} fields "
                         f"({','.join(fields)}), found {len(row)}")
    try:
        stamp = parse_stamp(row[0])
    except ValueError:
        raise InputError(f"{place}: stamp: expected seconds, found '{row[0]}'")
    pose = []
    for name, text in zip(POSE_FIELDS[1:], row[1:]):
        try:
            number = float(text)
        except ValueError:
            number = np.nan
        if not np.isfinite(number):
            raise InputError(f"{place}: {name}: expected a finite number, found '{text}'")
        pose.append(number)
    jump = row[-1].strip() if fields == FIELDS else "0"
    if jump not in ("0", "1"):
        raise InputError(f"{place}: jump: expected 0 or 1, found '{row[-1]}'")
    return Frame(start + stamp, *pose, jump == "1")
