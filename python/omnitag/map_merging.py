"""Merging of two marker maps that share markers."""

import itertools
from dataclasses import replace
from typing import List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from omnitag.command_line import InputError
from omnitag.marker_map import Marker, MarkerMap, unique_markers, with_pattern_ids
from omnitag.rotation import rotation_from_vector, vector_from_rotation

# Of a map that does not state them; the localizer assumes the same.
DEVIATION = 0.005  # m
ORIENTATION_DEVIATION = np.radians(1.0)

EXACT = 1e-6
"""m and rad: no deviation is assumed to be smaller."""

SAME_PLACE = 27.9
"""Chi-square with six degrees of freedom that chance exceeds once in ten thousand."""


class Merged(NamedTuple):
    """A map, with remarks for the user, one per line."""

    marker_map: MarkerMap
    remarks: Tuple[str, ...]


class _Fit(NamedTuple):
    """The frame of one map in that of the other: turned about z and shifted."""

    shift: np.ndarray  # (3,), m
    yaw: float  # rad

    @property
    def rotation(self) -> np.ndarray:
        return rotation_from_vector((0.0, 0.0, self.yaw))

    def moved(self, marker: Marker) -> Marker:
        pose = marker.map_from_marker.copy()
        pose[:3] = self.rotation @ pose[:3]
        pose[:3, 3] += self.shift
        return replace(marker, map_from_marker=pose)


class _Pair(NamedTuple):
    """A marker in both maps."""

    a: Marker
    b: Marker

    @property
    def weights(self) -> np.ndarray:
        """(6,): inverse variances of the differences in position and orientation."""
        position = sum(_deviations(marker)[0] ** 2 for marker in self)
        orientation = sum(_deviations(marker)[1] ** 2 for marker in self)
        return np.repeat([1.0 / position, 1.0 / orientation], 3)

    def difference(self, fit: _Fit) -> np.ndarray:
        """(6,): `a` minus `b`: m, and rad about the axes of a's map."""
        moved = fit.moved(self.b).map_from_marker
        turn = self.a.map_from_marker[:3, :3] @ moved[:3, :3].T
        return np.concatenate((self.a.position - moved[:3, 3], vector_from_rotation(turn)))

    def chi_square(self, fit: _Fit) -> float:
        return float(self.weights @ self.difference(fit) ** 2)


def merge(into: MarkerMap, other: MarkerMap) -> Merged:
    """`into` with the markers of `other`, moved into its frame by the markers in both.

    Both maps have z along gravity. Markers in both become their weighted mean; if the maps contradict
    each other, `into` counts. The deviations of markers that `other` adds include the uncertainty of
    the fit. Raises InputError if the maps share no marker.
    """
    pairs = _pairs_of(into, other)
    if not pairs:
        raise InputError("expected a marker that both maps have once; found none")
    fit, agreeing = _best_fit(pairs)
    covariance = _covariance(agreeing, fit)
    agreed = {pair.a.identity for pair in agreeing}
    contradictions = {pair.a.identity: pair for pair in pairs if pair.a.identity not in agreed}

    markers = list(into.markers)
    names = {marker.name for marker in into.markers}
    remarks = [_remark_of_fit(covariance, len(agreeing), len(pairs))]
    remarks += [_contradiction(pair, fit) for pair in contradictions.values()]
    # One file for each pattern, even if each map has its own copy.
    patterns = {marker.identity: marker.pattern for marker in into.markers}
    for marker in other.markers:
        if marker.identity in contradictions:
            continue
        marker = replace(marker, pattern=patterns.get(marker.identity, marker.pattern))
        added = _with_fit(marker, fit, covariance)
        entry = _entry_of(added, into, marker.identity in agreed)
        if entry is not None:
            markers[entry] = _mean(into.markers[entry], added)
            continue
        if added.name and added.name in names:
            remarks.append("{}: the name is taken: it has none now".format(_label(added)))
            added = replace(added, name="")
        markers.append(added)
    return Merged(replace(into, markers=with_pattern_ids(markers)), tuple(remarks))


