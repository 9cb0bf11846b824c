"""Rotations, (3, 3), and their representations in files; angles in rad."""

from typing import Sequence, Tuple, Union

import numpy as np

Numbers = Union[Sequence[float], np.ndarray]
"""The components of a vector or of a quaternion."""


def rotation_from_vector(vector: Numbers) -> np.ndarray:
    """The rotation about `vector` by its length."""
    angle = np.linalg.norm(vector)
    if angle == 0.0:
        return np.eye(3)
    x, y, z = np.asarray(vector) / angle
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross


def vector_from_rotation(rotation: np.ndarray) -> np.ndarray:
    """The inverse; its length is at most pi."""
    quaternion = quaternion_from_rotation(rotation)
    sine = np.linalg.norm(quaternion[:3])
    if sine == 0.0:
        return np.zeros(3)
    return 2.0 * np.arctan2(sine, quaternion[3]) / sine * quaternion[:3]


def rotation_from_rpy(roll: float, pitch: float, yaw: float) -> np.ndarray:
    """About x by roll, then about the fixed y by pitch, then about the fixed z by yaw."""
    return (rotation_from_vector((0.0, 0.0, yaw)) @ rotation_from_vector((0.0, pitch, 0.0))
            @ rotation_from_vector((roll, 0.0, 0.0)))


def rpy_from_rotation(rotation: np.ndarray) -> Tuple[float, float, float]:
    """The inverse. If pitch is a right angle, only yaw - roll or yaw + roll is defined: yaw is 0."""
    cosine = np.hypot(rotation[0, 0], rotation[1, 0])
    pitch = float(np.arctan2(-rotation[2, 0], cosine))
    if cosine < 1e-9:
        return float(np.arctan2(-rotation[1, 2], rotation[1, 1])), pitch, 0.0
    return (float(np.arctan2(rotation[2, 1], rotation[2, 2])), pitch,
            float(np.arctan2(rotation[1, 0], rotation[0, 0])))


def rotation_from_quaternion(quaternion: Numbers) -> np.ndarray:
    """The rotation of a unit quaternion x, y, z, w."""
    x, y, z, w = quaternion
    return np.array([
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
        [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
        [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)]])


def quaternion_from_rotation(rotation: np.ndarray) -> np.ndarray:
    """The unit quaternion x, y, z, w of a rotation, as an eigenvector."""
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = rotation
    matrix = np.array([[xx - yy - zz, xy + yx, xz + zx, zy - yz],
                       [xy + yx, yy - xx - zz, yz + zy, xz - zx],
                       [xz + zx, yz + zy, zz - xx - yy, yx - xy],
                       [zy - yz, xz - zx, yx - xy, xx + yy + zz]]) / 3.0
    quaternion = np.linalg.eigh(matrix)[1][:, -1]
    return quaternion if quaternion[3] >= 0.0 else -quaternion
