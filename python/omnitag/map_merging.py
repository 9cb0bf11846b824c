"""One marker map out of two that share markers."""

import itertools
from dataclasses import replace
from typing import Dict, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from omnitag.command_line import InputError
from omnitag.marker_map import Marker, MarkerMap
from omnitag.rotation import rotation_from_vector, vector_from_rotation

# What a map has that does not say; the localizer takes the same.
DEVIATION = 0.005  # m
ORIENTATION_DEVIATION = np.radians(1.0)

EXACT = 1e-6
"""m and rad: nothing is known better."""

SAME_PLACE = 27.9
"""Chi-square with six degrees of freedom that one of ten thousand is beyond."""

Key = Tuple[str, int]


class Merged(NamedTuple):
    """A map, and what a person should know of it; lines."""

    marker_map: MarkerMap
    remarks: Tuple[str, ...]


class _Fit(NamedTuple):
    """How the frame of one map lies in that of the other: turned about z, and shifted."""

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
    """A marker as both maps have it, and what they may differ by: standard deviations per axis."""

    a: Marker
    b: Marker

    @property
    def weights(self) -> np.ndarray:
        """(6,): of the position's and the orientation's differences."""
        position = sum(_deviations(marker)[0] ** 2 for marker in self)
        orientation = sum(_deviations(marker)[1] ** 2 for marker in self)
        return np.repeat([1.0 / position, 1.0 / orientation], 3)

    def difference(self, fit: _Fit) -> np.ndarray:
        """(6,): by how much `a` is off `b`: m, and rad about the axes of a's map."""
        moved = fit.moved(self.b).map_from_marker
        turn = self.a.map_from_marker[:3, :3] @ moved[:3, :3].T
        return np.concatenate((self.a.position - moved[:3, 3], vector_from_rotation(turn)))

    def chi_square(self, fit: _Fit) -> float:
        return float(self.weights @ self.difference(fit) ** 2)


def merge(into: MarkerMap, other: MarkerMap) -> Merged:
    """`into` with the markers of `other`, which are moved into its frame by those in both.

    Both maps have z along gravity. Markers in both become their weighted mean; where the maps
    contradict each other, `into` counts. A marker that `other` adds deviates by what the fit
    leaves, too. Raises InputError where nothing ties the maps together.
    """
    pairs = _pairs_of(into, other)
    if not pairs:
        raise InputError("expected a marker that both maps have once; found none")
    fit, agree = _best_fit(pairs)
    information, factor = _information(pairs, agree, fit)
    covariance = factor * np.linalg.inv(information)
    agreeing = {_key(pair.a): pair.b for pair, good in zip(pairs, agree) if good}
    paired = {_key(pair.a) for pair in pairs}

    markers: List[Marker] = []
    for marker in into.markers:
        twin = agreeing.get(_key(marker))
        markers.append(marker if twin is None else
                       _mean(marker, _with_fit(twin, fit, covariance)))
    names = {marker.name for marker in into.markers}
    remarks = [_remark_of_fit(covariance, pairs, agree)]
    remarks += [_contradiction(pair, fit) for pair, good in zip(pairs, agree) if not good]
    for marker in other.markers:
        if _key(marker) in paired:
            continue
        added = _with_fit(marker, fit, covariance)
        if added.name and added.name in names:
            remarks.append("{}: the name is taken: it has none now".format(_label(added)))
            added = replace(added, name="")
        markers.append(added)
    return Merged(replace(into, markers=tuple(markers)), tuple(remarks))


def _key(marker: Marker) -> Key:
    return marker.family, marker.id


def _label(marker: Marker) -> str:
    return "marker " + (marker.name or "{} {}".format(marker.family, marker.id))


def _deviations(marker: Marker) -> Tuple[float, float]:
    """In m and rad, per axis."""
    position = DEVIATION if marker.deviation is None else marker.deviation
    orientation = (ORIENTATION_DEVIATION if marker.orientation_deviation is None
                   else marker.orientation_deviation)
    return max(position, EXACT), max(orientation, EXACT)


def _pairs_of(into: MarkerMap, other: MarkerMap) -> List[_Pair]:
    """Ids that either map has at several places tie nothing."""
    first, second = _unique(into), _unique(other)
    pairs = [_Pair(first[key], second[key]) for key in first if key in second]
    for a, b in pairs:
        if abs(a.size - b.size) > 0.01 * a.size:
            raise InputError("{}: expected one size; found {:g} m and {:g} m".format(
                _label(a), a.size, b.size))
    return pairs