def _label(marker: Marker) -> str:
    return "marker " + (marker.name or "{} {}".format(marker.family, marker.text))


def _deviations(marker: Marker) -> Tuple[float, float]:
    """In m and rad, per axis."""
    position = DEVIATION if marker.deviation is None else marker.deviation
    orientation = (ORIENTATION_DEVIATION if marker.orientation_deviation is None
                   else marker.orientation_deviation)
    return max(position, EXACT), max(orientation, EXACT)


def _pairs_of(into: MarkerMap, other: MarkerMap) -> List[_Pair]:
    """Markers that both maps have exactly once; ids at several places of a map are not used."""
    first, second = unique_markers(into), unique_markers(other)
    pairs = [_Pair(first[key], second[key]) for key in first if key in second]
    for a, b in pairs:
        if abs(a.size - b.size) > 0.01 * a.size:
            raise InputError("{}: expected one size; found {:g} m and {:g} m".format(
                _label(a), a.size, b.size))
    return pairs


def _best_fit(pairs: Sequence[_Pair]) -> Tuple[_Fit, List[_Pair]]:
    """The fit that most pairs agree on, refined by these pairs, and which pairs they are."""
    def cost(fit: _Fit) -> float:
        return sum(min(pair.chi_square(fit), SAME_PLACE) for pair in pairs)

    fit = min(_candidates(pairs), key=cost)
    agreeing = list(pairs)
    for _ in range(20):
        before = [pair.a.identity for pair in agreeing]
        agreeing = ([pair for pair in pairs if pair.chi_square(fit) <= SAME_PLACE]
                    or [min(pairs, key=lambda pair: pair.chi_square(fit))])
        fit = _refined(agreeing, fit)
        if [pair.a.identity for pair in agreeing] == before:
            break
    return fit, agreeing


def _candidates(pairs: Sequence[_Pair]) -> List[_Fit]:
    """Fits by the orientation of each marker, and by the positions of every two."""
    candidates = []
    for a, b in pairs:
        turn = a.map_from_marker[:3, :3] @ b.map_from_marker[:3, :3].T
        yaw = float(np.arctan2(turn[1, 0] - turn[0, 1], turn[0, 0] + turn[1, 1]))
        candidates.append(_through(a.position, b.position, yaw))
    for one, two in itertools.combinations(pairs, 2):
        x, y = (two.a.position - one.a.position)[:2], (two.b.position - one.b.position)[:2]
        yaw = float(np.arctan2(x[1], x[0]) - np.arctan2(y[1], y[0]))
        candidates.append(_through(0.5 * (one.a.position + two.a.position),
                                   0.5 * (one.b.position + two.b.position), yaw))
    return candidates


def _through(a: np.ndarray, b: np.ndarray, yaw: float) -> _Fit:
    return _Fit(a - rotation_from_vector((0.0, 0.0, yaw)) @ b, yaw)


def _jacobian(position: np.ndarray) -> np.ndarray:
    """(6, 4): derivatives by shift and yaw of a pose whose position is turned into the frame."""
    jacobian = np.zeros((6, 4))
    jacobian[:3, :3] = np.eye(3)
    jacobian[:2, 3] = -position[1], position[0]
    jacobian[5, 3] = 1.0
    return jacobian


def _entry_of(marker: Marker, into: MarkerMap, is_there: bool) -> Optional[int]:
    """The index of a marker that was moved into the frame of `into`; None if it is not in that map.

    Of several with its id, it is the nearest, which must be at the same place unless `is_there`.
    """
    unmoved = _Fit(np.zeros(3), 0.0)
    entries = {i: _Pair(each, marker).chi_square(unmoved)
               for i, each in enumerate(into.markers) if each.identity == marker.identity}
    nearest = min(entries, key=lambda i: entries[i], default=None)
    return nearest if nearest is not None and (is_there or entries[nearest] <= SAME_PLACE) else None


