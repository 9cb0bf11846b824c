"""Plots of an evaluation."""

import os
from typing import Callable, Dict, List, Optional, Sequence, Tuple

import matplotlib

matplotlib.use("Agg")

import numpy as np  # noqa: E402
from matplotlib import pyplot  # noqa: E402
from matplotlib.axes import Axes  # noqa: E402
from matplotlib.collections import LineCollection  # noqa: E402
from matplotlib.figure import Figure  # noqa: E402

from omnitag.detections import Detection  # noqa: E402
from omnitag.evaluation import Evaluation  # noqa: E402
from omnitag.marker_map import Marker, MarkerMap  # noqa: E402
from omnitag.report import length  # noqa: E402

# Okabe and Ito's palette, which is safe for all common forms of colour blindness.
BLUE = "#0072B2"
SKY = "#56B4E9"
ORANGE = "#E69F00"
VERMILION = "#D55E00"
INK = "#26323B"
GREY = "#8C979F"
PALE = "#D3D9DD"
ERROR_COLOURS = "viridis"

Drawing = Callable[[Evaluation, Optional[MarkerMap], List[Detection]], Figure]

GAP_PERIODS = 1.5  # in usual periods: between estimates further apart than this, some are missing

STYLE = {
    "figure.dpi": 110, "savefig.dpi": 150, "font.family": "DejaVu Sans", "font.size": 11,
    "axes.titlesize": 13, "axes.titleweight": "bold", "axes.labelcolor": INK,
    "axes.edgecolor": GREY, "axes.spines.top": False, "axes.spines.right": False,
    "axes.axisbelow": True, "axes.grid": True, "grid.color": PALE, "grid.linewidth": 0.6,
    "xtick.color": INK, "ytick.color": INK, "text.color": INK,
    "legend.edgecolor": "none", "legend.framealpha": 0.85, "legend.fontsize": 10,
}


def write_report(directory: str, evaluation: Evaluation, marker_map: Optional[MarkerMap] = None,
                 detections: Optional[List[Detection]] = None) -> List[str]:
    """Draw every plot that the data allow; returns their paths."""
    os.makedirs(directory, exist_ok=True)
    detections = detections or []
    figures: Dict[str, Drawing] = {"route.png": _route, "errors.png": _errors}
    if any(_is_fitted(detection) for detection in detections):
        figures["residuals.png"] = _residuals
    paths = []
    for name, draw in figures.items():
        with pyplot.rc_context(STYLE):
            figure = draw(evaluation, marker_map, detections)
            paths.append(os.path.join(directory, name))
            figure.savefig(paths[-1], facecolor="white")
            pyplot.close(figure)
    return paths


def _route(evaluation: Evaluation, marker_map: Optional[MarkerMap],
           detections: List[Detection]) -> Figure:
    """Top view of both routes, with the bearings of the worst frame."""
    figure = pyplot.figure(figsize=(14.0, 8.6), constrained_layout=True)
    columns = figure.add_gridspec(1, 2, width_ratios=(2.6, 1.0))
    view = figure.add_subplot(columns[0])
    side = columns[1].subgridspec(2, 1)
    unit, scale = _error_unit(evaluation)

    view.plot(*evaluation.reference.positions[:, :2].T, color=SKY, linewidth=5, alpha=0.55,
              solid_capstyle="round", label="true route", zorder=2)
    view.plot(*_broken_at_gaps(evaluation, evaluation.positions).T, color=INK, linewidth=0.8,
              zorder=4)
    points = view.scatter(*evaluation.positions.T, c=scale * evaluation.distances, s=26,
                          cmap=ERROR_COLOURS, edgecolors=INK, linewidths=0.5, zorder=5, vmin=0.0,
                          label="estimated poses")
    markers = () if marker_map is None else marker_map.markers
    _draw_worst_frame(view, evaluation, markers, detections)
    figure.colorbar(points, ax=view, location="bottom", shrink=0.5, aspect=40, pad=0.02,
                    label="position error [{}]".format(unit))
    for marker in markers:
        _draw_marker(view, marker)
    _draw_heading(view, evaluation)
    view.set_aspect("equal", adjustable="datalim")
    view.margins(0.08)
    view.set_title("Route in the map", loc="left")
    view.set(xlabel="x [m]", ylabel="y [m]")
    view.legend(loc="lower left", bbox_to_anchor=(0.28, 1.0), ncol=4, borderaxespad=0.3,
                handlelength=1.6, columnspacing=1.4)

    _draw_error_cloud(figure.add_subplot(side[0]), evaluation)
    _draw_histogram(figure.add_subplot(side[1]), evaluation)
    return figure


