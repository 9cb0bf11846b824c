"""The world as POV-Ray text: light, room, furniture and markers."""

from typing import Dict, Iterable, List, Tuple

import numpy as np

from omnitag.board_file import Board
from omnitag.marker_drawing import drawing_of
from omnitag.marker_map import Marker
from omnitag.rendering.hung_boards import HungBoard
from omnitag.rendering.povray import MILLIMETRES, matrix, point, vector
from omnitag.rendering.world import (
    Boards, Box, Light, Material, Room, Shape, World, present)

# Gap between a marker's face and its board: above POV-Ray's tolerances, too small to be visible.
_FACE_GAP = 2e-5

_PATTERNS = {
    "checker": "checker {dark}, {light} scale {half}",
    "brick": "brick {light}, {dark} brick_size <1, 0.3, 1> mortar 0.03 rotate 90*x "
             "scale {scale}",
    "wood": "wood turbulence 0.08 color_map {{ [0 {dark}] [1 {light}] }} rotate 88*y "
            "scale {scale}",
    "granite": "granite color_map {{ [0 {dark}] [1 {light}] }} scale {scale}",
    "clouds": "bozo turbulence 0.6 color_map {{ [0 {dark}] [1 {light}] }} scale {scale}",
}


def world_scene(world: World, moment: int) -> str:
    """Everything except the robot at `moment`, in nanoseconds on the route's clock.

    The markers refer to `marker_bitmaps`, calibration boards to `board_bitmaps`.
    """
    parts = [_settings(), *map(_light, world.lights), _room(world.room, world.ambient),
             shapes_scene(present(world.furniture, moment), np.eye(4), world.ambient)]
    parts += [marker_scene(marker, world.boards, world.ambient)
              for marker in world.hung_markers.at(moment)]
    parts += [board_scene(board, world.boards, world.ambient)
              for board in present(world.hung_boards, moment)]
    return "".join(parts)


def shapes_scene(shapes: Iterable[Shape], map_from_parent: np.ndarray, ambient: float) -> str:
    """Boxes and cylinders in the map, or on a robot at `map_from_parent`."""
    return "".join(_shape(shape, map_from_parent, ambient) for shape in shapes)


def marker_bitmaps(markers: Iterable[Marker], boards: Boards) -> Dict[str, np.ndarray]:
    """The image files that the markers refer to, by name; 8 or 16 bit, one pixel per cell."""
    return {name: bitmap for marker in markers for name, bitmap, _ in _bitmaps(marker, boards)}


def board_bitmaps(hung: Iterable[HungBoard], boards: Boards) -> Dict[str, np.ndarray]:
    """The image files that calibration boards refer to, by name; 16 bit, one pixel per module."""
    return {name: bitmap for each in hung for marker in _board_markers(each.board)
            for name, bitmap, _ in _bare_bitmaps(marker, boards)}


def marker_scene(marker: Marker, boards: Boards, ambient: float) -> str:
    """A marker with its face exactly in its plane, and the board behind it."""
    half = 0.5 * board_width(marker, boards)
    corners = ", ".join(point((x, y, 0)) for x, y in (
        (-half, -half), (half, -half), (half, half), (-half, half), (-half, -half)))
    pictures = [_picture(name, width, ambient) for name, _, width in _bitmaps(marker, boards)]
    # Upon each other as layers of one surface: beyond its bitmap, a picture is transparent.
    face = pictures[0] if len(pictures) == 1 else "\n".join(
        f"texture {{\n{picture}\n  }}" for picture in pictures)
    return f"""union {{
  polygon {{
    5, {corners}
    {face}
  }}
  box {{
    {point((-half, -half, -boards.thickness))}, {point((half, half, -_FACE_GAP))}
    {_texture(boards.back, ambient)}
  }}
  {matrix(marker.map_from_marker)}
}}
"""


