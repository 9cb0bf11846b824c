"""A camera that turns about its axis during the exposure."""

import cv2
import numpy as np

from omnitag.rendering.camera import Camera, finer, rim_distance

# The light that is turned has this many pixels along each edge of an image's pixel: edges that are only
# one pixel wide cannot be interpolated well.
FINENESS = 2

_LARGEST_STEP = 0.25  # px, at the rim


def turned(light: np.ndarray, camera: Camera, turn: float) -> np.ndarray:
    """The mean light while the camera turns about its axis from -turn/2 to turn/2 rad.

    `light` is FINENESS times as large as the camera's image, which is returned. All models that can be
    rendered are symmetric about the axis: the image turns about the principal point, in units of the
    focal lengths.
    """
    lens = camera.lens
    way = abs(turn) * rim_distance(camera) * max(lens.fx, lens.fy)
    count = int(np.ceil(way / _LARGEST_STEP))
    total = np.zeros_like(light)
    for angle in turn * ((np.arange(count) + 0.5) / count - 0.5):
        total += _turned_once(light, finer(camera, FINENESS), angle)
    return cv2.resize(total / count, (camera.width, camera.height), interpolation=cv2.INTER_AREA)


def _turned_once(light: np.ndarray, camera: Camera, angle: float) -> np.ndarray:
    """The light of the camera turned by `angle`: at a pixel, the light at this pixel turned by `angle`."""
    lens = camera.lens
    sine, cosine = np.sin(angle), np.cos(angle)
    to_plane = np.array([[1.0 / lens.fx, 0.0, -lens.cx / lens.fx],
                         [0.0, 1.0 / lens.fy, -lens.cy / lens.fy], [0.0, 0.0, 1.0]])
    turn = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    source = np.linalg.inv(to_plane) @ turn @ to_plane
    return cv2.warpAffine(light, source[:2], (light.shape[1], light.shape[0]),
                          flags=cv2.INTER_LANCZOS4 | cv2.WARP_INVERSE_MAP,
                          borderMode=cv2.BORDER_REPLICATE)