def _draw_marker(axes: Axes, marker: Marker) -> None:
    """A segment at its place, a tick along its outward normal, its name behind it."""
    right = marker.map_from_marker[:2, 0] * 0.5 * marker.size
    up = marker.map_from_marker[:2, 1] * 0.5 * marker.size
    # Seen from above, a marker that is rolled by a right angle extends along its y axis.
    half = right if np.hypot(*right) >= np.hypot(*up) else up
    centre, normal = marker.position[:2], marker.normal[:2]
    tip = centre + normal * max(0.12, 0.6 * marker.size)
    axes.plot(*zip(centre - half, centre + half), color=INK, linewidth=4.5,
              solid_capstyle="butt", zorder=6)
    axes.plot(*zip(centre, tip), color=INK, linewidth=1.3, zorder=6)
    steep = np.hypot(*normal) < 0.3
    behind = np.array([0.0, -1.0]) if steep else -normal / np.hypot(*normal)
    # The name of a marker that faces sideways must not cross it.
    alignment = "center" if abs(behind[0]) < 0.3 else "left" if behind[0] > 0 else "right"
    axes.annotate(marker.label, centre, xytext=(9.0 * behind[0], 13.0 * behind[1]),
                  textcoords="offset points", ha=alignment, va="center", fontsize=9.5, zorder=7)


def _draw_worst_frame(axes: Axes, evaluation: Evaluation, markers: Sequence[Marker],
                      detections: List[Detection]) -> None:
    """A ring around the largest error, and the bearings measured there, up to their markers."""
    frame = evaluation.worst_frame
    used = [detection for detection in detections
            if detection.accepted and detection.stamp == evaluation.stamps[frame]]
    position = evaluation.positions[frame]
    segments = []
    for detection in used:
        to_marker = markers[detection.map_entry].position[:2] - position
        direction = evaluation.headings[frame] + detection.bearing
        if np.isnan(direction):
            segments.append((position, position + to_marker))
        else:
            along = np.array([np.cos(direction), np.sin(direction)])
            segments.append((position, position + np.hypot(*to_marker) * along))
    axes.scatter(*position, s=190, facecolors="none", edgecolors=VERMILION, linewidths=2.2,
                 zorder=8, label="largest error, {}".format(
                     length(evaluation.distances[frame])))
    if segments:
        axes.add_collection(LineCollection(segments, colors=ORANGE, linewidths=1.5, zorder=3,
                                           label="its bearings"))


def _draw_heading(axes: Axes, evaluation: Evaluation) -> None:
    """An arrow at the start of the route."""
    x, y = evaluation.reference.positions[0, :2]
    yaw = evaluation.reference.yaw[0]
    axes.annotate("", (x, y), xytext=(34 * np.cos(yaw), 34 * np.sin(yaw)),
                  textcoords="offset points", zorder=7,
                  arrowprops={"arrowstyle": "<|-", "color": BLUE, "linewidth": 2.0,
                              "shrinkA": 0.0, "shrinkB": 4.0})
    axes.annotate("start", (x, y), xytext=(-20 * np.cos(yaw), -20 * np.sin(yaw)),
                  textcoords="offset points", color=BLUE, ha="center", va="center",
                  fontweight="bold", zorder=7)


def _draw_error_cloud(axes: Axes, evaluation: Evaluation) -> None:
    """Position errors from above, with the RMSE as a circle."""
    unit, scale = _error_unit(evaluation)
    rmse = scale * evaluation.error_figures()["position_rmse"]
    reach = 1.12 * scale * max(np.max(evaluation.distances), 1e-9)
    axes.scatter(*(scale * evaluation.position_errors.T), c=scale * evaluation.distances, s=26,
                 cmap=ERROR_COLOURS, edgecolors=INK, linewidths=0.5, vmin=0.0, zorder=3)
    turn = np.linspace(0.0, 2.0 * np.pi, 181)
    axes.plot(rmse * np.cos(turn), rmse * np.sin(turn), color=VERMILION, linewidth=1.8, zorder=4,
              label="RMSE {:.3g} {}".format(rmse, unit))
    axes.axhline(0.0, color=GREY, linewidth=0.8)
    axes.axvline(0.0, color=GREY, linewidth=0.8)
    axes.set_title("Position error", loc="left")
    axes.set(xlabel="x error [{}]".format(unit),
             ylabel="y error [{}]".format(unit), xlim=(-reach, reach), ylim=(-reach, reach),
             aspect="equal")
    axes.legend(loc="upper right")


