"""Patterns from pictures."""

import os

import cv2
import numpy as np

from omnitag.command_line import InputError
from omnitag.pattern_file import Pattern

NEARLY_SQUARE = 0.01
"""By which share of its edge a picture may be wider than high, or higher than wide."""


def pattern_from_picture(path: str, side: int) -> Pattern:
    """The picture (PNG, JPEG, ...), averaged over the areas of side x side cells.

    What is transparent counts as white. Raises InputError if it cannot be read, is not square, or has
    fewer pixels than cells along its edge.
    """
    picture = _read(path)
    height, width = picture.shape[:2]
    if abs(width - height) > NEARLY_SQUARE * max(width, height):
        raise InputError("{}: expected a square picture, cut to what is within the marker's black "
                         "border; found {} x {} pixels".format(path, width, height))
    if min(width, height) < side:
        raise InputError("{}: expected at least {} x {} pixels, one for each cell; found {} x {}".format(
            path, side, side, width, height))
    cells = cv2.resize(picture, (side, side), interpolation=cv2.INTER_AREA)
    return Pattern(np.rint(np.moveaxis(cells, 2, 0)).astype(float))


def _read(path: str) -> np.ndarray:
    """(height, width, 3) from 0 to 255: blue, green, red."""
    if not os.path.isfile(path):
        raise InputError("{}: cannot be read: no such file".format(path))
    unchanged = cv2.imread(path, cv2.IMREAD_UNCHANGED)
    # Without an alpha channel, OpenCV can turn a photograph upright as its file says.
    with_alpha = unchanged is not None and unchanged.ndim == 3 and unchanged.shape[2] == 4
    picture = unchanged if with_alpha else cv2.imread(path, cv2.IMREAD_COLOR)
    if picture is None:
        raise InputError("{}: expected a picture, such as PNG or JPEG, found none that OpenCV "
                         "reads".format(path))
    if picture.dtype not in (np.uint8, np.uint16):
        raise InputError("{}: expected 8 or 16 bits per colour, found {}".format(path, picture.dtype))
    levels = picture.astype(np.float32) * (255.0 / np.iinfo(picture.dtype).max)
    if with_alpha:
        opacity = levels[:, :, 3:] / 255.0
        levels = levels[:, :, :3] * opacity + 255.0 * (1.0 - opacity)
    return levels
