"""How far a marker map is off the true map."""

from typing import Hashable, List, NamedTuple, Set

import numpy as np

from omnitag.marker_map import MarkerMap, unique_markers


class MarkerError(NamedTuple):
    """The error of one marker."""

    label: str
    distance: float  # m, between the centres
    angle: float  # rad, between the orientations


def compare(estimate: MarkerMap, reference: MarkerMap, without: Set[Hashable],
            align: bool) -> List[MarkerError]:
    """The errors of all markers that both maps have exactly once, except those in `without`.

    `without` has markers' identities. With `align`, the estimate is first moved in the plane so that its
    positions fit best.
    """
    estimates = unique_markers(estimate)
    references = unique_markers(reference)
    keys = [key for key in estimates if key in references and key not in without]
    if not keys:
        return []
    reference_from_estimate = np.eye(4)
    if align:
        reference_from_estimate = _planar_fit(
            np.array([estimates[key].position for key in keys]),
            np.array([references[key].position for key in keys]))
    errors = []
    for key in keys:
        moved = reference_from_estimate @ estimates[key].map_from_marker
        true = references[key].map_from_marker
        turn = moved[:3, :3].T @ true[:3, :3]
        # Unlike a cosine, this is well conditioned for small angles.
        sine = 0.5 * np.linalg.norm([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0],
                                     turn[1, 0] - turn[0, 1]])
        angle = np.arctan2(sine, 0.5 * (np.trace(turn) - 1.0))
        errors.append(MarkerError(references[key].label,
                                  float(np.linalg.norm(moved[:3, 3] - true[:3, 3])),
                                  float(angle)))
    return errors


def table(errors: List[MarkerError]) -> str:
    """A table to read: each marker's errors in mm and degrees, then their maximum and RMS."""
    lines = ["{:<24}{:>10}{:>10}".format("marker", "mm", "degrees")]
    row = "{:<24}{:>10.2f}{:>10.3f}"
    lines += [row.format(e.label, 1e3 * e.distance, np.degrees(e.angle)) for e in errors]
    distances = np.array([error.distance for error in errors])
    angles = np.array([error.angle for error in errors])
    lines.append("")
    lines.append(row.format("maximum", 1e3 * distances.max(), np.degrees(angles.max())))
    lines.append(row.format("RMS", 1e3 * np.sqrt(np.mean(distances ** 2)),
                            np.degrees(np.sqrt(np.mean(angles ** 2)))))
    return "\n".join(lines)


def _planar_fit(points: np.ndarray, targets: np.ndarray) -> np.ndarray:
    """(4, 4): the turn about z and the shift in x and y that fit points to targets best."""
    point_mean, target_mean = points.mean(axis=0), targets.mean(axis=0)
    a, b = points - point_mean, targets - target_mean
    angle = np.arctan2(np.sum(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]),
                       np.sum(a[:, 0] * b[:, 0] + a[:, 1] * b[:, 1]))
    fit = np.eye(4)
    fit[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    fit[:2, 3] = target_mean[:2] - fit[:2, :2] @ point_mean[:2]
    return fit
