"""Maps and camera files with errors: their numbers are slightly off the true ones."""

import re
from dataclasses import replace
from typing import Dict, List, NamedTuple, Optional, Tuple

import numpy as np

from omnitag.marker_map import MarkerMap
from omnitag.rendering.camera import CAMERA_KEYS, CONIC_KEYS
from omnitag.rotation import rotation_from_vector
from omnitag.yaml_file import Mapping, read_yaml

LENS_KEYS = ("fx", "fy", "cx", "cy", "distortion")


class MapDeviations(NamedTuple):
    """How far markers are displaced, per axis; standard deviations."""

    position: float = 0.0  # m
    orientation: float = 0.0  # rad


class CameraErrors(NamedTuple):
    """How far a camera file is off: standard deviations, or the errors themselves."""

    principal_point: float = 0.0  # px, of cx and of cy
    scale: float = 0.0  # share, the same of fx and fy
    apex: float = 0.0  # m, of the mirror's apex distance

    def drawn(self, generator: np.random.Generator) -> Tuple[float, float, float, float]:
        """Random errors of cx, cy, scale and apex distance with these standard deviations."""
        factors = (self.principal_point, self.principal_point, self.scale, self.apex)
        cx, cy, scale, apex = np.array(factors) * generator.standard_normal(4)
        return cx, cy, scale, apex

    def exactly(self) -> Tuple[float, float, float, float]:
        """These numbers as errors of cx, cy, scale and apex distance."""
        return self.principal_point, self.principal_point, self.scale, self.apex


def displaced(marker_map: MarkerMap, deviations: MapDeviations, seed: int,
              said: Optional[MapDeviations] = None) -> MarkerMap:
    """The map with each marker displaced, which depends only on the seed and the marker's index.

    The map states the deviations `said`, or none.
    """
    markers = []
    for index, marker in enumerate(marker_map.markers):
        draws = np.random.default_rng([seed, index]).standard_normal((2, 3))
        pose = marker.map_from_marker.copy()
        pose[:3, 3] += deviations.position * draws[0]
        pose[:3, :3] = pose[:3, :3] @ rotation_from_vector(deviations.orientation * draws[1])
        markers.append(replace(marker, map_from_marker=pose, deviation=said.position if said else None,
                               orientation_deviation=said.orientation if said else None))
    return MarkerMap(tuple(markers), marker_map.frame_id, marker_map.defaults)


def camera_text(path: str, errors: Tuple[float, float, float, float],
                said: Optional[CameraErrors]) -> str:
    """The text of a camera file with these errors; its `uncertainty` is `said`, or absent.

    Raises InputError if the file lacks a number that is to be changed.
    """
    root = read_yaml(path).mapping(CAMERA_KEYS)
    cx, cy, scale, apex = errors
    lens = root["lens"].mapping(LENS_KEYS)
    changes = _changed(lens, {"fx": (1.0 + scale, 0.0), "fy": (1.0 + scale, 0.0),
                              "cx": (1.0, cx), "cy": (1.0, cy)})
    if apex != 0.0:
        mirror = root["mirror"].mapping(CONIC_KEYS + ("coefficients", "samples"))
        changes += _changed(mirror, {"apex_distance": (1.0, apex)})
    with open(path, encoding="utf-8") as file:
        text = file.read()
    for (begin, end), number in sorted(changes, reverse=True):
        text = text[:begin] + number + text[end:]
    text = re.sub(r"^uncertainty:.*\n?([ \t]+.*\n?)*", "", text, flags=re.MULTILINE)
    if said:
        text = text.rstrip("\n") + "\nuncertainty: " + _uncertainty(root, said) + "\n"
    return text


def _changed(entry: Mapping,
             changes: Dict[str, Tuple[float, float]]) -> List[Tuple[Tuple[int, int], str]]:
    """Places in the text and their new numbers: factor times the number, plus a term."""
    return [(entry[key].span(), repr(round(float(factor * entry[key].real() + term), 12)))
            for key, (factor, term) in changes.items() if factor != 1.0 or term != 0.0]


def _uncertainty(root: Mapping, said: CameraErrors) -> str:
    """In pixels at the rim. An error of the apex distance also scales the image."""
    size = root["image"].mapping(("width", "height"))
    rim = 0.5 * min(size["width"].integer(), size["height"].integer())
    share = said.scale
    if "mirror" in root:
        mirror = root["mirror"].mapping(CONIC_KEYS + ("coefficients", "samples"))
        distance = mirror["apex_distance"].real()
        lens = root["lens"].mapping(LENS_KEYS)
        rim = min(rim, lens["fx"].real() * mirror["rim_radius"].real() / distance)
        share = np.hypot(share, said.apex / distance)
    return (f"{{principal_point: {said.principal_point:.6g}, scale: {share * rim:.6g}, "
            "tilt: 0, rim: 0}")
