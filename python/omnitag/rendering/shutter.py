"""When each row of an image is exposed, and the light that it collects during that time."""

from typing import NamedTuple

import numpy as np

from omnitag.rendering.checks import not_negative, positive
from omnitag.yaml_file import Mapping

KEYS = ("exposure_time", "row_readout_time", "image_time_offset", "sub_frame_interval")


class Shutter(NamedTuple):
    """The middle of row v's exposure is at stamp + image_time_offset + v row_readout_time; seconds."""

    exposure_time: float = 0.0
    row_readout_time: float = 0.0
    """From one row to the next; negative if the last row is read first."""
    image_time_offset: float = 0.0
    sub_frame_interval: float = 0.001
    """Largest interval between rendered moments."""

    def first_exposed(self, height: int) -> float:
        """Time from the stamp to the first light on an image of `height` rows."""
        return self._middles(height).min() - 0.5 * self.exposure_time

    def last_exposed(self, height: int) -> float:
        """Time from the stamp to the last light on it."""
        return self._middles(height).max() + 0.5 * self.exposure_time

    def moments(self, height: int) -> np.ndarray:
        """Times from the stamp to the sub-frames, evenly spaced over the exposure of all rows."""
        first, last = self.first_exposed(height), self.last_exposed(height)
        count = int(np.ceil((last - first) / self.sub_frame_interval - 1e-9))
        return np.linspace(first, last, count + 1)

    def weights(self, height: int) -> np.ndarray:
        """(height, moments): the weight of each sub-frame in each row.

        Light changes linearly between two moments; a row is the mean over its exposure.
        """
        moments, middles = self.moments(height), self._middles(height)
        if len(moments) == 1:
            return np.ones((height, 1))
        step = moments[1] - moments[0]
        if self.exposure_time == 0.0:
            distances = np.abs(middles[:, None] - moments) / step
            weights = np.maximum(0.0, 1.0 - distances)
        else:
            begins, ends = (middles[:, None] + sign * 0.5 * self.exposure_time - moments
                            for sign in (-1.0, 1.0))
            weights = _hat_integral(ends / step) - _hat_integral(begins / step)
        weights[weights < 1e-9] = 0.0
        return weights / weights.sum(axis=1, keepdims=True)

    def _middles(self, height: int) -> np.ndarray:
        return self.image_time_offset + self.row_readout_time * np.arange(height)


def read_shutter(entry: Mapping) -> Shutter:
    """Read the shutter from a world's `images`; missing keys have their defaults."""
    given = {key: entry[key].real() for key in KEYS[1:3] if key in entry}
    if "exposure_time" in entry:
        given["exposure_time"] = not_negative(entry["exposure_time"])
    if "sub_frame_interval" in entry:
        given["sub_frame_interval"] = positive(entry["sub_frame_interval"])
    return Shutter(**given)


def _hat_integral(position: np.ndarray) -> np.ndarray:
    """Integral up to `position` of the hat that rises from -1 to its peak at 0 and falls to 1."""
    inside = np.clip(position, -1.0, 1.0)
    return np.where(inside < 0.0, 0.5 * np.square(1.0 + inside),
                    1.0 - 0.5 * np.square(1.0 - inside))
