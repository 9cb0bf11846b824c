"""From a route to images: what the robot's camera sees in each frame."""

from concurrent.futures import ThreadPoolExecutor
from typing import Iterator, List

import numpy as np

from omnitag.rendering.camera import Camera, canvas_of
from omnitag.rendering.optics import camera_scene
from omnitag.rendering.povray import render
from omnitag.rendering.route import Frame
from omnitag.rendering.scene import marker_bitmaps, shapes_scene, world_scene
from omnitag.rendering.world import World, present


def render_frames(world: World, camera: Camera, frames: List[Frame],
                  jobs: int) -> Iterator[np.ndarray]:
    """The light of each frame, (height, width) with 1 where white, in the order of the frames."""
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
        return render(scene, bitmaps, canvas.width, canvas.height)[part]

    executor = ThreadPoolExecutor(jobs)
    images = [executor.submit(render_frame, frame) for frame in frames]
    try:
        for image in images:
            yield image.result()
    finally:
        for image in images:
            image.cancel()
        executor.shutdown()


def grey_levels(light: np.ndarray, noise: float, generator: np.random.Generator) -> np.ndarray:
    """8-bit image: light and normal noise (standard deviation in grey levels), once rounded."""
    levels = 255.0 * light + noise * generator.standard_normal(light.shape)
    return np.clip(np.rint(levels), 0, 255).astype(np.uint8)
