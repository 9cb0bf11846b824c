"""convert_camera: what it writes, and what it says about bad input."""

import os
import subprocess
import sys
import tempfile
import unittest

import yaml

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from harness import PACKAGE  # noqa: E402

FISHEYE = os.path.join(PACKAGE, "config", "cameras", "fisheye.yaml")
PAPER = os.path.join(PACKAGE, "config", "cameras", "paper.yaml")


class ConvertCameraTest(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.output = os.path.join(directory.name, "out.yaml")

    def run_tool(self, *arguments):
        return subprocess.run(["rosrun", "omnitag", "convert_camera", *arguments],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              universal_newlines=True, check=False)

    def convert(self, source, *arguments):
        result = self.run_tool(source, self.output, *arguments)
        self.assertEqual(result.returncode, 0, result.stderr)
        return result.stdout

    def assert_refused(self, *arguments, part):
        result = self.run_tool(*arguments)
        self.assertEqual(result.returncode, 1)
        self.assertEqual(result.stdout, "")
        self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
        self.assertIn(part, result.stderr)
        self.assertFalse(os.path.exists(self.output))

    def test_what_ros_reads(self):
        said = self.convert(FISHEYE, "--to", "camera_info")
        self.assertIn("camera_info, which has no place for max_angle, uncertainty", said)
        with open(self.output, encoding="utf-8") as file:
            info = yaml.safe_load(file)
        self.assertEqual((info["image_width"], info["image_height"]), (500, 500))
        self.assertEqual(info["camera_matrix"]["data"], [146, 0, 249.5, 0, 146, 249.5, 0, 0, 1])
        self.assertEqual(info["distortion_model"], "equidistant")
        self.assertEqual(info["distortion_coefficients"]["data"], [0, 0, 0, 0])
        self.assertEqual(len(info["projection_matrix"]["data"]), 12)

    def test_a_camera_file_of_a_camchain(self):
        self.convert(FISHEYE, "--to", "kalibr")
        chain = self.output + ".chain"
        os.rename(self.output, chain)
        self.convert(chain + "#cam0")
        with open(self.output, encoding="utf-8") as file:
            camera = yaml.safe_load(file)
        self.assertEqual(camera["model"], "equidistant")
        self.assertEqual(camera["lens"], {"fx": 146, "fy": 146, "cx": 249.5, "cy": 249.5})

    def test_bad_input(self):
        self.assert_refused(PAPER, self.output, "--to", "kalibr",
                            part="model: expected equidistant, pinhole, unified, double_sphere or "
                                 "eucm to write it as kalibr, found 'catadioptric'")
        self.assert_refused(FISHEYE, self.output, "--to", "basalt",
                            part="--to: expected one of omnitag, kalibr, opencv, camera_info, ocam")
        self.assert_refused("none.yaml", self.output, part="none.yaml: expected a readable file")
        self.assert_refused(FISHEYE, FISHEYE, part="is an input and would be overwritten")
        self.assert_refused(FISHEYE, part="out")


if __name__ == "__main__":
    unittest.main()
