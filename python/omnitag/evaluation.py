"""Absolute trajectory error, without alignment: both trajectories are in the map's frame."""

from dataclasses import dataclass
from typing import Dict, List, Optional, Tuple, Union

import numpy as np

from omnitag.command_line import InputError
from omnitag.detections import Detection
from omnitag.trajectory import Trajectory, format_stamp

# Fiala, "ARToolkit Applied to Panoramic Vision for Robot Navigation", Section 5.
PAPER_POSITION_RMSE = 0.54  # the paper's units
PAPER_MEAN_RANGE = 70.0  # the paper's units
PAPER_PERCENT_OF_RANGE = 0.8  # as printed there

# Only for an estimate that is not restricted to the floor.
STANDING_FIGURES = ("height_rmse", "height_max", "roll_rmse_deg", "roll_max_deg",
                    "pitch_rmse_deg", "pitch_max_deg")


@dataclass(frozen=True)
class Evaluation:
    """Errors of the estimates that match a frame of the reference, in order of time."""

    reference: Trajectory  # all of it
    stamps: np.ndarray  # (n,) int64 ns, of the matched estimates
    reference_indices: np.ndarray  # (n,) the frame of the reference that each matches
    positions: np.ndarray  # (n, 2) m, estimated
    headings: np.ndarray  # (n,) rad, estimated
    position_errors: np.ndarray  # (n, 2) m, estimate minus reference, in the map
    heading_errors: np.ndarray  # (n,) rad, estimate minus reference, in [-pi, pi]
    # The errors of z (m), roll and pitch (rad) by name, (n,) each; empty if the estimate is
    # restricted to the floor.
    standing_errors: Dict[str, np.ndarray]
    unmatched_estimates: int
    mean_range: Optional[float]  # m; None if it is not known that a marker was used

    @property
    def distances(self) -> np.ndarray:
        """(n,) m: the length of each position error."""
        return np.hypot(*self.position_errors.T)

    @property
    def worst_frame(self) -> int:
        """The index of the largest position error."""
        return int(np.argmax(self.distances))

    @property
    def matched_share(self) -> float:
        """The share of the reference's frames that have an estimate, 0 to 1."""
        return len(self.stamps) / len(self.reference)

    def error_figures(self) -> Dict[str, float]:
        """Figures of the errors by name, lengths in m; includes STANDING_FIGURES if they are known."""
        distances = self.distances
        figures = {
            "position_rmse": _root_mean_square(distances),
            "position_mean": float(np.mean(distances)),
            "position_median": float(np.median(distances)),
            "position_max": float(np.max(distances)),
        }
        for name, errors in (("heading", self.heading_errors), *self.standing_errors.items()):
            values, suffix = (errors, "") if name == "height" else (np.degrees(errors), "_deg")
            figures[name + "_rmse" + suffix] = _root_mean_square(values)
            figures[name + "_max" + suffix] = float(np.max(np.abs(values)))
        return figures

    def figures(self) -> Dict[str, Union[int, float, None]]:
        """All figures by name; lengths in m, None if unknown."""
        errors = self.error_figures()
        return {
            **errors,
            **{name: errors.get(name) for name in STANDING_FIGURES},
            "reference_frames": len(self.reference),
            "matched_frames": len(self.stamps),
            "matched_share": self.matched_share,
            "unmatched_estimates": self.unmatched_estimates,
            "mean_range": self.mean_range,
            "position_rmse_percent_of_range":
                None if not self.mean_range else 100.0 * errors["position_rmse"] / self.mean_range,
        }


def evaluate(estimate: Trajectory, reference: Trajectory, tolerance: float,
             detections: Optional[List[Detection]] = None) -> Evaluation:
    """Compare poses whose stamps differ by at most `tolerance` seconds.

    Raises InputError if nothing can be compared.
    """
    estimates, references = match_stamps(estimate.stamps, reference.stamps,
                                         int(round(tolerance * 1e9)))
    if not len(estimates):
        raise InputError(
            "expected stamps within {:g} ms of the reference's ({} to {}), found {} to {}".format(
                1e3 * tolerance, *(format_stamp(stamp) for stamp in (
                    reference.stamps[0], reference.stamps[-1],
                    estimate.stamps[0], estimate.stamps[-1]))))
    positions = estimate.positions[estimates, :2]
    headings = estimate.yaw[estimates]
    heading_errors = headings - reference.yaw[references]
    standing_errors = {} if estimate.is_on_floor else {
        "height": estimate.positions[estimates, 2] - reference.positions[references, 2],
        "roll": _wrapped(estimate.roll[estimates] - reference.roll[references]),
        "pitch": estimate.pitch[estimates] - reference.pitch[references],
    }
    return Evaluation(
        reference=reference, stamps=estimate.stamps[estimates], reference_indices=references,
        positions=positions, headings=headings,
        position_errors=positions - reference.positions[references, :2],
        heading_errors=_wrapped(heading_errors), standing_errors=standing_errors,
        unmatched_estimates=len(estimate) - len(estimates),
        mean_range=None if detections is None else mean_range(detections))


def match_stamps(first: np.ndarray, second: np.ndarray,
                 tolerance: int) -> Tuple[np.ndarray, np.ndarray]:
    """Pairs of indices into two increasing arrays of stamps, in order of time.

    The closest pair is taken first; no stamp is used twice.
    """
    begin = np.searchsorted(second, first - tolerance, side="left")
    end = np.searchsorted(second, first + tolerance, side="right")
    candidates = sorted((abs(int(first[i]) - int(second[j])), i, j)
                        for i in range(len(first)) for j in range(begin[i], end[i]))
    pairs = []
    used_first, used_second = set(), set()
    for _, i, j in candidates:
        if i not in used_first and j not in used_second:
            pairs.append((i, j))
            used_first.add(i)
            used_second.add(j)
    indices = np.array(sorted(pairs), dtype=int).reshape(-1, 2)
    return indices[:, 0], indices[:, 1]


def mean_range(detections: List[Detection]) -> Optional[float]:
    """Mean horizontal distance in m from the camera to the markers used, over all frames.

    None if no marker was used.
    """
    ranges = [detection.range for detection in detections if detection.accepted]
    return float(np.mean(ranges)) if ranges else None


def _wrapped(angles: np.ndarray) -> np.ndarray:
    return np.arctan2(np.sin(angles), np.cos(angles))


def _root_mean_square(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.square(values))))