def _draw_histogram(axes: Axes, evaluation: Evaluation) -> None:
    unit, scale = _error_unit(evaluation)
    axes.hist(scale * evaluation.distances, bins="auto", color=SKY, edgecolor="white")
    for name, colour, style in (("median", BLUE, "--"), ("rmse", VERMILION, "-")):
        value = evaluation.error_figures()["position_" + name]
        axes.axvline(scale * value, color=colour, linestyle=style, linewidth=1.8,
                     label="{} {}".format("RMSE" if name == "rmse" else name, length(value)))
    axes.set_title("Error distribution", loc="left")
    axes.set(xlabel="position error [{}]".format(unit), ylabel="frames")
    axes.set_xlim(left=0.0)
    axes.margins(y=0.25)  # room for the legend
    axes.yaxis.get_major_locator().set_params(integer=True)
    axes.legend(loc="upper right")


def _errors(evaluation: Evaluation, _: Optional[MarkerMap],
            detections: List[Detection]) -> Figure:
    """The errors, and the number of markers used, over time."""
    standing = evaluation.standing_errors
    rows = 2 + len(standing) + (1 if detections else 0)
    figure, axes = pyplot.subplots(rows, 1, sharex=True, figsize=(12.0, 2.9 * rows),
                                   constrained_layout=True, squeeze=False)
    axes = axes[:, 0]
    unit, scale = _error_unit(evaluation)
    begin = evaluation.reference.stamps[0]
    time = _broken_at_gaps(evaluation, (evaluation.stamps - begin) * 1e-9)
    distances = _broken_at_gaps(evaluation, scale * evaluation.distances)
    headings = _broken_at_gaps(evaluation, np.degrees(evaluation.heading_errors))
    figures = evaluation.error_figures()

    axes[0].fill_between(time, distances, color=SKY, alpha=0.35, linewidth=0)
    axes[0].plot(time, distances, color=BLUE, marker=".", linewidth=1.3)
    axes[0].axhline(scale * figures["position_rmse"], color=VERMILION, linestyle="--",
                    label="RMSE " + length(figures["position_rmse"]))
    axes[0].set_title("Position error", loc="left")
    axes[0].set_ylabel("[{}]".format(unit))
    axes[0].set_ylim(bottom=0.0)

    _draw_signed_errors(axes[1], "Heading", time, headings, "°")
    for axis, (name, errors) in zip(axes[2:], standing.items()):
        of_angle = name != "height"
        _draw_signed_errors(
            axis, name.capitalize(), time,
            _broken_at_gaps(evaluation, np.degrees(errors) if of_angle else 1e3 * errors),
            "°" if of_angle else " mm")

    if detections:
        stamps, counts = np.unique([detection.stamp for detection in detections
                                    if detection.accepted], return_counts=True)
        width = 0.8 * np.median(np.diff(stamps)) * 1e-9 if len(stamps) > 1 else 0.1
        mean = "mean {:.1f}".format(float(np.mean(counts))) if len(counts) else None
        axes[-1].bar((stamps - begin) * 1e-9, counts, width=width, color=SKY, label=mean)
        axes[-1].set_title("Markers used", loc="left")
        axes[-1].set_ylabel("per frame")
        axes[-1].yaxis.get_major_locator().set_params(integer=True)

    _shade_gaps(axes, evaluation)
    for axis in axes:
        if axis.get_legend_handles_labels()[0]:
            axis.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncol=3, borderaxespad=0.2)
    axes[-1].set_xlabel("time since the reference begins [s]")
    axes[-1].margins(x=0.01)
    return figure


def _draw_signed_errors(axes: Axes, name: str, time: np.ndarray, errors: np.ndarray,
                        unit: str) -> None:
    """Errors over time, with their RMS as a band about zero; NaN stands for missing estimates."""
    rms = np.sqrt(np.nanmean(np.square(errors)))
    axes.axhspan(-rms, rms, color=ORANGE, alpha=0.22, linewidth=0,
                 label="RMS {:.4f}{}".format(rms, unit))
    axes.axhline(0.0, color=GREY, linewidth=0.8)
    axes.plot(time, errors, color=BLUE, marker=".", linewidth=1.3)
    axes.set_title("{} error".format(name), loc="left")
    axes.set_ylabel("[{}]".format(unit.strip()))


