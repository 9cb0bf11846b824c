"""A sensor whose pixels see one colour each, and its conversion to a grey image."""

from typing import Callable

import cv2
import numpy as np

# OpenCV names a pattern after the second and third pixel of the second row.
_CODES = {"rggb": cv2.COLOR_BayerBG2BGR, "grbg": cv2.COLOR_BayerGB2BGR,
          "gbrg": cv2.COLOR_BayerGR2BGR, "bggr": cv2.COLOR_BayerRG2BGR}
PATTERNS = tuple(_CODES)

# Share of white light that each filter transmits.
TRANSMISSION = {"r": 0.8, "g": 1.0, "b": 0.65}


def develop(light: np.ndarray, pattern: str, gamma: float,
            read: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """8-bit grey image: filter, `read` as grey levels, white balance, demosaic, convert to grey."""
    filters = transmissions(light.shape, pattern)
    levels = read(np.clip(light, 0.0, 1.0) * filters)
    balanced = np.rint(levels / filters ** (1.0 / gamma))
    mosaic = np.clip(balanced, 0, 255).astype(np.uint8)
    return cv2.cvtColor(cv2.cvtColor(mosaic, _CODES[pattern]), cv2.COLOR_BGR2GRAY)


def transmissions(shape: tuple, pattern: str) -> np.ndarray:
    """The share of the light that each pixel's filter transmits."""
    filters = np.empty(shape)
    for index, colour in enumerate(pattern):
        filters[index // 2::2, index % 2::2] = TRANSMISSION[colour]
    return filters
