"""The figures of an evaluation as a table to read."""

import numpy as np

from omnitag.evaluation import (PAPER_MEAN_RANGE, PAPER_PERCENT_OF_RANGE, PAPER_POSITION_RMSE,
                                Evaluation)


def table(evaluation: Evaluation) -> str:
    """Lines of text: what was compared, the errors, and the paper's errors for comparison."""
    figures = evaluation.error_figures()
    seconds = (evaluation.stamps - evaluation.reference.stamps[0]) * 1e-9
    worst_heading = int(np.argmax(np.abs(evaluation.heading_errors)))
    lines = [
        _line("Frames", "with an estimate", "{} of {}".format(
            len(evaluation.stamps), len(evaluation.reference)),
            "{:.1f} %".format(100.0 * evaluation.matched_share)),
    ]
    if evaluation.unmatched_estimates:
        lines.append(_line("", "estimates without a reference",
                           str(evaluation.unmatched_estimates), "not compared"))
    lines += [
        "",
        _line("Position error", "RMSE", length(figures["position_rmse"])),
        _line("", "mean", length(figures["position_mean"])),
        _line("", "median", length(figures["position_median"])),
        _line("", "maximum", length(figures["position_max"]),
              "at {:.3f} s".format(seconds[evaluation.worst_frame])),
        "",
        _line("Heading error", "RMS", _degrees(figures["heading_rmse_deg"])),
        _line("", "maximum", _degrees(figures["heading_max_deg"]),
              "at {:.3f} s".format(seconds[worst_heading])),
    ]
    for name, errors in evaluation.standing_errors.items():
        suffix, show = ("", length) if name == "height" else ("_deg", _degrees)
        lines += [
            "",
            _line("{} error".format(name.capitalize()), "RMS",
                  show(figures[name + "_rmse" + suffix])),
            _line("", "maximum", show(figures[name + "_max" + suffix]),
                  "at {:.3f} s".format(seconds[int(np.argmax(np.abs(errors)))])),
        ]
    if evaluation.mean_range:
        percent = 100.0 * figures["position_rmse"] / evaluation.mean_range
        lines += [
            "",
            _line("Relative error", "", "here", "Fiala's paper"),
            _line("", "position RMSE", length(figures["position_rmse"]),
                  "{:g} units".format(PAPER_POSITION_RMSE)),
            _line("", "mean range to the markers used", length(evaluation.mean_range),
                  "{:g} units".format(PAPER_MEAN_RANGE)),
            _line("", "RMSE / mean range",
                  "{:.4f} %".format(percent), "{:g} %".format(PAPER_PERCENT_OF_RANGE)),
        ]
    return "\n".join(lines)


def length(metres: float) -> str:
    """A length in millimetres if it is short, otherwise in metres."""
    if metres < 0.1:
        return "{:.3f} mm".format(1e3 * metres)
    return "{:.3f} m".format(metres)


def _degrees(angle: float) -> str:
    return "{:.4f} deg".format(angle)


def _line(group: str, name: str, value: str, remark: str = "") -> str:
    return "{:<17}{:<31}{:>12}  {:>14}".format(group, name, value, remark).rstrip()
