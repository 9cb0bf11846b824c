"""The camera as POV-Ray text: a pinhole lens and the mirror in front of it, or a fisheye."""

from typing import Union

import numpy as np

from omnitag.rendering.camera import Camera, CatadioptricCamera, FisheyeCamera, canvas_of
from omnitag.rendering.mirror import ConicMirror, TabulatedMirror
from omnitag.rendering.povray import MILLIMETRES, matrix, point, vector

_MIRROR_FINISH = "pigment { rgb 1 } finish { ambient 0 diffuse 0 specular 0 reflection 1 }"


def camera_scene(camera: Camera, map_from_camera: np.ndarray) -> str:
    """The optics of a camera at `map_from_camera`, a (4, 4) transform."""
    if isinstance(camera, FisheyeCamera):
        return fisheye_scene(camera, map_from_camera)
    return lens_scene(camera, map_from_camera) + mirror_scene(camera.mirror, map_from_camera)


def lens_scene(camera: CatadioptricCamera, map_from_camera: np.ndarray) -> str:
    """The pinhole at the optical frame's origin.

    The ray of the pixel (u, v) is ((u - cx) / fx, (v - cy) / fy, 1). POV-Ray's is direction +
    (column / width - 1/2) right + (1/2 - row / height) up, where the centre of the top-left pixel
    is column = row = 1/2. An off-axis direction provides the principal point.
    """
    lens = camera.lens
    x_axis, y_axis, z_axis = map_from_camera[:3, :3].T
    middle_u, middle_v = 0.5 * (camera.width - 1), 0.5 * (camera.height - 1)
    direction = (z_axis + (middle_u - lens.cx) / lens.fx * x_axis
                 + (middle_v - lens.cy) / lens.fy * y_axis)
    return f"""camera {{
  perspective
  location {point(map_from_camera[:3, 3])}
  direction {vector(direction)}
  right {vector(camera.width / lens.fx * x_axis)}
  up {vector(-camera.height / lens.fy * y_axis)}
}}
"""


def fisheye_scene(camera: FisheyeCamera, map_from_camera: np.ndarray) -> str:
    """The fisheye at the optical frame's origin, with the canvas's middle on its axis.

    With x and y from -1 to 1 between the canvas's edges, POV-Ray's ray at (x, y) is off the axis by half
    of `angle` times the length of (|right| x, |up| y); there is none if that length is above 1.
    """
    lens, canvas = camera.lens, canvas_of(camera)
    x_axis, y_axis, z_axis = map_from_camera[:3, :3].T
    return f"""camera {{
  fisheye
  location {point(map_from_camera[:3, 3])}
  direction {vector(z_axis)}
  right {vector(0.5 * canvas.width / (lens.fx * camera.max_angle) * x_axis)}
  up {vector(-0.5 * canvas.height / (lens.fy * camera.max_angle) * y_axis)}
  angle {np.degrees(2.0 * camera.max_angle):.12g}
}}
"""


def mirror_scene(mirror: Union[ConicMirror, TabulatedMirror], map_from_camera: np.ndarray) -> str:
    """The mirror: only its surface up to the rim; it reflects all light and casts no shadow."""
    map_from_apex = map_from_camera.copy()
    map_from_apex[:3, 3] += mirror.apex_distance * map_from_camera[:3, 2]
    if isinstance(mirror, ConicMirror) and not any(mirror.coefficients):
        surface = _conic_surface(mirror)
    else:
        surface = _general_surface(mirror)
    return f"{surface}  {_MIRROR_FINISH}\n  no_shadow\n  {matrix(map_from_apex)}\n}}\n"


def _conic_surface(mirror: ConicMirror) -> str:
    """rho^2 + (1 + K) z^2 - 2 R z = 0, in millimetres from the apex, without its far side."""
    lower, upper = _extent(mirror)
    return f"""quadric {{
  <1, 1, {1.0 + mirror.conic_constant:.15g}>, <0, 0, 0>,
  <0, 0, {-2.0 * MILLIMETRES * mirror.radius_of_curvature:.15g}>, 0
  clipped_by {{ cylinder {{ {point((0, 0, lower))}, {point((0, 0, upper))},
    {MILLIMETRES * mirror.rim_radius:.15g} }} }}
"""


def _general_surface(mirror: Union[ConicMirror, TabulatedMirror]) -> str:
    """The zero of z - sag(rho), found to 1e-6 mm, in millimetres from the apex."""
    lower, upper = _extent(mirror)
    rim = mirror.rim_radius
    rho = np.linspace(0.0, rim, 2000)
    steepest = np.abs(np.diff(mirror.sag(rho)) / np.diff(rho)).max()
    sag = _conic_sag(mirror) if isinstance(mirror, ConicMirror) else _spline_sag(mirror)
    return f"""#declare Sag = function(rho) {{ {sag} }}
isosurface {{
  function {{ z - {MILLIMETRES:g} * Sag(sqrt(x*x + y*y) / {MILLIMETRES:g}) }}
  contained_by {{ box {{ {point((-rim, -rim, lower))}, {point((rim, rim, upper))} }} }}
  open
  accuracy 1e-6
  max_gradient {1.1 * np.hypot(1.0, steepest):.6g}
  clipped_by {{ cylinder {{ {point((0, 0, lower))}, {point((0, 0, upper))},
    {MILLIMETRES * rim:.15g} }} }}
"""


def _extent(mirror: Union[ConicMirror, TabulatedMirror]) -> np.ndarray:
    """Just below the lowest and just above the highest z of the mirror, in metres from the apex."""
    sag = mirror.sag(np.linspace(0.0, mirror.rim_radius, 2000))
    margin = 1e-6
    return np.array([sag.min() - margin, sag.max() + margin])


def _conic_sag(mirror: ConicMirror) -> str:
    curvature = 1.0 / mirror.radius_of_curvature
    root = f"sqrt(max(0, 1 - ({(1.0 + mirror.conic_constant) * curvature**2:.15g}) * rho*rho))"
    terms = [f"{curvature:.15g} * rho*rho / (1 + {root})"]
    for index, coefficient in enumerate(mirror.coefficients):
        terms.append(f"({coefficient:.15g}) * pow(rho, {2 * index + 4})")
    return " + ".join(terms)


def _spline_sag(mirror: TabulatedMirror) -> str:
    start, cubic, jumps = mirror.truncated_powers()
    terms = [f"({coefficient:.15g}) * pow(rho - ({start:.15g}), {power})"
             for power, coefficient in enumerate(cubic) if power > 0]
    terms += [f"({jump:.15g}) * pow(max(0, rho - {knot:.15g}), 3)" for knot, jump in jumps]
    return " + ".join([f"({cubic[0]:.15g})"] + terms)
