"""Poses of what stands on the floor."""

import numpy as np


def upright_transform(position: np.ndarray, yaw: float) -> np.ndarray:
    """(4, 4) transform of a body that stands at `position`, turned by `yaw` rad about z."""
    transform = np.eye(4)
    sine, cosine = np.sin(yaw), np.cos(yaw)
    transform[:2, :2] = [[cosine, -sine], [sine, cosine]]
    transform[:3, 3] = position
    return transform
