"""A line of known length, to check the scale of a print."""

import numpy as np
from matplotlib.axes import Axes

from omnitag.printing.paper import points

RULER_LENGTH = 100.0  # mm


def draw_ruler(axes: Axes, left: float, y: float) -> None:
    """A scale to check with a ruler, with a tick every 10 mm; the place of its left end in mm."""
    axes.plot([left, left + RULER_LENGTH], [y, y], color="black", linewidth=0.5)
    for x in np.arange(0.0, RULER_LENGTH + 1.0, 10.0):
        axes.plot([left + x, left + x], [y, y + (4.0 if x % 50.0 == 0.0 else 2.5)], color="black",
                  linewidth=0.5)
    axes.text(left + 0.5 * RULER_LENGTH, y - 1.2, "this line is {:g} mm long".format(RULER_LENGTH),
              fontsize=points(2.6), color="0.25", ha="center", va="top")
