"""The robot's path between the rows of the route: a smooth curve through their poses."""

from bisect import bisect_right
from typing import List, Sequence

import numpy as np

from omnitag.rendering.poses import Pose
from omnitag.rendering.route import Frame


class SmoothPath:
    """Natural cubic splines, twice differentiable, through the rows between the route's jumps.

    Beyond both ends of such a stretch the robot continues straight on with its velocity there.
    """

    def __init__(self, frames: Sequence[Frame]) -> None:
        firsts = [row for row, frame in enumerate(frames) if row == 0 or frame.jump]
        ends = firsts[1:] + [len(frames)]
        self._starts = [frames[first].stamp for first in firsts]
        self._pieces = [_Piece(frames[first:end]) for first, end in zip(firsts, ends)]

    def pose(self, frame: Frame, stamp: int) -> Pose:
        """Where the robot is at `stamp`, in nanoseconds, on the stretch of `frame`."""
        return self._pieces[bisect_right(self._starts, frame.stamp) - 1].pose(stamp)


class _Piece:
    """The path from one jump to the next."""

    def __init__(self, frames: Sequence[Frame]) -> None:
        self._start = frames[0].stamp
        self._knots = np.array([1e-9 * (frame.stamp - self._start) for frame in frames])
        poses = np.array([(f.x, f.y, f.yaw, f.z, f.roll, f.pitch) for f in frames], dtype=float)
        for angle in (2, 4, 5):
            poses[:, angle] = np.unwrap(poses[:, angle])
        self._values = poses
        self._bends = _second_derivatives(self._knots, poses)

    def pose(self, stamp: int) -> Pose:
        time = 1e-9 * (stamp - self._start)
        if len(self._knots) == 1:
            return Pose(*self._values[0])
        index = int(np.clip(np.searchsorted(self._knots, time, side="right") - 1,
                            0, len(self._knots) - 2))
        length = self._knots[index + 1] - self._knots[index]
        (before, after), (bend, next_bend) = (part[index:index + 2]
                                              for part in (self._values, self._bends))
        slope = (after - before) / length - length / 6.0 * (2.0 * bend + next_bend)
        if time < 0.0:
            return Pose(*(before + time * slope))
        if time > self._knots[-1]:
            end_slope = (after - before) / length + length / 6.0 * (bend + 2.0 * next_bend)
            return Pose(*(after + (time - self._knots[-1]) * end_slope))
        since = time - self._knots[index]
        return Pose(*(before + since * (slope + since * (
            0.5 * bend + since * (next_bend - bend) / (6.0 * length)))))


def _second_derivatives(knots: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Second derivatives of the spline at its knots, zero at both ends; a tridiagonal system."""
    bends: List[np.ndarray] = [np.zeros_like(values[0]) for _ in knots]
    steps = np.diff(knots)
    secants = np.diff(values, axis=0) / steps[:, None]
    diagonals: List[float] = []
    rights: List[np.ndarray] = []
    for i in range(1, len(knots) - 1):
        diagonal, right = 2.0 * (steps[i - 1] + steps[i]), 6.0 * (secants[i] - secants[i - 1])
        if diagonals:
            share = steps[i - 1] / diagonals[-1]
            diagonal, right = diagonal - share * steps[i - 1], right - share * rights[-1]
        diagonals.append(diagonal)
        rights.append(right)
    for i in range(len(knots) - 2, 0, -1):
        bends[i] = (rights[i - 1] - steps[i] * bends[i + 1]) / diagonals[i - 1]
    return np.array(bends)
