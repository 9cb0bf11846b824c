"""When each row of an image is exposed, and the light that it collects meanwhile."""

from typing import NamedTuple

import numpy as np

from omnitag.rendering.checks import not_negative, positive
from omnitag.yaml_file import Mapping

KEYS = ("exposure_time", "row_readout_time", "image_time_offset", "sub_frame_interval")


class Shutter(NamedTuple):
    """Row v's exposure has its middle at stamp + image_time_offset + v row_readout_time; seconds."""

    exposure_time: float = 0.0
    row_readout_time: float = 0.0
    """From a row to the next; negative where the last row is read first."""
    image_time_offset: float = 0.0
    sub_frame_interval: float = 0.001
    """At most, between the moments that are rendered."""

    def first_exposed(self, height: int) -> float:
        """When the first light falls on an image of `height` rows, after its stamp."""
        return self._middles(height).min() - 0.5 * self.exposure_time

    def last_exposed(self, height: int) -> float:
        """When the last light falls on it, after its stamp."""
        return self._middles(height).max() + 0.5 * self.exposure_time

    def moments(self, height: int) -> np.ndarray:
        """The sub-frames' moments after the stamp, evenly spaced over all exposures."""
        first, last = self.first_exposed(height), self.last_exposed(height)
        count = int(np.ceil((last - first) / self.sub_frame_interval - 1e-9))
        return np.linspace(first, last, count + 1)

    def weights(self, height: int) -> np.ndarray:
        """(height, moments): what each sub-frame gives to each row.

        Light changes linearly between two moments; a row gets its mean over the exposure.
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
    """The shutter's keys among those of a world's images; what is left out is at rest."""
    given = {key: entry[key].real() for key in KEYS[1:3] if key in entry}
    if "exposure_time" in entry:
        given["exposure_time"] = not_negative(entry["exposure_time"])
    if "sub_frame_interval" in entry:
        given["sub_frame_interval"] = positive(entry["sub_frame_interval"])
    return Shutter(**given)


def _hat_integral(position: np.ndarray) -> np.ndarray:
    """Of the hat that rises from -1 to its peak at 0 and falls to 1, up to `position`."""
    inside = np.clip(position, -1.0, 1.0)
    return np.where(inside < 0.0, 0.5 * np.square(1.0 + inside),
                    1.0 - 0.5 * np.square(1.0 - inside))
