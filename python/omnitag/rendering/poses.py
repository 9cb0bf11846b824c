"""Poses of upright and of leaning bodies."""

from typing import NamedTuple, Union

import numpy as np

Angles = Union[float, np.ndarray]


def upright_transform(position: np.ndarray, yaw: float) -> np.ndarray:
    """(4, 4) transform of a body that stands at `position`, turned by `yaw` rad about z."""
    transform = np.eye(4)
    sine, cosine = np.sin(yaw), np.cos(yaw)
    transform[:2, :2] = [[cosine, -sine], [sine, cosine]]
    transform[:3, 3] = position
    return transform


def leaning_transform(position: np.ndarray, yaw: float, roll: float, pitch: float) -> np.ndarray:
    """(4, 4) transform of a body at `position`, turned by Rz(yaw) Ry(pitch) Rx(roll), in rad."""
    transform = upright_transform(position, yaw)
    if roll != 0.0 or pitch != 0.0:
        about_y, about_x = np.eye(3), np.eye(3)
        sine, cosine = np.sin(pitch), np.cos(pitch)
        about_y[::2, ::2] = [[cosine, sine], [-sine, cosine]]
        sine, cosine = np.sin(roll), np.cos(roll)
        about_x[1:, 1:] = [[cosine, -sine], [sine, cosine]]
        transform[:3, :3] = transform[:3, :3] @ about_y @ about_x
    return transform


def leaning_quaternion(yaw: Angles, roll: Angles, pitch: Angles) -> np.ndarray:
    """(..., 4) unit quaternions x, y, z, w of Rz(yaw) Ry(pitch) Rx(roll), in rad."""
    sy, sr, sp = (np.sin(0.5 * np.asarray(angle, dtype=float)) for angle in (yaw, roll, pitch))
    cy, cr, cp = (np.cos(0.5 * np.asarray(angle, dtype=float)) for angle in (yaw, roll, pitch))
    return np.stack([sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy,
                     cr * cp * sy - sr * sp * cy, cr * cp * cy + sr * sp * sy], axis=-1)


class Pose(NamedTuple):
    """base_link in the map; metres and radians."""

    x: float
    y: float
    yaw: float
    z: float = 0.0
    roll: float = 0.0
    pitch: float = 0.0

    @property
    def map_from_base(self) -> np.ndarray:
        """(4, 4) transform."""
        return leaning_transform(np.array([self.x, self.y, self.z]), self.yaw, self.roll,
                                 self.pitch)