def _unique(marker_map: MarkerMap) -> Dict[Key, Marker]:
    markers: Dict[Key, Optional[Marker]] = {}
    for marker in marker_map.markers:
        markers[_key(marker)] = None if _key(marker) in markers else marker
    return {key: marker for key, marker in markers.items() if marker is not None}


def _best_fit(pairs: Sequence[_Pair]) -> Tuple[_Fit, List[bool]]:
    """The fit that most agree on, refined by those, and who they are."""
    def cost(fit: _Fit) -> float:
        return sum(min(pair.chi_square(fit), SAME_PLACE) for pair in pairs)

    fit = min(_candidates(pairs), key=cost)
    agree = [True] * len(pairs)
    for _ in range(20):
        before = agree
        agree = [pair.chi_square(fit) <= SAME_PLACE for pair in pairs]
        if not any(agree):
            nearest = int(np.argmin([pair.chi_square(fit) for pair in pairs]))
            agree = [i == nearest for i in range(len(pairs))]
        fit = _refined(pairs, agree, fit)
        if agree == before:
            break
    return fit, agree


def _candidates(pairs: Sequence[_Pair]) -> List[_Fit]:
    """By each marker's orientation, and by where each two of them are."""
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
    """(6, 4): by shift and yaw, of a pose whose position has been turned into the frame."""
    jacobian = np.zeros((6, 4))
    jacobian[:3, :3] = np.eye(3)
    jacobian[:2, 3] = -position[1], position[0]
    jacobian[5, 3] = 1.0
    return jacobian


def _refined(pairs: Sequence[_Pair], agree: Sequence[bool], fit: _Fit) -> _Fit:
    """Least squares by those that agree."""
    for _ in range(10):
        information, gradient = np.zeros((4, 4)), np.zeros(4)
        for pair, good in zip(pairs, agree):
            if good:
                jacobian = _jacobian(fit.rotation @ pair.b.position)
                information += jacobian.T @ (pair.weights[:, None] * jacobian)
                gradient += jacobian.T @ (pair.weights * pair.difference(fit))
        step = np.linalg.solve(information, gradient)
        fit = _Fit(fit.shift + step[:3], fit.yaw + float(step[3]))
        if np.linalg.norm(step) < 1e-12:
            break
    return fit


def _information(pairs: Sequence[_Pair], agree: Sequence[bool],
                 fit: _Fit) -> Tuple[np.ndarray, float]:
    """Of shift and yaw, and how many times more the maps differ than they say, 1 at least."""
    information, squares = np.zeros((4, 4)), 0.0
    for pair, good in zip(pairs, agree):
        if good:
            jacobian = _jacobian(fit.rotation @ pair.b.position)
            information += jacobian.T @ (pair.weights[:, None] * jacobian)
            squares += pair.chi_square(fit)
    return information, max(1.0, squares / (6 * sum(agree) - 4))


def _with_fit(marker: Marker, fit: _Fit, covariance: np.ndarray) -> Marker:
    """In the other frame, with what the fit adds to its deviations."""
    jacobian = _jacobian(fit.rotation @ marker.position)
    added = np.diag(jacobian @ covariance @ jacobian.T)
    position, orientation = _deviations(marker)
    return replace(fit.moved(marker),
                   deviation=float(np.sqrt(position ** 2 + added[:3].mean())),
                   orientation_deviation=float(np.sqrt(orientation ** 2 + added[3:].mean())))


def _mean(a: Marker, b: Marker) -> Marker:
    """Of a marker in one frame, weighted; what is exact counts alone."""
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


def _remark_of_fit(covariance: np.ndarray, pairs: Sequence[_Pair],
                   agree: Sequence[bool]) -> str:
    position = np.sqrt(np.diag(covariance)[:3].mean())
    return ("fitted by {} of {} markers that both have, to {:.1f} mm and {:.2f} deg (standard "
            "deviations at the other map's origin)".format(
                sum(agree), len(pairs), 1e3 * position, np.degrees(np.sqrt(covariance[3, 3]))))


def _contradiction(pair: _Pair, fit: _Fit) -> str:
    difference = pair.difference(fit)
    return ("{}: the maps have it {:.3f} m and {:.1f} deg apart, more than their deviations allow: "
            "it stays where the first has it".format(
                _label(pair.a), float(np.linalg.norm(difference[:3])),
                np.degrees(np.linalg.norm(difference[3:]))))