def board_scene(hung: HungBoard, boards: Boards, ambient: float) -> str:
    """A calibration board: its black squares and markers exactly in its plane, upon white, and its back."""
    half = 0.5 * np.array(board_size(hung.board, boards))
    x, y = half
    parts = [_rectangle(-half, half, -_FACE_GAP, _plain(boards.white, ambient)),
             *_squares(hung.board, boards, ambient), *_board_faces(hung.board, boards, ambient)]
    return f"""union {{
  {"".join(parts)}
  box {{
    {point((-x, -y, -boards.thickness))}, {point((x, y, -2.0 * _FACE_GAP))}
    {_texture(boards.back, ambient)}
  }}
  {matrix(hung.map_from_board)}
}}
"""


def board_size(board: Board, boards: Boards) -> Tuple[float, float]:
    """Width and height in metres of a calibration board with the white around it."""
    module = max(marker.size * drawing_of(marker, 0).module for marker in _board_markers(board))
    rim = 2.0 * boards.quiet_modules * module
    return board.width + rim, board.height + rim


def board_width(marker: Marker, boards: Boards) -> float:
    """Metres along each edge of the marker's board."""
    return marker.size * drawing_of(marker, boards.quiet_modules).width


def _board_markers(board: Board) -> List[Marker]:
    """The markers at their places on the board."""
    markers = []
    for marker in board.markers:
        board_from_marker = np.eye(4)
        board_from_marker[:2, 3] = marker.x, marker.y
        markers.append(Marker(marker.id, marker.family, "", marker.size, board_from_marker))
    return markers


def _bare_bitmaps(marker: Marker, boards: Boards) -> List[Tuple[str, np.ndarray, float]]:
    """As `_bitmaps`, without a white zone, which would cover squares; as black as these are."""
    return [("bare_" + name, bitmap, width)
            for name, bitmap, width in _bitmaps(marker, boards._replace(quiet_modules=0), True)]


def _squares(board: Board, boards: Boards, ambient: float) -> List[str]:
    """The black squares, seen from the board's middle."""
    black = _plain(boards.black, ambient)
    lower = [np.array([square.left, square.bottom]) - _middle(board) for square in board.squares]
    return [_rectangle(corner, corner + square.width, 0.0, black)
            for corner, square in zip(lower, board.squares)]


def _board_faces(board: Board, boards: Boards, ambient: float) -> List[str]:
    """The markers without a white zone, seen from the board's middle."""
    faces = []
    for marker in _board_markers(board):
        (name, _, width), = _bare_bitmaps(marker, boards)
        half = np.full(2, 0.5 * width)
        face = _rectangle(-half, half, 0.0, _picture(name, width, ambient))
        x, y = marker.position[:2] - _middle(board)
        faces.append(f"object {{ {face} translate {point((x, y, 0.0))} }}\n")
    return faces


def _middle(board: Board) -> np.ndarray:
    """(2,), in m: the middle of a board, from the board's own origin."""
    return np.array([board.left + 0.5 * board.width, board.bottom + 0.5 * board.height])


def _rectangle(lower: np.ndarray, upper: np.ndarray, z: float, face: str) -> str:
    """A rectangle parallel to the x-y plane, in metres."""
    (x, y), (x_upper, y_upper) = lower, upper
    corners = ", ".join(point(corner) for corner in (
        (x, y, z), (x_upper, y, z), (x_upper, y_upper, z), (x, y_upper, z), (x, y, z)))
    return f"polygon {{ 5, {corners} {face} }}\n"


def _plain(grey: float, ambient: float) -> str:
    return f"pigment {{ rgb {grey:.6g} }} {_finish(ambient)}"


def _settings() -> str:
    return """#version 3.7;
global_settings { assumed_gamma 1.0 ambient_light rgb 1 max_trace_level 5 }
background { rgb 0 }
"""


