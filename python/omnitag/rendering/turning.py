"""A camera that turns about its own axis while it exposes."""

import cv2
import numpy as np

from omnitag.rendering.camera import Camera, finer, rim_distance

# The light that is turned has this many pixels along each edge of an image's pixel: between pixels
# as wide as an edge is sharp, nothing can be interpolated well.
FINENESS = 2

_LARGEST_STEP = 0.25  # px, of what is on the rim


def turned(light: np.ndarray, camera: Camera, turn: float) -> np.ndarray:
    """The mean over all turns from -turn/2 to turn/2 rad of the camera about its axis.

    `light` is FINENESS times as large as the camera's image, which is returned.
    Every model that is rendered is symmetric about the axis: its image turns about the principal
    point, in units of the focal lengths.
    """
    lens = camera.lens
    way = abs(turn) * rim_distance(camera) * max(lens.fx, lens.fy)
    count = int(np.ceil(way / _LARGEST_STEP))
    total = np.zeros_like(light)
    for angle in turn * ((np.arange(count) + 0.5) / count - 0.5):
        total += _turned_once(light, finer(camera, FINENESS), angle)
    return cv2.resize(total / count, (camera.width, camera.height), interpolation=cv2.INTER_AREA)


def _turned_once(light: np.ndarray, camera: Camera, angle: float) -> np.ndarray:
    """A camera that is turned by `angle` sees at a pixel what it saw at the pixel turned so."""
    lens = camera.lens
    sine, cosine = np.sin(angle), np.cos(angle)
    to_plane = np.array([[1.0 / lens.fx, 0.0, -lens.cx / lens.fx],
                         [0.0, 1.0 / lens.fy, -lens.cy / lens.fy], [0.0, 0.0, 1.0]])
    turn = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    source = np.linalg.inv(to_plane) @ turn @ to_plane
    return cv2.warpAffine(light, source[:2], (light.shape[1], light.shape[0]),
                          flags=cv2.INTER_LANCZOS4 | cv2.WARP_INVERSE_MAP,
                          borderMode=cv2.BORDER_REPLICATE)
