"""A camera's mirror as a triangle mesh, to draw it on a robot."""

import struct

import numpy as np

# For display only: edges of a circle, and rings between apex and rim.
SEGMENTS = 48
RINGS = 12
THICKNESS = 0.002  # m, of the mirror's edge


def mirror_triangles(mirror) -> np.ndarray:
    """(n, 3, 3) in metres in the camera's optical frame: each triangle's corners, counter-clockwise
    as seen from outside. `mirror` has a profile `sag`, as the mirrors of omnitag.rendering.mirror."""
    radii = np.linspace(0.0, mirror.rim_radius, RINGS + 1)
    heights = mirror.apex_distance + mirror.sag(radii)
    # The back: over the edge and back to the axis.
    back = max(heights) + THICKNESS
    radii = np.append(radii, [mirror.rim_radius, 0.0])
    heights = np.append(heights, [back, back])

    angles = np.linspace(0.0, 2.0 * np.pi, SEGMENTS, endpoint=False)
    circle = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    rings = np.concatenate([radii[:, None, None] * circle,
                            np.broadcast_to(heights[:, None, None],
                                            (len(heights), SEGMENTS, 1))], axis=-1)
    inner, outer = rings[:-1], rings[1:]
    following = lambda ring: np.roll(ring, -1, axis=1)  # noqa: E731
    first = np.stack([inner, following(outer), outer], axis=2).reshape(-1, 3, 3)
    second = np.stack([inner, following(inner), following(outer)], axis=2).reshape(-1, 3, 3)
    triangles = np.concatenate([first, second])
    # On the axis, one triangle of each pair is degenerate.
    return triangles[np.linalg.norm(_normals(triangles), axis=1) > 0.0]


def write_stl(path: str, triangles: np.ndarray) -> None:
    """Write a binary STL file."""
    normals = _normals(triangles)
    normals = normals / np.linalg.norm(normals, axis=1, keepdims=True)
    records = np.zeros(len(triangles), dtype=[("numbers", "<f4", 12), ("attribute", "<u2")])
    records["numbers"] = np.concatenate([normals, triangles.reshape(-1, 9)], axis=1)
    with open(path, "wb") as file:
        file.write(b"mirror".ljust(80, b"\0") + struct.pack("<I", len(triangles)))
        file.write(records.tobytes())


def _normals(triangles: np.ndarray) -> np.ndarray:
    """Normals whose length is twice the triangle's area."""
    a, b, c = np.moveaxis(triangles, 1, 0)
    return np.cross(b - a, c - a)
