"""Calibration boards in the room."""

from typing import NamedTuple, Tuple

import numpy as np

from omnitag.board_file import Board, load_board
from omnitag.command_line import InputError
from omnitag.marker_map import read_rotation
from omnitag.rendering.stretches import Stretches, read_during
from omnitag.yaml_file import Mapping, Value


class HungBoard(NamedTuple):
    """A board at its place in the room."""

    board: Board
    map_from_board: np.ndarray
    """(4, 4), metres: from the middle of the board, x to the right, y up and z out of its face."""
    during: Stretches


def read_hung_boards(root: Mapping) -> Tuple[HungBoard, ...]:
    """Read `calibration_boards` of a world file, optional; raises InputError naming file, line and key."""
    if "calibration_boards" not in root:
        return ()
    return tuple(_hung_board(item) for item in root["calibration_boards"].items("a list of boards"))


def _hung_board(value: Value) -> HungBoard:
    entry = value.mapping(("board", "position", "yaw", "roll", "orientation", "during"))
    try:
        board = load_board(entry["board"].path())
    except InputError as error:
        raise entry["board"].error("a board file", str(error))
    map_from_board = np.eye(4)
    map_from_board[:3, :3] = read_rotation(entry)
    map_from_board[:3, 3] = entry["position"].reals(3)
    return HungBoard(board, map_from_board, read_during(entry))
