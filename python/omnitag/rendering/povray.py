"""Running POV-Ray, and the bits of its language that everything shares.

POV-Ray's own tolerances are absolute, about 1e-4 units: scenes are written in millimetres, so that
a mirror of a few centimetres is met exactly. Vectors keep the right-handed coordinates of the map:
only the camera's own vectors decide about handedness in POV-Ray.
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

# Method 1 without jitter keeps edges where they are; the adaptive method 2 shifts them.
_OPTIONS = ("Antialias=on", "Sampling_Method=1", "Antialias_Threshold=0.03", "Jitter=off",
            "File_Gamma=1.0", "Output_File_Type=N", "Bits_Per_Color=16",
            "Grayscale_Output=on", "Display=off", "Work_Threads=1")


def vector(values: Numbers) -> str:
    """A vector as it stands."""
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
    """Renders a scene; (height, width) light, 1 where white, proportional to intensity.

    `bitmaps` are the image files, 8 bit, that the scene refers to by name. Pixels on an edge are
    the mean of `samples` by `samples` rays. Where `rows` are given, the others stay black.
    """
    # A pixel is compared with its neighbours to see whether it is on an edge.
    rows = rows or range(height)
    first, end = max(rows.start - 2, 0), min(rows.stop + 2, height)
    with tempfile.TemporaryDirectory(prefix="omnitag_render_") as directory:
        with open(os.path.join(directory, "scene.pov"), "w", encoding="ascii") as file:
            file.write(scene)
        for name, bitmap in bitmaps.items():
            cv2.imwrite(os.path.join(directory, name), bitmap)
        # The working directory is where POV-Ray may write by default on every system. One block
        # for the whole image: along the edges of its blocks POV-Ray leaves out anti-aliasing.
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
