"""From a route to light: what the robot's camera sees in each frame."""

import hashlib
import os
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Callable, Dict, Iterator, List, NamedTuple, Optional, Sequence, Tuple

import cv2
import numpy as np

from omnitag.rendering.camera import Camera, canvas_of
from omnitag.rendering.optics import camera_scene
from omnitag.rendering.path import SmoothPath
from omnitag.rendering.povray import DEFAULT_SAMPLES, render
from omnitag.rendering.route import Frame
from omnitag.rendering.scene import marker_bitmaps, shapes_scene, world_scene
from omnitag.rendering.world import World, present


class SubFrame(NamedTuple):
    """What is seen at one moment of an exposure."""

    scene: str
    """POV-Ray text."""
    weights: Tuple[float, ...]
    """What it gives to each row of the image."""


def render_frames(world: World, camera: Camera, frames: Sequence[Frame],
                  jobs: int, light: Optional[str] = None,
                  samples: int = DEFAULT_SAMPLES,
                  path: Optional[SmoothPath] = None) -> Iterator[np.ndarray]:
    """The light of each frame, (height, width) with 1 where white, in the order of the frames.

    The robot moves along `path`, by default through these frames alone. Frames that see the same
    are rendered once; those whose light is in the directory `light` are not rendered again. Pixels
    on an edge are the mean of `samples` by `samples` rays.
    """
    bitmaps = marker_bitmaps(world.hung_markers.ever(), world.boards)
    path = path or SmoothPath(frames)

    def frame_light(parts: Tuple[SubFrame, ...]) -> np.ndarray:
        def render_parts() -> np.ndarray:
            return exposed_light(camera, parts, bitmaps, samples)
        if light is None:
            return render_parts()
        return kept_light(os.path.join(light, _light_name(camera, parts, bitmaps, samples)),
                          render_parts)

    executor = ThreadPoolExecutor(jobs)
    rendered: Dict[Tuple[SubFrame, ...], Future] = {}
    images: List[Future] = []
    try:
        for frame in frames:
            parts = sub_frames(world, camera, frame, path)
            if parts not in rendered:
                rendered[parts] = executor.submit(frame_light, parts)
            images.append(rendered[parts])
        for image in images:
            yield image.result()
    finally:
        for image in images:
            image.cancel()
        executor.shutdown()


def sub_frames(world: World, camera: Camera, frame: Frame,
               path: SmoothPath) -> Tuple[SubFrame, ...]:
    """The moments of a frame's exposure; those that see the same are one."""
    shutter = world.shutter
    moments = shutter.moments(camera.height)
    weights = shutter.weights(camera.height)
    # What stands in the room for a while is there or not for a whole image.
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
                  samples: int) -> np.ndarray:
    """The light of all moments of an exposure, each rendered only where it is in the image."""
    canvas = canvas_of(camera)
    part = (slice(canvas.top, canvas.top + camera.height),
            slice(canvas.left, canvas.left + camera.width))
    if len(parts) == 1:
        return render(parts[0].scene, bitmaps, canvas.width, canvas.height, samples)[part]
    light = np.zeros((camera.height, camera.width))
    for scene, weights in parts:
        exposed = np.flatnonzero(weights)
        rows = range(canvas.top + int(exposed[0]), canvas.top + int(exposed[-1]) + 1)
        image = render(scene, bitmaps, canvas.width, canvas.height, samples, rows)[part]
        light += np.array(weights)[:, None] * image
    return light


def kept_light(path: str, render_light: Callable[[], np.ndarray]) -> np.ndarray:
    """The light of a frame from the 16-bit image at `path`, rendered and kept there if need be."""
    most = np.iinfo(np.uint16).max
    if not os.path.exists(path):
        # Complete or not there, should rendering be interrupted.
        unfinished = path + ".unfinished.png"
        cv2.imwrite(unfinished, np.rint(most * render_light()).astype(np.uint16))
        os.replace(unfinished, path)
    return cv2.imread(path, cv2.IMREAD_UNCHANGED).astype(float) / most


def _light_name(camera: Camera, parts: Sequence[SubFrame], bitmaps: Dict[str, np.ndarray],
                samples: int) -> str:
    """A file's name that belongs to all that the light depends on."""
    digest = hashlib.sha256(repr((canvas_of(camera), camera.width, camera.height, samples,
                                  tuple(parts))).encode())
    for name in sorted(bitmaps):
        digest.update(name.encode() + bitmaps[name].tobytes())
    return digest.hexdigest()[:20] + ".png"
