"""The camera files that can be rendered: a pinhole lens that looks at a mirror."""

from typing import NamedTuple, Union

import numpy as np

from omnitag.rendering.checks import positive, positive_integer
from omnitag.rendering.mirror import ConicMirror, TabulatedMirror
from omnitag.yaml_file import Mapping, Value, read_yaml

CONIC_CONSTANTS = {"spherical": 0.0, "parabolic": -1.0}
PROFILES = ("spherical", "parabolic", "hyperbolic", "aspheric", "tabulated")
CONIC_KEYS = ("profile", "radius_of_curvature", "conic_constant", "apex_distance", "rim_radius")
MINIMUM_SAMPLES = 4


class Lens(NamedTuple):
    """A pinhole; pixels, with the centre of the top-left pixel at (0, 0)."""

    fx: float
    fy: float
    cx: float
    cy: float


class CatadioptricCamera(NamedTuple):
    """A pinhole lens at the origin of the optical frame and a mirror on its z axis."""

    width: int
    height: int
    lens: Lens
    mirror: Union[ConicMirror, TabulatedMirror]


def load_camera(path: str) -> CatadioptricCamera:
    """Read a camera file; raises InputError naming file, line and key."""
    root = read_yaml(path).mapping(("model", "image", "lens", "mirror", "xi", "distortion",
                                    "max_angle", "calibration_file"))
    if root["model"].text() != "catadioptric":
        raise root["model"].error("'catadioptric', the model that can be rendered")
    root = read_yaml(path).mapping(("model", "image", "lens", "mirror"))
    image = root["image"].mapping(("width", "height"))
    return CatadioptricCamera(positive_integer(image["width"]), positive_integer(image["height"]),
                              _lens(root["lens"]), _mirror(root["mirror"]))


def _lens(value: Value) -> Lens:
    entry = value.mapping(("fx", "fy", "cx", "cy", "distortion"))
    if "distortion" in entry:
        for coefficient in entry["distortion"].items():
            if coefficient.real() != 0.0:
                raise coefficient.error("0, since POV-Ray's lenses do not distort")
    return Lens(positive(entry["fx"]), positive(entry["fy"]),
                entry["cx"].real(), entry["cy"].real())


def _mirror(value: Value) -> Union[ConicMirror, TabulatedMirror]:
    profile_value = value.mapping(CONIC_KEYS + ("coefficients", "samples"))["profile"]
    profile = profile_value.text()
    if profile not in PROFILES:
        raise profile_value.error("one of " + ", ".join(PROFILES))
    if profile == "tabulated":
        return _tabulated_mirror(
            value.mapping(("profile", "samples", "apex_distance", "rim_radius")))
    entry = value.mapping(CONIC_KEYS + (("coefficients",) if profile == "aspheric" else ()))
    coefficients = ()
    if profile == "aspheric":
        coefficients = tuple(item.real() for item in entry["coefficients"].items())
    mirror = ConicMirror(positive(entry["apex_distance"]), positive(entry["rim_radius"]),
                         positive(entry["radius_of_curvature"]),
                         _conic_constant(profile, entry), coefficients)
    if not np.isfinite(mirror.sag(mirror.rim_radius)):
        raise entry["rim_radius"].error("a radius that the mirror's conic reaches")
    return mirror


def _conic_constant(profile: str, entry: Mapping) -> float:
    implied = CONIC_CONSTANTS.get(profile)
    if implied is not None and "conic_constant" not in entry:
        return implied
    conic_constant = entry["conic_constant"].real()
    if implied is not None and conic_constant != implied:
        raise entry["conic_constant"].error(f"{implied:g}, for the mirror is {profile}")
    if profile == "hyperbolic" and conic_constant >= -1.0:
        raise entry["conic_constant"].error("less than -1, for the mirror is hyperbolic")
    return conic_constant


def _tabulated_mirror(entry: Mapping) -> TabulatedMirror:
    samples = []
    for item in entry["samples"].items("a list of [rho, sag]"):
        rho, sag = item.reals(2)
        if rho < 0.0:
            raise item.error("rho of at least 0", f"{rho:g}")
        if samples and rho <= samples[-1][0]:
            raise item.error(f"rho above {samples[-1][0]:g}, the one before", f"{rho:g}")
        samples.append((rho, sag))
    if len(samples) < MINIMUM_SAMPLES:
        raise entry["samples"].error(f"at least {MINIMUM_SAMPLES} samples", str(len(samples)))
    rim_radius = positive(entry["rim_radius"])
    if rim_radius > samples[-1][0]:
        raise entry["rim_radius"].error(f"at most {samples[-1][0]:g}, where the samples end")
    return TabulatedMirror(positive(entry["apex_distance"]), rim_radius, tuple(samples))
