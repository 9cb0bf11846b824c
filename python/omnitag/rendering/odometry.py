"""The robot's odometry: the true motions, with errors that accumulate."""

from typing import List, NamedTuple, Optional, Sequence, Union

import numpy as np

from omnitag.rendering.checks import not_negative, positive, seed
from omnitag.rendering.path import SmoothPath
from omnitag.rendering.poses import Pose
from omnitag.rendering.route import Frame
from omnitag.yaml_file import Value

NOISE_KEYS = ("rotation_per_rotation", "rotation_per_metre",
              "translation_per_metre", "translation_per_rotation")

# Separates these draws from the images' noise, which is drawn from a seed and a row alone.
_STREAM = 1


class Odometry(NamedTuple):
    """The errors of odometry. Deviations are those of the motion between two images."""

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
    """Measured distance divided by true distance."""
    rate: float = 20.0
    """Hz of the transforms between two images."""
    seed: int = 0
    lean: bool = False
    """Whether it has the true height, roll and pitch; otherwise it is planar."""


class Sample(NamedTuple):
    """base_link in the odometry frame; nanoseconds, metres and radians."""

    stamp: int
    x: float
    y: float
    yaw: float
    z: float = 0.0
    roll: float = 0.0
    pitch: float = 0.0


def read_odometry(value: Value) -> Odometry:
    """Read the mapping `odometry` of a world file; missing keys mean no such error."""
    entry = value.mapping(("frame_id", *NOISE_KEYS, "scale", "rate", "seed", "lean"))
    given = {key: not_negative(entry[key]) for key in NOISE_KEYS if key in entry}
    given.update({key: positive(entry[key]) for key in ("scale", "rate") if key in entry})
    usual = Odometry()
    return Odometry(
        frame_id=entry["frame_id"].text() if "frame_id" in entry else usual.frame_id,
        seed=seed(entry["seed"]) if "seed" in entry else usual.seed,
        lean=entry["lean"].boolean() if "lean" in entry else usual.lean, **given)


def odometry_samples(odometry: Odometry, frames: Sequence[Frame], rows: Sequence[int],
                     path: Optional[SmoothPath] = None, lead: int = 0,
                     tail: int = 0) -> List[List[Sample]]:
    """For each frame, the samples since the previous frame; the last one is at the frame's stamp.

    They follow `path`, by default through only these frames. The pose at the first frame is the
    identity, in the plane. Exposures begin `lead` nanoseconds before the frames' stamps and end `tail`
    after them. Samples cover all of them, also before the first frame; `samples_after` gives those
    after the last one. The error of a motion depends on the row of the route where the motion ends,
    whichever rows are rendered, and grows evenly over the motion.
    """
    wheels = _Wheels(odometry, path or SmoothPath(frames))
    ahead = wheels.about(frames[0], np.zeros(3), -lead, 0)
    samples = [ahead + [wheels.sample(frames[0], frames[0].stamp, np.zeros(3))]]
    for before, after, row in zip(frames, frames[1:], rows[1:]):
        start = np.array(samples[-1][-1][1:4])
        if after.jump:
            samples.append(wheels.carried(before, after, start, lead, tail))
            continue
        generator = np.random.default_rng([odometry.seed, row, _STREAM])
        samples.append(wheels.driven(before, after, start, generator.standard_normal(3)))
    return samples


def samples_after(odometry: Odometry, frame: Frame, last: Sample, path: SmoothPath,
                  tail: int) -> List[Sample]:
    """Samples after `last`, which is at `frame`, to the end of the exposure `tail` ns later."""
    return _Wheels(odometry, path).about(frame, np.array(last[1:4]), 0, tail)


