"""How alike two patterns are."""

from typing import NamedTuple

import numpy as np

from omnitag.pattern_file import Pattern

TOO_ALIKE = 0.5
"""ARToolKit takes a reading for a pattern from this correlation on."""


FEW_PARTS = 10.0
"""In a search, the localizer asks of a picture with so few independent parts for a correlation of 0.92."""


class Likeness(NamedTuple):
    """The normalized correlation of two patterns, and the turn at which they are most alike."""

    correlation: float  # -1 to 1: 1 if they are the same but for brightness and contrast
    degrees: int  # counter-clockwise, of the second


def likeness(pattern: Pattern, other: Pattern) -> Likeness:
    """The highest over four turns of `other`."""
    return max(_turned(pattern, other, turn) for turn in range(4))


def likeness_to_itself(pattern: Pattern) -> Likeness:
    """The highest over the three turns by 90, 180 and 270 degrees."""
    return max(_turned(pattern, pattern, turn) for turn in (1, 2, 3))


def independent_parts(pattern: Pattern) -> float:
    """In how many independent ways pictures of the pattern's spectrum vary.

    With n of them, the correlation of a random one with the pattern has the variance 1 / n. Few
    mean that chance easily brings about something alike.
    """
    spectrum = np.abs(np.fft.fft2(pattern.luma - pattern.luma.mean())) ** 2
    return float(spectrum.sum() ** 2 / (spectrum ** 2).sum())


def _turned(pattern: Pattern, other: Pattern, turn: int) -> Likeness:
    side = max(pattern.side, other.side)
    a, b = (_standardized(each, side) for each in (pattern, other))
    return Likeness(float(np.mean(a * np.rot90(b, turn))), 90 * turn)


def _standardized(pattern: Pattern, side: int) -> np.ndarray:
    """(side, side) with a mean of 0 and a variance of 1."""
    ends = np.arange(side + 1)[:, None] / side
    own = np.arange(pattern.side + 1)[None, :] / pattern.side
    # The share of each of these cells that each cell of the pattern covers.
    overlap = np.minimum(ends[1:], own[:, 1:]) - np.maximum(ends[:-1], own[:, :-1])
    shares = side * np.maximum(overlap, 0.0)
    greys = shares @ pattern.luma @ shares.T
    return (greys - greys.mean()) / greys.std()