def _shade_gaps(axes: Sequence[Axes], evaluation: Evaluation) -> None:
    """Shade the times without estimates, also before the first and after the last."""
    period = _period(evaluation)
    reference = evaluation.reference.stamps
    ends = np.concatenate([[reference[0] - period], evaluation.stamps, [reference[-1] + period]])
    time = (ends - reference[0]) * 1e-9
    half = 0.5e-9 * period
    gaps = np.nonzero(np.diff(ends) > GAP_PERIODS * period)[0]
    for axis in axes:
        for gap in gaps:
            axis.axvspan(time[gap] + half, time[gap + 1] - half, color=PALE, alpha=0.6, linewidth=0,
                         zorder=0, label="no estimate" if gap == gaps[0] else None)


def _broken_at_gaps(evaluation: Evaluation, values: np.ndarray) -> np.ndarray:
    """`values`, one for each matched estimate, with NaN inserted at the gaps between estimates."""
    gaps = np.nonzero(np.diff(evaluation.stamps) > GAP_PERIODS * _period(evaluation))[0] + 1
    return np.insert(values, gaps, np.nan, axis=0)


def _period(evaluation: Evaluation) -> float:
    """The usual time between estimates, in ns."""
    stamps = evaluation.stamps if len(evaluation.stamps) > 1 else evaluation.reference.stamps
    return float(np.median(np.diff(stamps))) if len(stamps) > 1 else 1e9


def _residuals(_evaluation: Evaluation, _: Optional[MarkerMap],
               detections: List[Detection]) -> Figure:
    """Where markers were seen in the panorama, and how well their corners fit the pose."""
    figure, (image, histogram) = pyplot.subplots(
        1, 2, figsize=(13.0, 6.2), constrained_layout=True, gridspec_kw={"width_ratios": (1.3, 1)})
    used = [detection for detection in detections if _is_fitted(detection)]
    rejected = [detection for detection in detections
                if not detection.accepted and not np.isnan(detection.corners).any()]
    residuals = np.array([detection.residual for detection in used])
    if rejected:
        image.scatter(*np.mean([detection.corners for detection in rejected], axis=1).T,
                      marker="x", color=VERMILION, s=34, linewidths=1.3,
                      label="rejected: {}".format(len(rejected)))
    limit = np.percentile(residuals, 98)
    points = image.scatter(*np.mean([detection.corners for detection in used], axis=1).T,
                           c=residuals, s=22, cmap=ERROR_COLOURS, vmin=0.0, vmax=limit,
                           edgecolors=INK, linewidths=0.3, label="used: {}".format(len(used)))
    figure.colorbar(points, ax=image, shrink=0.8, extend="max", label="residual [px]")
    histogram.hist(residuals, bins="auto", color=SKY, edgecolor="white")
    for share, colour, style in ((50, BLUE, "--"), (95, VERMILION, "-")):
        value = np.percentile(residuals, share)
        histogram.axvline(value, color=colour, linestyle=style, linewidth=1.8,
                          label="{} {:.3f} px".format(
                              "median" if share == 50 else "95th percentile", value))
    histogram.legend(loc="upper right")
    image.set_title("Markers in the image", loc="left")
    image.set(xlabel="u [px]", ylabel="v [px]", aspect="equal")
    image.invert_yaxis()
    image.margins(0.08)
    image.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncol=2, borderaxespad=0.2)
    histogram.set_title("Residual of the markers used", loc="left")
    histogram.set(ylabel="markers", xlabel="root mean square of a marker's corners [px]")
    histogram.set_xlim(left=0.0)
    histogram.margins(y=0.25)  # room for the legend
    return figure


def _is_fitted(detection: Detection) -> bool:
    return (detection.accepted and not np.isnan(detection.residual)
            and not np.isnan(detection.corners).any())


def _error_unit(evaluation: Evaluation) -> Tuple[str, float]:
    """Millimetres for small errors, otherwise metres: (its name, units per metre)."""
    return ("mm", 1e3) if np.max(evaluation.distances) < 0.1 else ("m", 1.0)
