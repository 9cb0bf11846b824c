"""From a route to light: what the robot's camera sees in each frame."""

import hashlib
import os
from collections import Counter
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from typing import Callable, Dict, Iterator, NamedTuple, Optional, Sequence, Tuple

import cv2
import numpy as np

from omnitag.rendering.camera import Camera, canvas_of, finer
from omnitag.rendering.optics import camera_scene
from omnitag.rendering.path import SmoothPath
from omnitag.rendering.povray import DEFAULT_SAMPLES, render
from omnitag.rendering.route import Frame
from omnitag.rendering.scene import board_bitmaps, marker_bitmaps, shapes_scene, world_scene
from omnitag.rendering.turning import FINENESS
from omnitag.rendering.world import World, present


class SubFrame(NamedTuple):
    """The scene at one moment of an exposure."""

    scene: str
    """POV-Ray text."""
    weights: Tuple[float, ...]
    """Its share of each row of the image."""


def render_frames(world: World, camera: Camera, frames: Sequence[Frame],
                  jobs: int, light: Optional[str] = None,
                  samples: int = DEFAULT_SAMPLES,
                  path: Optional[SmoothPath] = None) -> Iterator[np.ndarray]:
    """The light of each frame, (height, width) with 1 for white, in the order of the frames.

    If the world's camera turns, the light is FINENESS times as large. The robot moves along `path`, by
    default through only these frames. Frames that see the same are rendered once; those whose light is
    in the directory `light` are not rendered again. Pixels on an edge are the mean of `samples` by
    `samples` rays.
    """
    if world.effects.turn:
        camera = finer(camera, FINENESS)
    bitmaps = {**marker_bitmaps(world.hung_markers.ever(), world.boards),
               **board_bitmaps(world.hung_boards, world.boards)}
    path = path or SmoothPath(frames)

    def frame_light(parts: Tuple[SubFrame, ...]) -> np.ndarray:
        def render_parts() -> np.ndarray:
            return exposed_light(camera, parts, bitmaps, samples, renderers)
        if light is None:
            return render_parts()
        return kept_light(os.path.join(light, _light_name(camera, parts, bitmaps, samples)),
                          render_parts)

    exposures = [sub_frames(world, camera, frame, path) for frame in frames]
    uses = Counter(exposures)
    # Two pools: a frame waits for the renderers of its moments.
    executor, renderers = ThreadPoolExecutor(jobs), ThreadPoolExecutor(jobs)
    images = {exposure: executor.submit(frame_light, exposure) for exposure in uses}
    try:
        for exposure in exposures:
            yield images[exposure].result()
            uses[exposure] -= 1
            if not uses[exposure]:
                del images[exposure]
    finally:
        for image in images.values():
            image.cancel()
        executor.shutdown()
        renderers.shutdown()


def sub_frames(world: World, camera: Camera, frame: Frame,
               path: SmoothPath) -> Tuple[SubFrame, ...]:
    """The moments of a frame's exposure; moments that see the same are merged."""
    shutter = world.shutter
    fineness = FINENESS if world.effects.turn else 1
    height = camera.height // fineness
    moments = shutter.moments(height)
    weights = np.repeat(shutter.weights(height), fineness, axis=0)
    # What is in the room only for a while is present or absent for the whole image.
    base_from_camera = world.mounting.base_from_camera
    moment = frame.stamp - world.start
    surroundings = world_scene(world, moment)
    robot = present(world.robot, moment)
    seen: Dict[str, np.ndarray] = {}
    for seconds, weight in zip(moments, weights.T):
        nanoseconds = round(1e9 * seconds)
        map_from_base = frame.map_from_base
        if nanoseconds != 0:
            map_from_base = path.pose(frame, frame.stamp + nanoseconds).map_from_base
        scene = "".join([surroundings, shapes_scene(robot, map_from_base, world.ambient),
                         camera_scene(camera, map_from_base @ base_from_camera)])
        seen[scene] = seen.get(scene, 0.0) + weight
    return tuple(SubFrame(scene, tuple(weight)) for scene, weight in seen.items())


def exposed_light(camera: Camera, parts: Sequence[SubFrame], bitmaps: Dict[str, np.ndarray],
                  samples: int, renderers: Executor) -> np.ndarray:
    """The light of all moments of an exposure, each rendered only in the rows that it contributes to."""
    canvas = canvas_of(camera)
    part = (slice(canvas.top, canvas.top + camera.height),
            slice(canvas.left, canvas.left + camera.width))

    def start(scene: str, rows: Optional[range] = None) -> "Future[np.ndarray]":
        return renderers.submit(render, scene, bitmaps, canvas.width, canvas.height, samples, rows)

    if len(parts) == 1:
        return start(parts[0].scene).result()[part]
    images = []
    for scene, weights in parts:
        exposed = np.flatnonzero(weights)
        images.append(start(scene, range(canvas.top + int(exposed[0]),
                                         canvas.top + int(exposed[-1]) + 1)))
    return sum(np.array(weights)[:, None] * image.result()[part]
               for (_, weights), image in zip(parts, images))


def kept_light(path: str, render_light: Callable[[], np.ndarray]) -> np.ndarray:
    """The light of a frame from the 16-bit image at `path`, which is rendered first if it is missing."""
    most = np.iinfo(np.uint16).max
    if not os.path.exists(path):
        # If rendering is interrupted, there is no file instead of an incomplete one.
        unfinished = path + ".unfinished.png"
        cv2.imwrite(unfinished, np.rint(most * render_light()).astype(np.uint16))
        os.replace(unfinished, path)
    return cv2.imread(path, cv2.IMREAD_UNCHANGED).astype(float) / most


def _light_name(camera: Camera, parts: Sequence[SubFrame], bitmaps: Dict[str, np.ndarray],
                samples: int) -> str:
    """A file name that is a hash of everything that the light depends on."""
    digest = hashlib.sha256(repr((canvas_of(camera), camera.width, camera.height, samples,
                                  tuple(parts))).encode())
    for name in sorted(bitmaps):
        digest.update(name.encode() + bitmaps[name].tobytes())
    return digest.hexdigest()[:20] + ".png"
