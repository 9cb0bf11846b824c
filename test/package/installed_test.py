"""The installed package, as others find it: programs of theirs are built with it, and run.

CTest tells in the environment which build folder (BUILD) was configured for which prefix (PREFIX), and
whether with ROS (ROS). Nothing is built there: what is built is installed elsewhere.
"""

import os
import subprocess
import sys
import tempfile
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.join(HERE, "..", "..")
BUILD = os.environ["BUILD"]
HAS_ROS = os.environ["ROS"] == "ON"


def run(*command, **variables):
    """What a command writes. A workspace that was sourced would show its own package instead."""
    environment = {**os.environ, **variables}
    environment.pop("LD_LIBRARY_PATH", None)
    result = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                            env=environment, universal_newlines=True, check=False)
    if result.returncode != 0:
        raise AssertionError(f"{' '.join(command)}:\n{result.stdout}")
    return result.stdout


class InstalledTest(unittest.TestCase):

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def install_core(self):
        """The prefix where the core alone is."""
        prefix = os.path.join(self.folder, "core")
        run("cmake", "--install", BUILD, "--component", "core", "--prefix", prefix)
        return prefix

    def install_all(self):
        """The prefix where all of the package is. catkin's scripts know no other than the configured."""
        run("cmake", "--install", BUILD, DESTDIR=self.folder)
        return self.folder + os.environ["PREFIX"]

    def build(self, user, prefix):
        """The program of a package beside this file, built with the package in a prefix."""
        build = os.path.join(self.folder, user)
        prefixes = [prefix, *filter(None, [os.environ.get("CMAKE_PREFIX_PATH")])]
        run("cmake", "-S", os.path.join(HERE, user), "-B", build,
            f"-DPYTHON_EXECUTABLE={sys.executable}", CMAKE_PREFIX_PATH=os.pathsep.join(prefixes))
        run("cmake", "--build", build)
        with open(os.path.join(build, "CMakeCache.txt"), encoding="utf-8") as cache:
            self.assertIn(f"_DIR:PATH={prefix}/", cache.read(), "another one was found")
        return os.path.join(build, user)

    def check_core(self, prefix):
        said = run(self.build("core_user", prefix),
                   *(os.path.join(ROOT, path) for path in (
                       "config/cameras/paper.yaml", "maps/paper.yaml", "config/localizer.yaml")))
        self.assertEqual(said, "searching 100.000 200.000\n")

    def test_core(self):
        self.check_core(self.install_core())

    @unittest.skipUnless(HAS_ROS, "built without ROS")
    def test_catkin_package(self):
        prefix = self.install_all()
        self.assertEqual(run(self.build("message_user", prefix)), "tag36h11 7 3\n")
        self.check_core(prefix)


if __name__ == "__main__":
    unittest.main()
