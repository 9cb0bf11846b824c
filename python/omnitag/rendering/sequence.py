"""From a route to images: where the robot is in each frame, and what its camera sees there."""

import csv
from concurrent.futures import ThreadPoolExecutor
from typing import Iterator, List, NamedTuple

import numpy as np

from omnitag.command_line import InputError
from omnitag.rendering.camera import CatadioptricCamera
from omnitag.rendering.optics import camera_scene
from omnitag.rendering.povray import render
from omnitag.rendering.scene import marker_bitmaps, shapes_scene, world_scene
from omnitag.rendering.world import World, upright_transform
from omnitag.trajectory import Trajectory, format_stamp, parse_stamp, planar_trajectory

ROUTE_FIELDS = ["stamp", "x", "y", "yaw"]


class Frame(NamedTuple):
    """One moment of the route: the pose of base_link in map, in metres and radians."""

    stamp: int
    x: float
    y: float
    yaw: float

    @property
    def map_from_base(self) -> np.ndarray:
        """(4, 4) transform."""
        return upright_transform(np.array([self.x, self.y, 0.0]), self.yaw)


def read_route(path: str, start: int) -> List[Frame]:
    """Reads a CSV file `stamp,x,y,yaw`, one row per image, and adds `start` nanoseconds.

    Raises InputError naming file, line and field.
    """
    frames: List[Frame] = []
    with open(path, newline="", encoding="utf-8") as file:
        reader = csv.reader(file)
        try:
            rows = [(reader.line_num, row) for row in reader if row]
        except (UnicodeDecodeError, csv.Error) as error:
            raise InputError(f"{path}: expected CSV, found: {error}")
    if not rows or [field.strip() for field in rows[0][1]] != ROUTE_FIELDS:
        raise InputError(f"{path}:1: expected the header {','.join(ROUTE_FIELDS)}, "
                         f"found '{','.join(rows[0][1]) if rows else ''}'")
    for line, row in rows[1:]:
        frame = _parse_frame(row, start, f"{path}:{line}")
        if frames and frame.stamp <= frames[-1].stamp:
            raise InputError(f"{path}:{line}: stamp: expected one after "
                             f"{format_stamp(frames[-1].stamp - start)}, found {row[0]}")
        frames.append(frame)
    if not frames:
        raise InputError(f"{path}: expected poses, found none")
    return frames


def trajectory_of(frames: List[Frame]) -> Trajectory:
    """The ground truth of the frames."""
    stamps, x, y, yaw = zip(*frames)
    return planar_trajectory(np.array(stamps), np.array(x), np.array(y), np.array(yaw))


def render_frames(world: World, camera: CatadioptricCamera, frames: List[Frame],
                  jobs: int) -> Iterator[np.ndarray]:
    """The light of each frame, (height, width) with 1 where white, in the order of the frames."""
    surroundings = world_scene(world)
    bitmaps = marker_bitmaps(world.marker_map.markers, world.boards)
    base_from_camera = world.mounting.base_from_camera

    def render_frame(frame: Frame) -> np.ndarray:
        scene = "".join([
            surroundings,
            shapes_scene(world.robot, frame.map_from_base, world.ambient),
            camera_scene(camera, frame.map_from_base @ base_from_camera)])
        return render(scene, bitmaps, camera.width, camera.height)

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


def _parse_frame(row: List[str], start: int, place: str) -> Frame:
    if len(row) != len(ROUTE_FIELDS):
        raise InputError(f"{place}: expected {len(ROUTE_FIELDS)} fields "
                         f"({','.join(ROUTE_FIELDS)}), found {len(row)}")
    try:
        stamp = parse_stamp(row[0])
    except ValueError:
        raise InputError(f"{place}: stamp: expected seconds, found '{row[0]}'")
    pose = []
    for name, text in zip(ROUTE_FIELDS[1:], row[1:]):
        try:
            number = float(text)
        except ValueError:
            number = np.nan
        if not np.isfinite(number):
            raise InputError(f"{place}: {name}: expected a finite number, found '{text}'")
        pose.append(number)
    return Frame(start + stamp, *pose)
