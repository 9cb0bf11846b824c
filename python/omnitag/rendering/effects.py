"""From light to the grey levels of a real camera."""

from typing import NamedTuple, Tuple

import numpy as np

from omnitag.rendering.bayer import PATTERNS, develop
from omnitag.rendering.blur import blurred
from omnitag.rendering.camera import Camera, rim_shares
from omnitag.rendering.checks import not_negative, positive, share
from omnitag.rendering.turning import turned
from omnitag.yaml_file import Mapping, Value

KEYS = ("turn", "blur", "vignetting", "gain", "gamma", "bayer")


class Effects(NamedTuple):
    """Effects on the light; none by default."""

    turn: float = 0.0
    """rad that the camera turns about its axis in each exposure, half of it on each side of the pose."""
    blur: Tuple[float, float] = (0.0, 0.0)
    """Standard deviations in pixels, on the axis and at the rim."""
    vignetting: float = 0.0
    """Share of the light that is lost at the rim."""
    gain: float = 1.0
    gamma: float = 1.0
    """Grey levels are proportional to light^(1/gamma)."""
    bayer: str = ""
    """Colours of the first two pixels of the first two rows; empty: no colour filters."""


def read_effects(entry: Mapping) -> Effects:
    """Read the effects from a world's `images`."""
    usual = Effects()
    given = {key: positive(entry[key]) for key in ("gain", "gamma") if key in entry}
    if "turn" in entry:
        given["turn"] = entry["turn"].real()
    blur = _blur(entry["blur"]) if "blur" in entry else usual.blur
    if "vignetting" in entry:
        given["vignetting"] = share(entry["vignetting"])
    bayer = _bayer(entry["bayer"]) if "bayer" in entry else usual.bayer
    return Effects(blur=blur, bayer=bayer, **given)


def collected_light(light: np.ndarray, camera: Camera, effects: Effects) -> np.ndarray:
    """The light on the sensor, after turn, blur, vignetting and gain; 1 saturates."""
    if effects.turn:
        light = turned(light, camera, effects.turn)
    centre, rim = effects.blur
    if centre or rim:
        shares = 0.0 if centre == rim else np.square(rim_shares(camera))
        light = blurred(light, centre + (rim - centre) * shares)
    if effects.vignetting:
        light = light * (1.0 - effects.vignetting * np.square(rim_shares(camera)))
    if effects.gain != 1.0:
        light = effects.gain * light
    return light


def image_pixels(light: np.ndarray, camera: Camera, effects: Effects, noise: float,
                 generator: np.random.Generator) -> np.ndarray:
    """The 8-bit image of a camera with these effects and this noise."""
    light = collected_light(light, camera, effects)
    if effects.bayer:
        return develop(light, effects.bayer, effects.gamma,
                       lambda filtered: grey_levels(filtered, noise, generator, effects.gamma))
    return grey_levels(light, noise, generator, effects.gamma)


def grey_levels(light: np.ndarray, noise: float, generator: np.random.Generator,
                gamma: float = 1.0) -> np.ndarray:
    """8-bit image of light with normal noise (standard deviation in grey levels), rounded once."""
    light = np.clip(light, 0.0, 1.0)
    encoded = light if gamma == 1.0 else light ** (1.0 / gamma)
    levels = 255.0 * encoded + noise * generator.standard_normal(light.shape)
    return np.clip(np.rint(levels), 0, 255).astype(np.uint8)


def _blur(value: Value) -> Tuple[float, float]:
    if value.is_list():
        centre, rim = value.reals(2)
        if min(centre, rim) < 0.0:
            raise value.error("two numbers of at least 0", f"[{centre:g}, {rim:g}]")
        return centre, rim
    deviation = not_negative(value)
    return deviation, deviation


def _bayer(value: Value) -> str:
    pattern = value.text()
    if pattern not in PATTERNS:
        raise value.error("one of " + ", ".join(PATTERNS))
    return pattern
