"""ARToolKit's pattern files (.patt)."""

import math
import re
from dataclasses import dataclass
from typing import List, Optional

import numpy as np

from omnitag.command_line import InputError
from omnitag.yaml_file import read_text

SMALLEST_SIDE, LARGEST_SIDE = 4, 64  # cells
LEAST_CONTRAST = 5.0  # grey levels, standard deviation

# The luma of Rec. 601: of blue, green and red.
_LUMA = np.array([0.114, 0.587, 0.299])
_NUMBER = re.compile(r"[0-9]+(\.[0-9]*)?|\.[0-9]+")
_TURNS = 4


@dataclass(frozen=True)
class Pattern:
    """The picture within a marker's border, upright."""

    colours: np.ndarray
    """(3, n, n) from 0 to 255: blue, green and red; row 0 is the upper edge."""

    @property
    def side(self) -> int:
        """Its cells in each row and column."""
        return self.colours.shape[1]

    @property
    def luma(self) -> np.ndarray:
        """(n, n): its grey levels from 0 (black) to 255 (white)."""
        return np.tensordot(_LUMA, self.colours, axes=1)

    @property
    def contrast(self) -> float:
        """Standard deviation of its grey levels."""
        return float(self.luma.std())


def read_pattern(path: str) -> Pattern:
    """The first block of a pattern file.

    Raises InputError naming file and line if it cannot be read, is not four blocks of three planes of
    n x n numbers from 0 to 255, or has hardly any contrast.
    """
    numbers: List[float] = []
    for index, line in enumerate(read_text(path).splitlines()):
        for word in line.split():
            number = _level(word)
            if number is None:
                raise InputError("{}:{}: expected a number from 0 to 255, found '{}'".format(
                    path, index + 1, word))
            numbers.append(number)
    side = math.isqrt(len(numbers) // (_TURNS * 3))
    if not SMALLEST_SIDE <= side <= LARGEST_SIDE or len(numbers) != _TURNS * 3 * side * side:
        raise InputError("{}: expected 12 N x N numbers with N from {} to {} (3072 for N = 16), "
                         "found {}".format(path, SMALLEST_SIDE, LARGEST_SIDE, len(numbers)))
    pattern = Pattern(np.array(numbers).reshape(_TURNS, 3, side, side)[0])
    if pattern.contrast < LEAST_CONTRAST:
        raise InputError("{}: expected a picture with contrast: grey levels with a standard deviation "
                         "of at least {:g}, found {:.1f}".format(path, LEAST_CONTRAST,
                                                                 pattern.contrast))
    return pattern


def pattern_text(pattern: Pattern) -> str:
    """The text of a pattern file, as ARToolKit writes it; levels are rounded to integers.

    Each block is the one before turned counter-clockwise by 90 degrees.
    """
    colours = np.rint(pattern.colours).astype(int)
    blocks = [np.rot90(colours, turn, axes=(1, 2)) for turn in range(_TURNS)]
    return "\n".join("".join("".join("{:4d}".format(level) for level in row) + "\n"
                             for row in block.reshape(-1, pattern.side)) for block in blocks) + "\n"


def _level(word: str) -> Optional[float]:
    number = float(word) if _NUMBER.fullmatch(word) else math.nan
    return number if 0.0 <= number <= 255.0 else None
