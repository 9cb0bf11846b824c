"""What the robot's odometry says of its way: the true motions, with errors that add up."""

from typing import List, NamedTuple, Sequence

import numpy as np

from omnitag.rendering.checks import not_negative, positive, seed
from omnitag.rendering.route import Frame
from omnitag.yaml_file import Value

NOISE_KEYS = ("rotation_per_rotation", "rotation_per_metre",
              "translation_per_metre", "translation_per_rotation")

# Apart from the images' noise, which a seed and a row alone begin.
_STREAM = 1


class Odometry(NamedTuple):
    """How odometry errs. Deviations belong to the motion between two images."""

    frame_id: str = "odom"
    rotation_per_rotation: float = 0.0
    """rad per rad: the square root of amcl's alpha1."""
    rotation_per_metre: float = 0.0
    """rad per metre: the square root of amcl's alpha2."""
    translation_per_metre: float = 0.0
    """Metres per metre, along and across: the square root of amcl's alpha3."""
    translation_per_rotation: float = 0.0
    """Metres per rad, along and across: the square root of amcl's alpha4."""
    scale: float = 1.0
    """Measured per true distance."""
    rate: float = 20.0
    """Hz of the transforms between two images."""
    seed: int = 0


class Sample(NamedTuple):
    """base_link in the odometry frame; nanoseconds, metres and radians."""

    stamp: int
    x: float
    y: float
    yaw: float


def read_odometry(value: Value) -> Odometry:
    """The mapping `odometry` of a world file; what is left out is without error."""
    entry = value.mapping(("frame_id", *NOISE_KEYS, "scale", "rate", "seed"))
    given = {key: not_negative(entry[key]) for key in NOISE_KEYS if key in entry}
    given.update({key: positive(entry[key]) for key in ("scale", "rate") if key in entry})
    if "frame_id" in entry:
        given["frame_id"] = entry["frame_id"].text()
    if "seed" in entry:
        given["seed"] = seed(entry["seed"])
    return Odometry(**given)


def odometry_samples(odometry: Odometry, frames: Sequence[Frame],
                     rows: Sequence[int]) -> List[List[Sample]]:
    """For each frame the samples since the frame before; the last one is at the frame's stamp.

    The first pose is the identity. The error of a motion belongs to the row of the route that it
    leads to, whichever rows are rendered.
    """
    samples = [[Sample(frames[0].stamp, 0.0, 0.0, 0.0)]]
    for before, after, row in zip(frames, frames[1:], rows[1:]):
        generator = np.random.default_rng([odometry.seed, row, _STREAM])
        motion = _measured(odometry, _true_motion(before, after), generator)
        samples.append(_drive(samples[-1][-1], motion, after.stamp, odometry.rate))
    return samples


def _true_motion(before: Frame, after: Frame) -> np.ndarray:
    """x, y and yaw of `after` in the base_link of `before`, as far as the robot itself drove."""
    if after.jump:
        return np.zeros(3)
    x, y = after.x - before.x, after.y - before.y
    cosine, sine = np.cos(before.yaw), np.sin(before.yaw)
    turn = np.arctan2(np.sin(after.yaw - before.yaw), np.cos(after.yaw - before.yaw))
    return np.array([cosine * x + sine * y, cosine * y - sine * x, turn])


def _measured(odometry: Odometry, motion: np.ndarray,
              generator: np.random.Generator) -> np.ndarray:
    distance, turn = np.hypot(motion[0], motion[1]), abs(motion[2])
    translation = np.hypot(odometry.translation_per_metre * distance,
                           odometry.translation_per_rotation * turn)
    rotation = np.hypot(odometry.rotation_per_rotation * turn,
                        odometry.rotation_per_metre * distance)
    scales = np.array([odometry.scale, odometry.scale, 1.0])
    deviations = np.array([translation, translation, rotation])
    return scales * motion + deviations * generator.standard_normal(3)


def _drive(start: Sample, motion: np.ndarray, end_stamp: int, rate: float) -> List[Sample]:
    """From `start` in a straight line to where `motion` leads, as tf interpolates poses."""
    cosine, sine = np.cos(start.yaw), np.sin(start.yaw)
    step = np.array([cosine * motion[0] - sine * motion[1],
                     sine * motion[0] + cosine * motion[1], motion[2]])
    duration = end_stamp - start.stamp
    elapsed = [round(count * 1e9 / rate) for count in range(1, int(duration * rate / 1e9) + 1)]
    stamps = [start.stamp + time for time in elapsed if 0 < time < duration] + [end_stamp]
    poses = [np.array(start[1:]) + (stamp - start.stamp) / duration * step for stamp in stamps]
    return [Sample(stamp, *pose) for stamp, pose in zip(stamps, poses)]
