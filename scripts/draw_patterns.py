#!/usr/bin/env python3
"""Draws the package's own ARToolKit patterns into a folder, and prints how alike they are.

Bold glyphs whose features are about three cells wide, so that they can be told apart from afar.

    scripts/draw_patterns.py maps/patterns
"""

import argparse
import os
import sys
from typing import Dict, Tuple

sys.path.append(os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "python"))

import cv2  # noqa: E402
import numpy as np  # noqa: E402
from omnitag.pattern_file import Pattern, pattern_text  # noqa: E402
from omnitag.pattern_likeness import likeness, likeness_to_itself  # noqa: E402

SIDE = 16  # cells
FINENESS = 32  # pixels along a cell
BLACK, WHITE = 0.0, 255.0


class Canvas:
    """A square picture; x to the right and y up, from -1 to 1."""

    def __init__(self, ground: float) -> None:
        width = SIDE * FINENESS
        self._pixels = np.full((width, width), ground)
        steps = (np.arange(width) + 0.5) * 2.0 / width - 1.0
        self._x, self._y = np.meshgrid(steps, -steps)

    def polygon(self, grey: float, *corners: Tuple[float, float]) -> "Canvas":
        """A polygon, which may be concave."""
        ends = np.array(corners)
        inside = np.zeros(self._pixels.shape, dtype=bool)
        for (x0, y0), (x1, y1) in zip(ends, np.roll(ends, -1, axis=0)):
            if y0 != y1:
                crosses = (y0 > self._y) != (y1 > self._y)
                inside ^= crosses & (self._x < x0 + (self._y - y0) * (x1 - x0) / (y1 - y0))
        self._pixels[inside] = grey
        return self

    def box(self, grey: float, left: float, bottom: float, right: float, top: float) -> "Canvas":
        """An upright rectangle."""
        return self.polygon(grey, (left, bottom), (right, bottom), (right, top), (left, top))

    def disc(self, grey: float, x: float, y: float, radius: float) -> "Canvas":
        """A disc around (x, y)."""
        self._pixels[np.hypot(self._x - x, self._y - y) < radius] = grey
        return self

    def pattern(self) -> Pattern:
        """The picture, averaged over cells."""
        cells = cv2.resize(self._pixels, (SIDE, SIDE), interpolation=cv2.INTER_AREA)
        return Pattern(np.repeat(np.rint(cells)[None], 3, axis=0))


def glyphs() -> Dict[str, Pattern]:
    """The patterns by name."""
    on_white = {
        "crown": Canvas(WHITE).polygon(
            BLACK, (-0.75, -0.3), (0.75, -0.3), (0.95, 0.8), (0.4, 0.1), (0.0, 0.9), (-0.4, 0.1),
            (-0.95, 0.8)).box(BLACK, -0.75, -0.9, 0.75, -0.6).box(WHITE, 0.1, -0.3, 0.5, 0.0),
        "flag": Canvas(WHITE).box(BLACK, -0.85, -0.9, -0.55, 0.9).polygon(
            BLACK, (-0.55, 0.9), (0.9, 0.45), (-0.55, 0.0)),
        "plough": Canvas(WHITE).polygon(BLACK, (-0.9, 0.9), (0.2, 0.9), (-0.9, -0.2)).polygon(
            BLACK, (0.9, -0.9), (0.3, -0.9), (0.9, -0.3)),
        "snake": Canvas(WHITE).box(BLACK, -0.9, 0.55, 0.5, 0.9).box(BLACK, 0.1, 0.0, 0.5, 0.9).box(
            BLACK, -0.9, -0.25, 0.5, 0.1).box(BLACK, -0.9, -0.9, -0.5, 0.1).box(
            BLACK, -0.9, -0.9, 0.9, -0.6),
        "hammer": Canvas(WHITE).box(BLACK, -0.9, 0.3, 0.55, 0.85).box(
            BLACK, -0.35, -0.95, 0.0, 0.3).polygon(BLACK, (0.55, 0.85), (0.95, 0.3), (0.55, 0.3)),
        "wave": Canvas(WHITE).polygon(
            BLACK, (-0.95, 0.2), (-0.5, 0.7), (0.0, 0.2), (0.5, 0.7), (0.95, 0.2), (0.95, -0.2),
            (0.5, 0.3), (0.0, -0.2), (-0.5, 0.3), (-0.95, -0.2)).box(BLACK, -0.95, -0.9, 0.2, -0.5),
    }
    on_black = {
        "moon": Canvas(BLACK).disc(WHITE, 0.4, 0.4, 0.42),
        "road": Canvas(BLACK).polygon(WHITE, (-0.2, 0.95), (0.2, 0.95), (0.95, -0.95),
                                      (-0.95, -0.95)).box(BLACK, -0.12, -0.9, 0.12, 0.2),
        "steps": Canvas(BLACK).box(WHITE, -0.8, 0.4, 0.8, 0.75).box(
            WHITE, -0.8, -0.2, 0.3, 0.15).box(WHITE, -0.8, -0.8, -0.2, -0.45),
    }
    return {name: canvas.pattern() for name, canvas in sorted({**on_white, **on_black}.items())}


def table(patterns: Dict[str, Pattern]) -> str:
    """The highest correlation of each two over four turns, and of each with itself turned."""
    lines = [" " * 8 + "".join("{:>8}".format(name) for name in patterns)]
    for name, pattern in patterns.items():
        found = [likeness_to_itself(pattern) if other is pattern else likeness(pattern, other)
                 for other in patterns.values()]
        lines.append("{:<8}".format(name) + "".join("{:8.2f}".format(each.correlation)
                                                    for each in found))
    return "\n".join(lines)


def main() -> None:
    """Write the files, print the table."""
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", metavar="FOLDER", help="where to write the .patt files")
    folder = parser.parse_args().folder
    os.makedirs(folder, exist_ok=True)
    patterns = glyphs()
    for name, pattern in patterns.items():
        with open(os.path.join(folder, name + ".patt"), "w", encoding="utf-8") as file:
            file.write(pattern_text(pattern))
    print(table(patterns))


if __name__ == "__main__":
    main()
