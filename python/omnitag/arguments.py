"""Readers of command line arguments, for argparse's `type`."""

import argparse
import math
import re
from typing import Callable


def integer_between(lower: int, upper: int) -> Callable[[str], int]:
    """A reader of integers within these bounds."""
    def read(text: str) -> int:
        if not re.fullmatch(r"\d+", text) or not lower <= int(text) <= upper:
            raise argparse.ArgumentTypeError(
                f"expected an integer from {lower} to {upper}, found '{text}'")
        return int(text)
    return read


def not_negative(text: str) -> float:
    """A finite number of at least 0."""
    number = _real(text)
    if not 0.0 <= number < math.inf:
        raise argparse.ArgumentTypeError(f"expected a number of at least 0, found '{text}'")
    return number


def positive(text: str) -> float:
    """A finite number above 0."""
    number = _real(text)
    if not 0.0 < number < math.inf:
        raise argparse.ArgumentTypeError(f"expected a positive number, found '{text}'")
    return number


def real(text: str) -> float:
    """A finite number."""
    number = _real(text)
    if not math.isfinite(number):
        raise argparse.ArgumentTypeError(f"expected a finite number, found '{text}'")
    return number


def _real(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return math.nan
