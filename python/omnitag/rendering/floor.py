"""A floor that is not level: it leans and lifts the robot in addition to the route."""

from typing import List, NamedTuple, Sequence, Tuple

import numpy as np

from omnitag.rendering.checks import not_negative, seed
from omnitag.rendering.route import Frame
from omnitag.yaml_file import Value

DEVIATION_KEYS = ("lean_deviation", "height_deviation", "lean_walk", "height_walk")

# Separates these draws from the images' noise and the odometry's, which may have the same seed.
_STREAM = 2


class Floor(NamedTuple):
    """What is added to the route's roll, pitch and z; a level floor by default."""

    lean_deviation: float = 0.0
    """rad, of roll and of pitch, independent in each frame."""
    height_deviation: float = 0.0
    """Metres, independent in each frame."""
    lean_walk: float = 0.0
    """rad per square root of a metre of the route, of roll and of pitch."""
    height_walk: float = 0.0
    """Metres per square root of a metre of the route."""
    constant_lean: Tuple[float, float] = (0.0, 0.0)
    """rad, roll and pitch."""
    constant_height: float = 0.0
    """Metres."""
    seed: int = 0


LEVEL = Floor()


def read_floor(value: Value) -> Floor:
    """Read the mapping `floor` of a world file; missing keys are 0."""
    entry = value.mapping((*DEVIATION_KEYS, "constant_lean", "constant_height", "seed"))
    given = {key: not_negative(entry[key]) for key in DEVIATION_KEYS if key in entry}
    roll, pitch = (entry["constant_lean"].reals(2) if "constant_lean" in entry
                   else LEVEL.constant_lean)
    if "constant_height" in entry:
        given["constant_height"] = entry["constant_height"].real()
    return Floor(constant_lean=(roll, pitch),
                 seed=seed(entry["seed"]) if "seed" in entry else LEVEL.seed, **given)


def on_floor(floor: Floor, frames: Sequence[Frame]) -> List[Frame]:
    """The frames of a whole route, leaned and lifted by the floor.

    The random numbers of a row depend only on the seed and the row.
    """
    deviations = np.array([floor.lean_deviation, floor.lean_deviation, floor.height_deviation])
    walks = np.array([floor.lean_walk, floor.lean_walk, floor.height_walk])
    constant = np.array([*floor.constant_lean, floor.constant_height])
    walked = np.zeros(3)
    leaning = []
    for row, frame in enumerate(frames):
        draws = np.random.default_rng([floor.seed, row, _STREAM]).standard_normal((2, 3))
        before = frames[max(row - 1, 0)]
        distance = np.hypot(frame.x - before.x, frame.y - before.y)
        walked = walked + np.sqrt(distance) * walks * draws[0]
        roll, pitch, z = constant + walked + deviations * draws[1]
        leaning.append(frame._replace(roll=frame.roll + roll, pitch=frame.pitch + pitch,
                                      z=frame.z + z))
    return leaning
