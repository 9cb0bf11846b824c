"""Mirror profiles: surfaces of revolution about the optical axis."""

from typing import NamedTuple, Sequence, Tuple, Union

import numpy as np


class ConicMirror(NamedTuple):
    """The sag formula of optical design: a conic, plus even terms a4, a6, ... if it is aspheric."""

    apex_distance: float
    """Metres from the pinhole to the apex, along the axis."""

    rim_radius: float
    """Metres from the axis to the mirror's edge."""

    radius_of_curvature: float
    """Metres, at the apex."""

    conic_constant: float
    """0: sphere, -1: paraboloid, below -1: hyperboloid."""

    coefficients: Tuple[float, ...] = ()
    """a4, a6, ... in m^-3, m^-5, ..."""

    def sag(self, rho: Union[float, np.ndarray]) -> np.ndarray:
        """Metres along the axis from the apex to the surface at `rho` metres off the axis.

        NaN if the conic does not reach that far.
        """
        curvature = 1.0 / self.radius_of_curvature
        squared = np.square(np.asarray(rho, dtype=float))
        with np.errstate(invalid="ignore"):
            root = np.sqrt(1.0 - (1.0 + self.conic_constant) * curvature**2 * squared)
        sag = curvature * squared / (1.0 + root)
        for index, coefficient in enumerate(self.coefficients):
            sag = sag + coefficient * squared ** (index + 2)
        return sag


class TabulatedMirror(NamedTuple):
    """Cubic spline through measured samples; the outermost two pieces are one cubic (not-a-knot).

    If the table begins on the axis, the profile is even in rho, hence level there; its knots are the
    samples and their reflections. Otherwise the condition holds at both ends of the table, and the
    outer cubics continue beyond it.
    """

    apex_distance: float
    """Metres from the pinhole to the apex, along the axis."""

    rim_radius: float
    """Metres from the axis to the mirror's edge."""

    samples: Tuple[Tuple[float, float], ...]
    """(rho, sag) in metres, with increasing rho >= 0."""

    def sag(self, rho: Union[float, np.ndarray]) -> np.ndarray:
        """Metres along the axis from the apex to the surface at `rho` metres off the axis."""
        rho = np.asarray(rho, dtype=float)
        start, cubic, jumps = self.truncated_powers()
        sag = np.polyval(cubic[::-1], rho - start)
        for knot, jump in jumps:
            sag = sag + jump * np.maximum(rho - knot, 0.0) ** 3
        return sag

    def truncated_powers(self) -> Tuple[float, np.ndarray, Sequence[Tuple[float, float]]]:
        """The spline for rho >= 0 as one cubic, plus a cubic term that starts at each knot.

        Returns the first sample's rho, the cubic's coefficients in (rho - first), lowest order
        first, and (knot, coefficient) for the knots beyond the first sample.
        """
        table = np.array(self.samples)
        if table[0, 0] == 0.0:
            table = np.vstack([table[:0:-1] * [-1.0, 1.0], table])
        knots, values = table.T
        slopes = _spline_slopes(knots, values)

        first = int(np.searchsorted(knots, self.samples[0][0]))
        steps = np.diff(knots)
        secants = np.diff(values) / steps
        third_order = (slopes[:-1] + slopes[1:] - 2.0 * secants) / steps**2
        second_order = (3.0 * secants - 2.0 * slopes[:-1] - slopes[1:]) / steps
        cubic = np.array(
            [values[first], slopes[first], second_order[first], third_order[first]]
        )
        jumps = [
            (float(knots[i]), float(third_order[i] - third_order[i - 1]))
            for i in range(first + 1, len(steps))
        ]
        return float(knots[first]), cubic, jumps


def _spline_slopes(knots: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Slopes at the knots of the twice differentiable cubic spline, not-a-knot at both ends."""
    steps = np.diff(knots)
    secants = np.diff(values) / steps
    size = len(knots)
    matrix = np.zeros((size, size))
    right = np.zeros(size)
    for i in range(1, size - 1):
        before, after = steps[i - 1], steps[i]
        matrix[i, i - 1:i + 2] = after, 2.0 * (before + after), before
        right[i] = 3.0 * (after * secants[i - 1] + before * secants[i])
    for row, (i, j) in ((0, (0, 1)), (size - 1, (size - 3, size - 2))):
        matrix[row, i:i + 3] = (
            steps[j] ** 2, steps[j] ** 2 - steps[i] ** 2, -steps[i] ** 2,
        )
        right[row] = 2.0 * (steps[j] ** 2 * secants[i] - steps[i] ** 2 * secants[j])
    return np.linalg.solve(matrix, right)
