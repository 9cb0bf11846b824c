"""A film of a drive: what the robot saw, and where it was in the map, image by image."""

from typing import Dict, List, NamedTuple, Optional, Sequence, Tuple

import cv2
import numpy as np

from omnitag.command_line import InputError
from omnitag.marker_map import MarkerMap
from omnitag.trajectory import Trajectory

# Blue, green, red; the background and the green are those of the debug image.
GROUND = (40, 34, 32)
GREY = (130, 120, 110)
WHITE = (235, 235, 235)
GREEN = (90, 217, 51)
BLUE = (255, 170, 90)
YELLOW = (51, 217, 255)
ORANGE = (26, 115, 255)

MARGIN = 0.5  # m, around everything that is drawn
GREY_LEVELS = 20  # of the film's palette


class FilmFrame(NamedTuple):
    """One image of a drive."""

    stamp: int  # ns
    debug_image: np.ndarray  # BGR
    pose: Optional[Tuple[float, float, float]]  # x, y (m) and yaw (rad) in the map
    used: List[int]  # map entries that the pose is based on


def read_result_bag(path: str) -> List[FilmFrame]:
    """Read what localize_bag --output has written, in order of time."""
    import rosbag

    images: Dict[int, np.ndarray] = {}
    poses: Dict[int, Tuple[float, float, float]] = {}
    used: Dict[int, List[int]] = {}
    topics = ["/debug_image/compressed", "/pose", "/detections"]
    try:
        with rosbag.Bag(path) as bag:
            for topic, message, _ in bag.read_messages(topics=topics):
                stamp = message.header.stamp.to_nsec()
                if topic == "/debug_image/compressed":
                    images[stamp] = cv2.imdecode(np.frombuffer(message.data, np.uint8),
                                                 cv2.IMREAD_COLOR)
                elif topic == "/pose":
                    pose = message.pose
                    poses[stamp] = (pose.position.x, pose.position.y,
                                    2.0 * np.arctan2(pose.orientation.z, pose.orientation.w))
                else:
                    used[stamp] = [detection.map_entry for detection in message.detections
                                   if detection.accepted]
    except rosbag.ROSBagException as error:
        raise InputError("{}: expected a bag: {}".format(path, error))
    if not images:
        raise InputError("{}: expected /debug_image/compressed, as localize_bag --output writes "
                         "it, found none".format(path))
    return [FilmFrame(stamp, images[stamp], poses.get(stamp), used.get(stamp, []))
            for stamp in sorted(images)]


class TopView:
    """The map from above, with markers, the route so far and lines of sight."""

    def __init__(self, marker_map: MarkerMap, frames: Sequence[FilmFrame],
                 reference: Optional[Trajectory], size: Tuple[int, int]) -> None:
        """`size` is width and height in pixels."""
        self._markers = marker_map.markers
        self._reference = reference
        places = [marker.position[:2] for marker in self._markers]
        places += [np.array(frame.pose[:2]) for frame in frames if frame.pose]
        low = np.min(places, axis=0) - MARGIN
        high = np.max(places, axis=0) + MARGIN
        self._scale = float(np.min(np.array(size) / (high - low)))
        self._middle = 0.5 * (low + high)
        self._size = size

    def draw(self, frames: Sequence[FilmFrame]) -> np.ndarray:
        """Draw the view at the last of these frames."""
        width, height = self._size
        canvas = np.full((height, width, 3), GROUND, np.uint8)
        if self._reference is not None:
            self._line(canvas, self._reference.positions[:, :2], GREY, 3)
        for marker in self._markers:
            self._marker(canvas, marker)
        self._line(canvas, [frame.pose[:2] for frame in frames if frame.pose], BLUE, 2)
        now = frames[-1]
        if now.pose:
            for entry in now.used:
                self._line(canvas, [now.pose[:2], self._markers[entry].position[:2]], GREEN, 1)
            self._robot(canvas, now.pose)
        return canvas

    def _pixel(self, place) -> Tuple[int, int]:
        x, y = self._scale * (np.asarray(place) - self._middle)
        return int(round(self._size[0] / 2 + x)), int(round(self._size[1] / 2 - y))

    def _line(self, canvas, places, colour, thickness) -> None:
        points = np.array([self._pixel(place) for place in places], np.int32).reshape(-1, 1, 2)
        cv2.polylines(canvas, [points], False, colour, thickness, cv2.LINE_AA)

    def _marker(self, canvas, marker) -> None:
        right = marker.map_from_marker[:2, 0] * 0.5 * marker.size
        centre, normal = marker.position[:2], marker.normal[:2]
        self._line(canvas, [centre - right, centre + right], WHITE, 4)
        self._line(canvas, [centre, centre + 0.2 * normal], WHITE, 1)

    def _robot(self, canvas, pose) -> None:
        x, y, yaw = pose
        along, across = np.array([np.cos(yaw), np.sin(yaw)]), np.array([-np.sin(yaw), np.cos(yaw)])
        corners = [self._pixel(np.array([x, y]) + 0.3 * offset) for offset in
                   (along, -0.7 * along + 0.7 * across, -0.7 * along - 0.7 * across)]
        cv2.fillPoly(canvas, [np.array(corners, np.int32)], YELLOW, cv2.LINE_AA)


def film_pictures(frames: Sequence[FilmFrame], marker_map: MarkerMap,
                  reference: Optional[Trajectory], height: int) -> List[np.ndarray]:
    """BGR pictures of the film, of that height: the debug image, with the map next to it."""
    pictures = []
    view: Optional[TopView] = None
    for i, frame in enumerate(frames):
        rows, columns = frame.debug_image.shape[:2]
        width = int(round(columns * height / rows))
        seen = cv2.resize(frame.debug_image, (width, height), interpolation=cv2.INTER_AREA)
        view = view or TopView(marker_map, frames, reference, (height, height))
        pictures.append(np.hstack([seen, view.draw(frames[:i + 1])]))
    return pictures


def write_gif(path: str, pictures: Sequence[np.ndarray], rate: float) -> None:
    """A film that loops, at `rate` pictures per second."""
    from PIL import Image

    images = [Image.fromarray(cv2.cvtColor(picture, cv2.COLOR_BGR2RGB)) for picture in pictures]
    # One palette for all pictures and no dithering: what does not change takes no space.
    palette = Image.new("P", (1, 1))
    palette.putpalette(_palette().tobytes())
    indexed = [image.quantize(palette=palette, dither=0) for image in images]
    indexed[0].save(path, format="GIF", save_all=True, append_images=indexed[1:], loop=0,
                    duration=int(round(1000.0 / rate)), optimize=True)


def _palette() -> np.ndarray:
    """Greys and the drawn colours, as red, green, blue; an adaptive palette would lose the colours."""
    greys = np.repeat(np.linspace(0.0, 255.0, GREY_LEVELS)[:, None], 3, axis=1)
    # Smoothed edges are mixtures of a colour and the background.
    edges = [share * np.array(colour) + (1.0 - share) * np.array(GROUND)
             for colour in (GREEN, BLUE, YELLOW, ORANGE) for share in (1.0, 0.65, 0.3)]
    colours = np.vstack([greys, [GROUND], edges])[:, ::-1]
    return np.vstack([colours, np.zeros((256 - len(colours), 3))]).round().astype(np.uint8)