def _normal_equations(pairs: Sequence[_Pair], fit: _Fit) -> Tuple[np.ndarray, np.ndarray]:
    """Information and gradient of shift and yaw."""
    information, gradient = np.zeros((4, 4)), np.zeros(4)
    for pair in pairs:
        jacobian = _jacobian(fit.rotation @ pair.b.position)
        information += jacobian.T @ (pair.weights[:, None] * jacobian)
        gradient += jacobian.T @ (pair.weights * pair.difference(fit))
    return information, gradient


def _refined(pairs: Sequence[_Pair], fit: _Fit) -> _Fit:
    """Least squares over all pairs."""
    for _ in range(10):
        step = np.linalg.solve(*_normal_equations(pairs, fit))
        fit = _Fit(fit.shift + step[:3], fit.yaw + float(step[3]))
        if np.linalg.norm(step) < 1e-12:
            break
    return fit


def _covariance(pairs: Sequence[_Pair], fit: _Fit) -> np.ndarray:
    """(4, 4): of shift and yaw; larger if the pairs differ by more than the maps' deviations."""
    information, _ = _normal_equations(pairs, fit)
    squares = sum(pair.chi_square(fit) for pair in pairs)
    return max(1.0, squares / (6 * len(pairs) - 4)) * np.linalg.inv(information)


def _with_fit(marker: Marker, fit: _Fit, covariance: np.ndarray) -> Marker:
    """The marker in the other frame; its deviations include the uncertainty of the fit."""
    jacobian = _jacobian(fit.rotation @ marker.position)
    added = np.diag(jacobian @ covariance @ jacobian.T)
    position, orientation = _deviations(marker)
    return replace(fit.moved(marker),
                   deviation=float(np.sqrt(position ** 2 + added[:3].mean())),
                   orientation_deviation=float(np.sqrt(orientation ** 2 + added[3:].mean())))


def _mean(a: Marker, b: Marker) -> Marker:
    """The weighted mean of a marker in one frame; an exact pose counts alone."""
    (position_a, turn_a), (position_b, turn_b) = _deviations(a), _deviations(b)
    share = position_a ** 2 / (position_a ** 2 + position_b ** 2)
    turned_share = turn_a ** 2 / (turn_a ** 2 + turn_b ** 2)
    pose = a.map_from_marker.copy()
    pose[:3, 3] += share * (b.position - a.position)
    turn = vector_from_rotation(b.map_from_marker[:3, :3] @ pose[:3, :3].T)
    pose[:3, :3] = rotation_from_vector(turned_share * turn) @ pose[:3, :3]
    return replace(
        a, map_from_marker=pose,
        deviation=_or_exact(a.deviation, position_b * float(np.sqrt(share))),
        orientation_deviation=_or_exact(a.orientation_deviation,
                                        turn_b * float(np.sqrt(turned_share))))


def _or_exact(said: Optional[float], found: float) -> float:
    return 0.0 if said == 0.0 else found


def _remark_of_fit(covariance: np.ndarray, agreeing: int, shared: int) -> str:
    position = np.sqrt(np.diag(covariance)[:3].mean())
    return ("fitted by {} of {} markers that both have, to {:.1f} mm and {:.2f} deg (standard "
            "deviations at the other map's origin)".format(
                agreeing, shared, 1e3 * position, np.degrees(np.sqrt(covariance[3, 3]))))


def _contradiction(pair: _Pair, fit: _Fit) -> str:
    difference = pair.difference(fit)
    return ("{}: the maps have it {:.3f} m and {:.1f} deg apart, more than their deviations allow: "
            "it stays where the first has it".format(
                _label(pair.a), float(np.linalg.norm(difference[:3])),
                np.degrees(np.linalg.norm(difference[3:]))))