def _light(light: Light) -> str:
    size = MILLIMETRES * light.size
    area = f"area_light <{size:g}, 0, 0>, <0, {size:g}, 0>, 3, 3 adaptive 0" if size else ""
    return f"""light_source {{
  {point(light.position)}, rgb {light.intensity:.6g}
  {area}
  fade_distance {MILLIMETRES * light.reach:.6g} fade_power 2
}}
"""


def _room(room: Room, ambient: float) -> str:
    (x_lower, y_lower), (x_upper, y_upper) = room.lower, room.upper
    thickness = 0.1
    slabs = [
        ((x_lower, y_lower, -thickness), (x_upper, y_upper, 0), room.floor),
        ((x_lower, y_lower, room.height), (x_upper, y_upper, room.height + thickness),
         room.ceiling),
        ((x_lower - thickness, y_lower, 0), (x_lower, y_upper, room.height), room.walls),
        ((x_upper, y_lower, 0), (x_upper + thickness, y_upper, room.height), room.walls),
        ((x_lower, y_lower - thickness, 0), (x_upper, y_lower, room.height), room.walls),
        ((x_lower, y_upper, 0), (x_upper, y_upper + thickness, room.height), room.walls)]
    return "".join(
        f"box {{ {point(lower)}, {point(upper)} {_texture(material, ambient)} }}\n"
        for lower, upper, material in slabs)


def _shape(shape: Shape, map_from_parent: np.ndarray, ambient: float) -> str:
    if isinstance(shape, Box):
        x, y, z = shape.size
        body = f"box {{ {point((-x / 2, -y / 2, 0))}, {point((x / 2, y / 2, z))}"
    else:
        body = (f"cylinder {{ {point((0, 0, 0))}, {point((0, 0, shape.height))}, "
                f"{MILLIMETRES * shape.radius:.12g}")
    map_from_shape = map_from_parent @ shape.parent_from_shape
    return f"{body} {_texture(shape.material, ambient)} {matrix(map_from_shape)} }}\n"


def _texture(material: Material, ambient: float) -> str:
    greys = {"dark": f"rgb {material.dark:.6g}", "light": f"rgb {material.light:.6g}",
             "scale": f"{MILLIMETRES * material.scale:.9g}",
             "half": f"{MILLIMETRES * material.scale / 2:.9g}"}
    pattern = _PATTERNS.get(material.pattern, "{light}").format(**greys)
    # Away from round coordinates, where a face would lie exactly between two cells of a pattern.
    shift = MILLIMETRES * material.scale * np.array([0.11, 0.13, 0.17])
    return (f"pigment {{ {pattern} translate {vector(shift)} }} "
            f"{_finish(ambient, material.glow)}")


def _finish(ambient: float, glow: float = 0.0) -> str:
    return f"finish {{ ambient {ambient:.6g} emission {glow:.6g} diffuse 1 }}"


def _picture(name: str, width: float, ambient: float) -> str:
    """A bitmap of that width in metres, centred on the marker."""
    edge = MILLIMETRES * width
    return f"""pigment {{
      image_map {{ png "{name}" gamma 1.0 once }}
      translate <-0.5, -0.5, 0> scale <{edge:.15g}, {edge:.15g}, 1>
    }}
    {_finish(ambient)}"""


def _bitmaps(marker: Marker, boards: Boards,
             exact: bool = False) -> List[Tuple[str, np.ndarray, float]]:
    """Name, (n, n) image and width in metres of each square of a marker, the lowest first.

    `exact`: black and white are rendered as exactly as greys.
    """
    drawing = drawing_of(marker, boards.quiet_modules)
    # POV-Ray takes a third of the greys of 8-bit images for the next darker one.
    white, depth = (65535, np.uint16) if exact or drawing.has_greys else (255, np.uint8)
    bitmaps = []
    for index, square in enumerate(drawing.squares):
        greys = boards.black + (boards.white - boards.black) * square.cells
        name = drawing.name + (f"_{index}" if index else "")
        bitmaps.append((name + ".png", np.rint(white * greys).astype(depth),
                        marker.size * square.width))
    return bitmaps