class _Wheels:
    """Odometry along a path, one motion at a time."""

    def __init__(self, odometry: Odometry, path: SmoothPath) -> None:
        self._odometry = odometry
        self._path = path

    def driven(self, before: Frame, after: Frame, start: np.ndarray,
               draws: np.ndarray) -> List[Sample]:
        """Samples from `before`, where odometry is at `start`, to `after`; without the one at `before`."""
        error = _deviations(self._odometry, _true_motion(before, after)) * draws
        duration = after.stamp - before.stamp
        samples = []
        for time in self._ticks(0, duration)[1:]:
            now: Union[Frame, Pose] = after
            if time < duration:
                now = self._path.pose(before, before.stamp + time)
            motion = self._scaled(_true_motion(before, now)) + time / duration * error
            samples.append(self.sample(before, before.stamp + time, _moved(start, motion)))
        return samples

    def carried(self, before: Frame, after: Frame, start: np.ndarray, lead: int,
                tail: int) -> List[Sample]:
        """Samples over a jump, which odometry does not measure.

        It follows the path until the last exposure ends, stands still, and follows the path again from
        the start of the next exposure.
        """
        duration = after.stamp - before.stamp
        lead, tail = min(lead, duration // 2), min(tail, duration // 2)
        behind = self.about(before, start, 0, tail)
        rest = np.array(behind[-1][1:4]) if behind else start
        # The pose at the stamp: from where odometry stood still, by the motion since the exposure began.
        first = self._path.pose(after, after.stamp - lead)
        end = _moved(rest, self._scaled(_true_motion(first, after)))
        standing = self.sample(before, before.stamp + tail, rest)
        still = [standing._replace(stamp=before.stamp + time)
                 for time in self._ticks(0, duration)[1:-1] if tail < time < duration - lead]
        return (behind + still + self.about(after, end, -lead, 0)
                + [self.sample(after, after.stamp, end)])

    def about(self, frame: Frame, start: np.ndarray, begin: int, end: int) -> List[Sample]:
        """Samples without errors, `begin` to `end` ns from the stamp of `frame`, which is left out."""
        return [self.sample(frame, frame.stamp + time, _moved(start, self._scaled(_true_motion(
            frame, self._path.pose(frame, frame.stamp + time)))))
            for time in self._ticks(begin, end) if time != 0]

    def sample(self, frame: Frame, stamp: int, planar: np.ndarray) -> Sample:
        """The sample at `stamp`, with the robot's lean if odometry has it, on the stretch of `frame`."""
        sample = Sample(stamp, *planar)
        if not self._odometry.lean:
            return sample
        pose = self._path.pose(frame, stamp)
        return sample._replace(z=pose.z, roll=pose.roll, pitch=pose.pitch)

    def _scaled(self, motion: np.ndarray) -> np.ndarray:
        return np.array([self._odometry.scale, self._odometry.scale, 1.0]) * motion

    def _ticks(self, begin: int, end: int) -> List[int]:
        """`begin`, `end` and the ticks of odometry between them, in nanoseconds from a stamp."""
        rate = self._odometry.rate
        counts = range(int(begin * rate / 1e9), int(end * rate / 1e9) + 1)
        between = [round(count * 1e9 / rate) for count in counts]
        return [begin] + [time for time in between if begin < time < end] + [end] * (end > begin)


def _true_motion(before: Union[Frame, Pose], after: Union[Frame, Pose]) -> np.ndarray:
    """x, y and yaw of `after` in the frame of `before`, in the plane."""
    x, y = after.x - before.x, after.y - before.y
    cosine, sine = np.cos(before.yaw), np.sin(before.yaw)
    turn = np.arctan2(np.sin(after.yaw - before.yaw), np.cos(after.yaw - before.yaw))
    return np.array([cosine * x + sine * y, cosine * y - sine * x, turn])


def _deviations(odometry: Odometry, motion: np.ndarray) -> np.ndarray:
    distance, turn = np.hypot(motion[0], motion[1]), abs(motion[2])
    translation = np.hypot(odometry.translation_per_metre * distance,
                           odometry.translation_per_rotation * turn)
    rotation = np.hypot(odometry.rotation_per_rotation * turn,
                        odometry.rotation_per_metre * distance)
    return np.array([translation, translation, rotation])


def _moved(start: np.ndarray, motion: np.ndarray) -> np.ndarray:
    """x, y and yaw after a motion from `start`."""
    cosine, sine = np.cos(start[2]), np.sin(start[2])
    return start + [cosine * motion[0] - sine * motion[1],
                    sine * motion[0] + cosine * motion[1], motion[2]]
