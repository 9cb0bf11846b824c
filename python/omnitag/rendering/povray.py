"""Running POV-Ray, and the elements of its language that all scenes share.

POV-Ray's tolerances are absolute, about 1e-4 units. Scenes are written in millimetres, so that rays
meet a mirror of a few centimetres accurately. Vectors keep the right-handed coordinates of the map: in
POV-Ray only the camera's vectors determine handedness.
"""

import os
import subprocess
import tempfile
from typing import Dict, Optional

import cv2
import numpy as np

from omnitag.command_line import InputError
from omnitag.rotation import Numbers

MILLIMETRES = 1000.0

DEFAULT_SAMPLES = 4

# Method 1 without jitter keeps edges in place; the adaptive method 2 shifts them.
_OPTIONS = ("Antialias=on", "Sampling_Method=1", "Antialias_Threshold=0.03", "Jitter=off",
            "File_Gamma=1.0", "Output_File_Type=N", "Bits_Per_Color=16",
            "Grayscale_Output=on", "Display=off", "Work_Threads=1")


def vector(values: Numbers) -> str:
    """A vector without conversion of units."""
    return "<{}>".format(", ".join("{:.12g}".format(float(value)) for value in values))


def point(metres: Numbers) -> str:
    """A point or an extent, given in metres."""
    return vector(MILLIMETRES * np.asarray(metres, dtype=float))


def matrix(transform: np.ndarray) -> str:
    """The `matrix` modifier of a (4, 4) transform in metres."""
    columns = np.concatenate([transform[:3, :3].T.ravel(), MILLIMETRES * transform[:3, 3]])
    return "matrix " + vector(columns)


def render(scene: str, bitmaps: Dict[str, np.ndarray], width: int, height: int,
           samples: int = DEFAULT_SAMPLES, rows: Optional[range] = None) -> np.ndarray:
    """Render a scene: (height, width) light, proportional to intensity; 1 is white.

    `bitmaps` are the image files that the scene refers to by name. Pixels on an edge are the mean
    of `samples` by `samples` rays. If `rows` are given, the others stay black.
    """
    # POV-Ray finds pixels on an edge by comparing them with their neighbours.
    rows = rows or range(height)
    first, end = max(rows.start - 2, 0), min(rows.stop + 2, height)
    with tempfile.TemporaryDirectory(prefix="omnitag_render_") as directory:
        with open(os.path.join(directory, "scene.pov"), "w", encoding="ascii") as file:
            file.write(scene)
        for name, bitmap in bitmaps.items():
            cv2.imwrite(os.path.join(directory, name), bitmap)
        # On every system POV-Ray may by default write to the working directory. The whole image is
        # one block: POV-Ray does not anti-alias along the edges between blocks.
        command = ["povray", *_OPTIONS, "Input_File_Name=scene.pov", "Output_File_Name=image.png",
                   f"Width={width}", f"Height={height}", f"Antialias_Depth={samples}",
                   f"Render_Block_Size={max(width, height)}"]
        if end - first < height:
            command += [f"Start_Row={first + 1}", f"End_Row={end}"]
        try:
            result = subprocess.run(command, cwd=directory, stdin=subprocess.DEVNULL,
                                    stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        except FileNotFoundError:
            raise InputError("povray: expected the ray tracer POV-Ray 3.7, found none; "
                             "apt install povray")
        if result.returncode != 0:
            complaints = [line for line in result.stderr.splitlines() if "rror" in line]
            raise InputError("povray: " + (complaints or ["made no image"])[0])
        image = cv2.imread(os.path.join(directory, "image.png"), cv2.IMREAD_UNCHANGED)
    return image.astype(float) / np.iinfo(image.dtype).max
