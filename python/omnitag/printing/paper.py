"""Sizes of paper, and blank pages."""

from typing import Dict, Optional, Tuple

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from omnitag.command_line import InputError

MM_PER_INCH = 25.4
MARGIN = 8.0  # mm, what printers leave blank

# Width and height in mm, upright, by increasing area.
_ISO_A: Dict[str, Tuple[float, float]] = {
    "a6": (105.0, 148.0), "a5": (148.0, 210.0), "a4": (210.0, 297.0), "a3": (297.0, 420.0),
    "a2": (420.0, 594.0), "a1": (594.0, 841.0), "a0": (841.0, 1189.0),
}
_ISO_B: Dict[str, Tuple[float, float]] = {
    "b5": (176.0, 250.0), "b4": (250.0, 353.0), "b3": (353.0, 500.0), "b2": (500.0, 707.0),
    "b1": (707.0, 1000.0), "b0": (1000.0, 1414.0),
}
_US: Dict[str, Tuple[float, float]] = {
    "letter": (215.9, 279.4), "legal": (215.9, 355.6), "tabloid": (279.4, 431.8),
    "ansi_c": (431.8, 558.8), "ansi_d": (558.8, 863.6), "ansi_e": (863.6, 1117.6),
}
_US_ARCH: Dict[str, Tuple[float, float]] = {
    "arch_a": (228.6, 304.8), "arch_b": (304.8, 457.2), "arch_c": (457.2, 609.6),
    "arch_d": (609.6, 914.4), "arch_e1": (762.0, 1066.8), "arch_e": (914.4, 1219.2),
}
_SERIES = (_ISO_A, _ISO_B, _US, _US_ARCH)
PAPERS = {name: size for series in _SERIES for name, size in series.items()}


def page_size(least: Tuple[float, float], paper: str, what: str,
              turned: bool = False) -> Tuple[float, float]:
    """Width and height in mm of a page that holds `least`; the paper `fit` is exactly that size.

    `turned`: the paper may also lie on its side. Raises InputError, whose message begins with `what`, if
    the paper is too small.
    """
    if paper == "fit":
        return least
    page = fitting_page(least, paper, turned)
    if page:
        return page
    alike = next(series for series in _SERIES if paper in series)
    enough = next((name for name in alike if fitting_page(least, name, turned)), "fit")
    (width, height), (paper_width, paper_height) = least, PAPERS[paper]
    raise InputError(
        "{} needs {:.0f} x {:.0f} mm of paper, {} has {:g} x {:g}; the smallest paper that fits is "
        "{}, and --poster cuts it over several sheets".format(
            what, width, height, paper, paper_width, paper_height, enough))


def fitting_page(least: Tuple[float, float], paper: str,
                 turned: bool = False) -> Optional[Tuple[float, float]]:
    """The paper's width and height in mm if it holds `least`, else None.

    `turned`: the paper may also lie on its side.
    """
    width, height = PAPERS[paper]
    sides = [(width, height), (height, width)] if turned else [(width, height)]
    return next((size for size in sides if size[0] >= least[0] and size[1] >= least[1]), None)


def blank_page(size: Tuple[float, float]) -> Tuple[Figure, Axes]:
    """A page of that width and height, and its axes in millimetres from its lower left corner."""
    width, height = size
    figure = Figure(figsize=(width / MM_PER_INCH, height / MM_PER_INCH))
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set(xlim=(0.0, width), ylim=(0.0, height))
    axes.set_axis_off()
    return figure, axes


def points(millimetres: float) -> float:
    """The font size whose letters are about this high."""
    return millimetres / MM_PER_INCH * 72.0 * 1.3
