"""The world file: the room with its furniture, lights and markers, and the mounting of the camera."""

import os
from typing import Dict, Iterable, List, NamedTuple, Optional, Sequence, Tuple, TypeVar, Union

import numpy as np

from omnitag.marker_map import MarkerMap, load_marker_map, rotation_from_quaternion
from omnitag.rendering import effects, shutter
from omnitag.rendering.checks import not_negative, positive, share
from omnitag.rendering.effects import Effects, read_effects
from omnitag.rendering.floor import LEVEL, Floor, read_floor
from omnitag.rendering.hung_boards import HungBoard, read_hung_boards
from omnitag.rendering.hung_markers import HungMarkers, read_hung_markers
from omnitag.rendering.odometry import Odometry, read_odometry
from omnitag.rendering.poses import upright_transform
from omnitag.rendering.shutter import Shutter, read_shutter
from omnitag.rendering.stretches import Stretches, read_during
from omnitag.yaml_file import Mapping, Value, read_yaml

KEYS = ("marker_map", "camera", "images", "ambient", "lights", "materials", "room", "boards",
        "furniture", "robot", "displaced_markers", "missing_markers", "decoys",
        "calibration_boards", "odometry", "floor")
IMAGE_KEYS = ("start", "noise", *effects.KEYS, *shutter.KEYS)
PATTERNS = ("plain", "checker", "brick", "wood", "granite", "clouds")
QUATERNION_TOLERANCE = 1e-3


class Material(NamedTuple):
    """A matt surface, in shades of grey from 0 (black) to 1 (white)."""

    pattern: str
    dark: float
    light: float
    scale: float
    """Metres: the pattern's period."""
    glow: float
    """Light that the surface emits; 0 if it is only lit."""


class Box(NamedTuple):
    """A box, placed by the centre of its lower face."""

    size: Tuple[float, float, float]
    """Metres along its own x, y and z."""
    parent_from_shape: np.ndarray
    material: Material
    during: Stretches


class Cylinder(NamedTuple):
    """An upright cylinder, placed by the centre of its lower face."""

    radius: float
    height: float
    parent_from_shape: np.ndarray
    material: Material
    during: Stretches


Shape = Union[Box, Cylinder]
Passing = TypeVar("Passing", Box, Cylinder, Shape, HungBoard)
"""What may be present for a while."""


class Light(NamedTuple):
    """A square lamp that shines downwards; metres, in the map."""

    position: np.ndarray
    size: float
    intensity: float
    """The light of a white surface that faces the lamp at `reach` metres."""
    reach: float


class Room(NamedTuple):
    """A rectangular room with its floor at z = 0; metres, in the map."""

    lower: Tuple[float, float]
    upper: Tuple[float, float]
    height: float
    floor: Material
    walls: Material
    ceiling: Material


class Boards(NamedTuple):
    """The boards that the markers are printed on."""

    thickness: float
    """Metres, behind the marker's plane."""
    quiet_modules: int
    """White modules on each side of the pattern, at least 1."""
    black: float
    white: float
    back: Material


class Mounting(NamedTuple):
    """The pose of the camera on the robot."""

    frame_id: str
    """The camera's optical frame."""
    position: np.ndarray
    """The optical frame's origin in base_link, metres."""
    orientation: np.ndarray
    """Unit quaternion x, y, z, w: optical frame to base_link."""

    @property
    def base_from_camera(self) -> np.ndarray:
        """(4, 4) transform from the optical frame to base_link."""
        transform = np.eye(4)
        transform[:3, :3] = rotation_from_quaternion(self.orientation)
        transform[:3, 3] = self.position
        return transform


class World(NamedTuple):
    """Everything except the camera and the route."""

    marker_map: MarkerMap
    hung_markers: HungMarkers
    """What really hangs in the room."""
    mounting: Mounting
    start: int
    """Nanoseconds, added to the trajectory's stamps."""
    noise: float
    """Standard deviation of the image noise, in grey levels."""
    ambient: float
    """Light that reaches every surface from all directions, in addition to the lamps'."""
    lights: Tuple[Light, ...]
    room: Room
    boards: Boards
    furniture: Tuple[Shape, ...]
    robot: Tuple[Shape, ...]
    """Parts of the robot, in base_link."""
    odometry: Optional[Odometry]
    effects: Effects = Effects()
    shutter: Shutter = Shutter()
    floor: Floor = LEVEL
    hung_boards: Tuple[HungBoard, ...] = ()


def load_world(path: str, map_path: Optional[str] = None,
               settings: Sequence[str] = ()) -> World:
    """Read a world file; `map_path`, if given, replaces its marker map.

    Each of `settings`, `KEY=VALUE`, overrides a key of the file; KEY is the path of keys, joined by
    dots. Raises InputError naming file, line and key.
    """
    root = _root(path)
    for setting in settings:
        root = root.with_setting(setting, KEYS)
    images = root["images"].mapping(IMAGE_KEYS)
    materials = _materials(root["materials"])
    own_map_path = os.path.join(os.path.dirname(path), root["marker_map"].text())
    marker_map = load_marker_map(own_map_path if map_path is None else map_path)
    return World(
        marker_map=marker_map,
        hung_markers=read_hung_markers(root, marker_map),
        mounting=_mounting(root["camera"]),
        start=round(not_negative(images["start"]) * 1e9),
        noise=not_negative(images["noise"]),
        ambient=not_negative(root["ambient"]),
        lights=tuple(_light(item) for item in root["lights"].items()),
        room=_room(root["room"], materials),
        boards=_boards(root["boards"], materials),
        furniture=_shapes(root, "furniture", materials),
        robot=_shapes(root, "robot", materials),
        odometry=read_odometry(root["odometry"]) if "odometry" in root else None,
        effects=read_effects(images),
        shutter=read_shutter(images),
        floor=read_floor(root["floor"]) if "floor" in root else LEVEL,
        hung_boards=read_hung_boards(root))


