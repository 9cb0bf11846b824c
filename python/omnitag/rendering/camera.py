"""The camera files that can be rendered: a lens that looks at a mirror, and an ideal fisheye."""

from itertools import product
from typing import List, NamedTuple, Tuple, Union

import numpy as np

from omnitag.rendering.checks import positive, positive_integer
from omnitag.rendering.mirror import ConicMirror, TabulatedMirror
from omnitag.yaml_file import Mapping, Value, read_yaml

CONIC_CONSTANTS = {"spherical": 0.0, "parabolic": -1.0}
PROFILES = ("spherical", "parabolic", "hyperbolic", "aspheric", "tabulated")
CAMERA_KEYS = ("model", "image", "uncertainty", "lens", "mirror", "xi", "alpha", "beta",
               "distortion", "max_angle", "calibration_file", "through_mirror", "scale_to_image")
CONIC_KEYS = ("profile", "radius_of_curvature", "conic_constant", "apex_distance", "rim_radius")
MINIMUM_SAMPLES = 4

# As in the localizer: a point straight behind the camera would image as a circle.
LARGEST_ANGLE = 3.12


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


class FisheyeCamera(NamedTuple):
    """A fisheye whose image radius is exactly proportional to the angle off the axis."""

    width: int
    height: int
    lens: Lens
    max_angle: float
    """rad off the axis; the image is black beyond."""


Camera = Union[CatadioptricCamera, FisheyeCamera]


class Canvas(NamedTuple):
    """What is rendered; the image is a part of it; pixels."""

    width: int
    height: int
    left: int
    top: int


def load_camera(path: str) -> Camera:
    """Read a camera file; raises InputError naming file, line and key."""
    root = read_yaml(path).mapping(CAMERA_KEYS)
    model = root["model"].text()
    if model == "catadioptric":
        root = read_yaml(path).mapping(("model", "image", "uncertainty", "lens", "mirror"))
        return CatadioptricCamera(*_image_size(root["image"]), _lens(root["lens"]),
                                  _mirror(root["mirror"]))
    if model == "equidistant":
        root = read_yaml(path).mapping(("model", "image", "uncertainty", "lens", "distortion",
                                        "max_angle"))
        return _fisheye(root)
    raise root["model"].error("'catadioptric' or 'equidistant', the models that can be rendered")


def canvas_of(camera: Camera) -> Canvas:
    """The image, enlarged as necessary to have a fisheye's axis in the middle of the canvas."""
    if isinstance(camera, CatadioptricCamera):
        return Canvas(camera.width, camera.height, 0, 0)
    width, left = _centred(camera.width, camera.lens.cx)
    height, top = _centred(camera.height, camera.lens.cy)
    return Canvas(width, height, left, top)


def finer(camera: Camera, factor: int) -> Camera:
    """The same camera with each pixel divided into `factor` by `factor`."""
    lens = camera.lens
    shift = 0.5 * (factor - 1)
    return camera._replace(width=factor * camera.width, height=factor * camera.height, lens=Lens(
        factor * lens.fx, factor * lens.fy, factor * lens.cx + shift, factor * lens.cy + shift))


def _centred(size: int, center: float) -> Tuple[int, int]:
    before, after = center, size - 1 - center
    return int(round(2.0 * max(before, after))) + 1, int(round(max(0.0, after - before)))


def _image_size(value: Value) -> Tuple[int, int]:
    image = value.mapping(("width", "height"))
    return positive_integer(image["width"]), positive_integer(image["height"])


def _fisheye(root: Mapping) -> FisheyeCamera:
    width, height = _image_size(root["image"])
    entry = root["lens"].mapping(("fx", "fy", "cx", "cy", "skew"))
    if "skew" in entry and entry["skew"].real() != 0.0:
        raise entry["skew"].error("0, since POV-Ray's fisheye has none")
    lens = Lens(positive(entry["fx"]), positive(entry["fy"]), entry["cx"].real(),
                entry["cy"].real())
    for key, center in (("cx", lens.cx), ("cy", lens.cy)):
        if 2.0 * center != round(2.0 * center):
            raise entry[key].error("a multiple of 0.5, since POV-Ray's fisheye has its axis in "
                                   "the middle of the image")
    for coefficient in root["distortion"].items():
        if coefficient.real() != 0.0:
            raise coefficient.error("0, since POV-Ray's fisheye is exactly equidistant")
    corners = product((-0.5, width - 0.5), (-0.5, height - 0.5))
    max_angle = min(LARGEST_ANGLE, max(
        np.hypot((u - lens.cx) / lens.fx, (v - lens.cy) / lens.fy) for u, v in corners))
    if "max_angle" in root:
        max_angle = positive(root["max_angle"])
        if max_angle > LARGEST_ANGLE:
            raise root["max_angle"].error(f"at most {LARGEST_ANGLE:g}")
    return FisheyeCamera(width, height, lens, max_angle)


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
    coefficients: Tuple[float, ...] = ()
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
    samples: List[Tuple[float, float]] = []
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


def rim_shares(camera: Camera) -> np.ndarray:
    """(height, width): each pixel's distance from the axis, as a share of the rim's; at most 1.

    The rim is the mirror's, or the end of a fisheye's image.
    """
    lens = camera.lens
    u, v = np.meshgrid(np.arange(camera.width), np.arange(camera.height))
    distances = np.hypot((u - lens.cx) / lens.fx, (v - lens.cy) / lens.fy)
    return np.minimum(distances / rim_distance(camera), 1.0)


def rim_distance(camera: Camera) -> float:
    """Distance of the rim from the axis in the image, for a focal length of 1."""
    if isinstance(camera, FisheyeCamera):
        return camera.max_angle
    mirror = camera.mirror
    return float(mirror.rim_radius / (mirror.apex_distance + mirror.sag(mirror.rim_radius)))
