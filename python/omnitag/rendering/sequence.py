"""From a route to images: what the robot's camera sees in each frame."""

import os
from concurrent.futures import ThreadPoolExecutor
from typing import Callable, Iterator, List, Optional

import cv2
import numpy as np

from omnitag.rendering.camera import Camera, canvas_of
from omnitag.rendering.optics import camera_scene
from omnitag.rendering.povray import DEFAULT_SAMPLES, render
from omnitag.rendering.route import Frame
from omnitag.rendering.scene import marker_bitmaps, shapes_scene, world_scene
from omnitag.rendering.world import World, present


def render_frames(world: World, camera: Camera, frames: List[Frame],
                  jobs: int, light: Optional[str] = None,
                  samples: int = DEFAULT_SAMPLES) -> Iterator[np.ndarray]:
    """The light of each frame, (height, width) with 1 where white, in the order of the frames.

    Frames whose light is in the directory `light`, named by their stamps, are not rendered again.
    Pixels on an edge are the mean of `samples` by `samples` rays.
    """
    bitmaps = marker_bitmaps(world.hung_markers.ever(), world.boards)
    base_from_camera = world.mounting.base_from_camera
    canvas = canvas_of(camera)
    part = (slice(canvas.top, canvas.top + camera.height),
            slice(canvas.left, canvas.left + camera.width))

    def render_frame(frame: Frame) -> np.ndarray:
        moment = frame.stamp - world.start
        scene = "".join([
            world_scene(world, moment),
            shapes_scene(present(world.robot, moment), frame.map_from_base, world.ambient),
            camera_scene(camera, frame.map_from_base @ base_from_camera)])
        return render(scene, bitmaps, canvas.width, canvas.height, samples)[part]

    def frame_light(frame: Frame) -> np.ndarray:
        if light is None:
            return render_frame(frame)
        return kept_light(os.path.join(light, f"{frame.stamp}.png"), lambda: render_frame(frame))

    executor = ThreadPoolExecutor(jobs)
    images = [executor.submit(frame_light, frame) for frame in frames]
    try:
        for image in images:
            yield image.result()
    finally:
        for image in images:
            image.cancel()
        executor.shutdown()


def kept_light(path: str, render_light: Callable[[], np.ndarray]) -> np.ndarray:
    """The light of a frame from the 16-bit image at `path`, rendered and kept there if need be."""
    most = np.iinfo(np.uint16).max
    if not os.path.exists(path):
        # Complete or not there, should rendering be interrupted.
        unfinished = path + ".unfinished.png"
        cv2.imwrite(unfinished, np.rint(most * render_light()).astype(np.uint16))
        os.replace(unfinished, path)
    return cv2.imread(path, cv2.IMREAD_UNCHANGED).astype(float) / most


def grey_levels(light: np.ndarray, noise: float, generator: np.random.Generator) -> np.ndarray:
    """8-bit image: light and normal noise (standard deviation in grey levels), once rounded."""
    levels = 255.0 * light + noise * generator.standard_normal(light.shape)
    return np.clip(np.rint(levels), 0, 255).astype(np.uint8)
