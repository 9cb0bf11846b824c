"""Trajectories in the TUM format: `stamp x y z qx qy qz qw`, one pose a line."""

from dataclasses import dataclass
from decimal import Decimal, InvalidOperation
from typing import List, Tuple

import numpy as np

from omnitag.command_line import InputError

FIELDS = ("stamp", "x", "y", "z", "qx", "qy", "qz", "qw")
QUATERNION_TOLERANCE = 1e-3


@dataclass(frozen=True)
class Trajectory:
    """Poses of `base_link` in `map`, in order of time."""

    stamps: np.ndarray  # (n,) int64, nanoseconds, which a double cannot hold exactly
    positions: np.ndarray  # (n, 3) m
    orientations: np.ndarray  # (n, 4) unit quaternions x, y, z, w

    def __len__(self) -> int:
        return len(self.stamps)

    @property
    def yaw(self) -> np.ndarray:
        """Headings in rad, counter-clockwise about z, in [-pi, pi]."""
        x, y, z, w = self.orientations.T
        return np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))

    @property
    def roll(self) -> np.ndarray:
        """Roll of Rz(yaw) Ry(pitch) Rx(roll), in rad, in [-pi, pi]."""
        x, y, z, w = self.orientations.T
        return np.arctan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))

    @property
    def pitch(self) -> np.ndarray:
        """Pitch of Rz(yaw) Ry(pitch) Rx(roll), in rad, in [-pi/2, pi/2]; positive with x down."""
        x, y, z, w = self.orientations.T
        return np.arcsin(np.clip(2.0 * (w * y - z * x), -1.0, 1.0))

    @property
    def is_on_floor(self) -> bool:
        """Whether z, roll and pitch are 0 in all poses."""
        return not (self.positions[:, 2].any() or self.orientations[:, :2].any())


def planar_trajectory(stamps: np.ndarray, x: np.ndarray, y: np.ndarray,
                      yaw: np.ndarray) -> Trajectory:
    """A trajectory on the floor: stamps in nanoseconds, x and y in m, yaw in rad."""
    zero = np.zeros(len(stamps))
    half = 0.5 * np.asarray(yaw, dtype=float)
    return Trajectory(np.asarray(stamps, dtype=np.int64),
                      np.column_stack([x, y, zero]),
                      np.column_stack([zero, zero, np.sin(half), np.cos(half)]))


def parse_stamp(text: str) -> int:
    """Whole nanoseconds from seconds as text; raises ValueError."""
    try:
        seconds = Decimal(text)
    except InvalidOperation:
        raise ValueError("not a number") from None
    if not seconds.is_finite() or not 0 <= seconds < 2**33:
        raise ValueError("not a time")
    return int((seconds * 10**9).to_integral_value())


def format_stamp(nanoseconds: int) -> str:
    """Nanoseconds as seconds with nine decimals."""
    return "{}.{:09d}".format(*divmod(int(nanoseconds), 10**9))


def format_pose(stamp: int, position: np.ndarray, orientation: np.ndarray) -> str:
    """One line of a TUM file, without its newline."""
    values = " ".join("{:.9f}".format(value) for value in (*position, *orientation))
    return "{} {}".format(format_stamp(stamp), values)


def write_trajectory(path: str, trajectory: Trajectory) -> None:
    """Write a TUM file."""
    with open(path, "w", encoding="utf-8") as file:
        for pose in zip(trajectory.stamps, trajectory.positions, trajectory.orientations):
            file.write(format_pose(*pose) + "\n")


def read_trajectory(path: str) -> Trajectory:
    """Read a TUM file; lines that begin with # and empty lines are skipped.

    Raises InputError, naming file and line, unless every line has eight finite numbers, stamps
    increase and quaternions are of unit length.
    """
    stamps: List[int] = []
    poses: List[np.ndarray] = []
    try:
        with open(path, encoding="utf-8") as file:
            for number, line in enumerate(file, start=1):
                content = line.strip()
                if not content or content.startswith("#"):
                    continue
                place = "{}:{}".format(path, number)
                stamp, pose = _parse_pose(content.split(), place)
                if stamps and stamp <= stamps[-1]:
                    raise InputError("{}: stamp: expected one after {}, found {}".format(
                        place, format_stamp(stamps[-1]), format_stamp(stamp)))
                stamps.append(stamp)
                poses.append(pose)
    except UnicodeDecodeError:
        raise InputError("{}: expected text, found bytes that are not UTF-8".format(path))
    except OSError as error:
        raise InputError("{}: cannot be read: {}".format(path, error.strerror))
    if not stamps:
        raise InputError("{}: expected poses, found none".format(path))
    values = np.array(poses)
    return Trajectory(np.array(stamps, dtype=np.int64), values[:, :3], values[:, 3:])


def _parse_pose(fields: List[str], place: str) -> Tuple[int, np.ndarray]:
    if len(fields) != len(FIELDS):
        raise InputError("{}: expected {} fields ({}), found {}".format(
            place, len(FIELDS), " ".join(FIELDS), len(fields)))
    try:
        stamp = parse_stamp(fields[0])
    except ValueError:
        raise InputError("{}: stamp: expected seconds, found {!r}".format(place, fields[0]))
    pose = np.empty(len(FIELDS) - 1)
    for index, (name, text) in enumerate(zip(FIELDS[1:], fields[1:])):
        try:
            pose[index] = float(text)
        except ValueError:
            pose[index] = np.nan
        if not np.isfinite(pose[index]):
            raise InputError("{}: {}: expected a finite number, found {!r}".format(
                place, name, text))
    length = float(np.linalg.norm(pose[3:]))
    if abs(length - 1.0) > QUATERNION_TOLERANCE:
        raise InputError("{}: expected a quaternion of length 1, found length {:.6g}".format(
            place, length))
    pose[3:] /= length
    return stamp, pose