def _root(path: str) -> Mapping:
    """The keys of a world file, and those that only the file that it extends has."""
    root = read_yaml(path).mapping(("extends",) + KEYS)
    if "extends" not in root:
        return root
    base_path = os.path.join(os.path.dirname(path), root["extends"].text())
    return root.over(read_yaml(base_path).mapping(KEYS))


def present(shapes: Iterable[Passing], moment: int) -> List[Passing]:
    """The shapes or boards that are present at `moment`, in nanoseconds on the route's clock."""
    return [shape for shape in shapes if shape.during.cover(moment)]


def _mounting(value: Value) -> Mounting:
    entry = value.mapping(("frame_id", "position", "orientation"))
    orientation = np.array(entry["orientation"].reals(4))
    length = np.linalg.norm(orientation)
    if abs(length - 1.0) > QUATERNION_TOLERANCE:
        raise entry["orientation"].error("a quaternion of length 1", f"length {length:.6g}")
    return Mounting(entry["frame_id"].text(), np.array(entry["position"].reals(3)),
                    orientation / length)


def _light(value: Value) -> Light:
    entry = value.mapping(("position", "size", "intensity", "reach"))
    return Light(np.array(entry["position"].reals(3)), not_negative(entry["size"]),
                 not_negative(entry["intensity"]), positive(entry["reach"]))


def _materials(value: Value) -> Dict[str, Material]:
    materials: Dict[str, Material] = {}
    for item in value.items():
        entry = item.mapping(("name", "pattern", "dark", "light", "grey", "scale", "glow"))
        name = entry["name"].text()
        if name in materials:
            raise entry["name"].error("a name of its own", f"'{name}' again")
        materials[name] = _material(entry)
    return materials


def _material(entry: Mapping) -> Material:
    glow = not_negative(entry["glow"]) if "glow" in entry else 0.0
    pattern = entry["pattern"].text() if "pattern" in entry else "plain"
    if pattern not in PATTERNS:
        raise entry["pattern"].error("one of " + ", ".join(PATTERNS))
    if pattern == "plain":
        grey = share(entry["grey"])
        return Material(pattern, grey, grey, 1.0, glow)
    return Material(pattern, share(entry["dark"]), share(entry["light"]),
                    positive(entry["scale"]), glow)


def _room(value: Value, materials: Dict[str, Material]) -> Room:
    entry = value.mapping(("x", "y", "height", "floor", "walls", "ceiling"))
    sides = [entry[key].reals(2) for key in ("x", "y")]
    for key, (lower, upper) in zip(("x", "y"), sides):
        if lower >= upper:
            raise entry[key].error("the lower bound first", f"[{lower:g}, {upper:g}]")
    return Room((sides[0][0], sides[1][0]), (sides[0][1], sides[1][1]),
                positive(entry["height"]), _named(entry["floor"], materials),
                _named(entry["walls"], materials), _named(entry["ceiling"], materials))


def _boards(value: Value, materials: Dict[str, Material]) -> Boards:
    entry = value.mapping(("thickness", "quiet_modules", "black", "white", "back"))
    quiet_modules = entry["quiet_modules"].integer()
    if quiet_modules < 1:
        raise entry["quiet_modules"].error("at least 1")
    return Boards(positive(entry["thickness"]), quiet_modules, share(entry["black"]),
                  share(entry["white"]), _named(entry["back"], materials))


def _shapes(root: Mapping, key: str, materials: Dict[str, Material]) -> Tuple[Shape, ...]:
    if key not in root:
        return ()
    return tuple(_shape(item, materials) for item in root[key].items())


def _shape(value: Value, materials: Dict[str, Material]) -> Shape:
    common = ("shape", "name", "position", "yaw", "material", "during")
    entry = value.mapping(common + ("size", "radius", "height"))
    shape = entry["shape"].text()
    if shape not in ("box", "cylinder"):
        raise entry["shape"].error("box or cylinder")
    entry = value.mapping(common + (("size",) if shape == "box" else ("radius", "height")))
    parent_from_shape = upright_transform(np.array(entry["position"].reals(3)),
                                          entry["yaw"].real() if "yaw" in entry else 0.0)
    material = _named(entry["material"], materials)
    during = read_during(entry)
    if shape == "cylinder":
        return Cylinder(positive(entry["radius"]), positive(entry["height"]),
                        parent_from_shape, material, during)
    size = entry["size"].reals(3)
    if min(size) <= 0.0:
        raise entry["size"].error("three positive numbers", str(size))
    x, y, z = size
    return Box((x, y, z), parent_from_shape, material, during)


def _named(value: Value, materials: Dict[str, Material]) -> Material:
    name = value.text()
    if name not in materials:
        raise value.error("one of the materials " + ", ".join(materials))
    return materials[name]
