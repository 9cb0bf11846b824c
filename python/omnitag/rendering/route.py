"""The route: where the robot is in each frame."""

import csv
from typing import List, NamedTuple, Sequence

import numpy as np

from omnitag.command_line import InputError
from omnitag.rendering.poses import Pose, leaning_quaternion
from omnitag.trajectory import Trajectory, format_stamp, parse_stamp

PLANAR_FIELDS = ["stamp", "x", "y", "yaw"]
LEAN_FIELDS = ["z", "roll", "pitch"]
HEADERS = [PLANAR_FIELDS + lean * LEAN_FIELDS + jump * ["jump"]
           for lean in (False, True) for jump in (False, True)]


class Frame(NamedTuple):
    """One moment of the route: the pose of base_link in map, in metres and radians."""

    stamp: int
    x: float
    y: float
    yaw: float
    jump: bool = False
    """Whether the robot was carried here from the previous frame."""
    z: float = 0.0
    roll: float = 0.0
    pitch: float = 0.0

    @property
    def map_from_base(self) -> np.ndarray:
        """(4, 4) transform."""
        return Pose(self.x, self.y, self.yaw, self.z, self.roll, self.pitch).map_from_base


def read_route(path: str, start: int) -> List[Frame]:
    """Read a CSV file `stamp,x,y,yaw[,z,roll,pitch][,jump]`, one row per image.

    `start` is added to its stamps, in nanoseconds.

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
    if fields not in HEADERS:
        raise InputError(f"{path}:1: expected the header "
                         f"{' or '.join(','.join(header) for header in HEADERS)}, "
                         f"found '{','.join(rows[0][1]) if rows else ''}'")
    for line, row in rows[1:]:
        frame = _parse_frame(row, fields, start, f"{path}:{line}")
        if frames and frame.stamp <= frames[-1].stamp:
            raise InputError(f"{path}:{line}: stamp: expected one after "
                             f"{format_stamp(frames[-1].stamp - start)}, found {row[0]}")
        frames.append(frame)
    if not frames:
        raise InputError(f"{path}: expected poses, found none")
    return frames


def write_route(path: str, frames: Sequence[Frame]) -> None:
    """Write a route, to a tenth of a millimetre and 1e-5 rad; z, roll and pitch if there are any."""
    leans = any(frame.z or frame.roll or frame.pitch for frame in frames)
    with open(path, "w", encoding="utf-8") as file:
        file.write(",".join(PLANAR_FIELDS + leans * LEAN_FIELDS + ["jump"]) + "\n")
        for frame in frames:
            lean = f"{frame.z:.4f},{frame.roll:.5f},{frame.pitch:.5f}," if leans else ""
            file.write(f"{format_stamp(frame.stamp)},{frame.x:.4f},{frame.y:.4f},"
                       f"{frame.yaw:.5f},{lean}{frame.jump:d}\n")


def trajectory_of(frames: Sequence[Frame]) -> Trajectory:
    """The ground truth of the frames."""
    stamps, x, y, yaw, _, z, roll, pitch = zip(*frames)
    return Trajectory(np.array(stamps, dtype=np.int64), np.column_stack([x, y, z]).astype(float),
                      leaning_quaternion(np.array(yaw), np.array(roll), np.array(pitch)))


def _parse_frame(row: List[str], fields: List[str], start: int, place: str) -> Frame:
    if len(row) != len(fields):
        raise InputError(f"{place}: expected {len(fields)} fields "
                         f"({','.join(fields)}), found {len(row)}")
    try:
        stamp = parse_stamp(row[0])
    except ValueError:
        raise InputError(f"{place}: stamp: expected seconds, found '{row[0]}'")
    pose = {}
    for name, text in zip(fields[1:], row[1:]):
        if name != "jump":
            pose[name] = _finite(text, f"{place}: {name}")
    jump = row[-1].strip() if fields[-1] == "jump" else "0"
    if jump not in ("0", "1"):
        raise InputError(f"{place}: jump: expected 0 or 1, found '{row[-1]}'")
    return Frame(start + stamp, jump=jump == "1", **pose)


def _finite(text: str, place: str) -> float:
    try:
        number = float(text)
    except ValueError:
        number = np.nan
    if not np.isfinite(number):
        raise InputError(f"{place}: expected a finite number, found '{text}'")
    return number
