"""Every YAML, launch and RViz file that is shipped can be loaded."""

import glob
import os
import subprocess
import sys
import tempfile
import unittest

import rosbag
import roslaunch
import yaml

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from harness import BAG, PACKAGE  # noqa: E402

ARGUMENTS = {
    "localize.launch": ["camera_file:=camera.yaml", "map_file:=map.yaml"],
    "replay.launch": ["camera_file:=camera.yaml", "map_file:=map.yaml", "bag:=in.bag"],
    "demo.launch": [],
    "ekf.launch": ["camera_file:=camera.yaml", "map_file:=map.yaml"],
}


def shipped(*parts):
    """The files that match a pattern below the package; there is one at least."""
    paths = sorted(glob.glob(os.path.join(PACKAGE, *parts), recursive=True))
    assert paths, parts
    return paths


def load_launch_file(path, arguments):
    """The nodes of a launch file by name, and its parameters."""
    config = roslaunch.config.ROSLaunchConfig()
    roslaunch.xmlloader.XmlLoader(resolve_anon=True).load(path, config, argv=arguments,
                                                          verbose=False)
    config.assign_machines()
    return ({node.name: node for node in config.nodes},
            {name: parameter.value for name, parameter in config.params.items()})


class ShippedFilesTest(unittest.TestCase):
    def test_cameras_and_maps(self):
        """The localizer itself loads each; the bag ends before an image is asked for."""
        cameras = shipped("config", "cameras", "*.yaml")
        maps = shipped("maps", "*.yaml")
        with tempfile.TemporaryDirectory() as directory:
            bag = os.path.join(directory, "empty.bag")
            with rosbag.Bag(bag, "w"):
                pass
            pairs = [(camera, maps[0]) for camera in cameras]
            pairs += [(cameras[0], marker_map) for marker_map in maps]
            for camera, marker_map in pairs:
                result = subprocess.run(
                    ["rosrun", "omnitag", "localize_bag", "--camera", camera, "--map", marker_map,
                     "--bag", bag, "--trajectory", os.path.join(directory, "out.tum")],
                    stderr=subprocess.PIPE, universal_newlines=True, check=False)
                self.assertIn("empty.bag: has no images", result.stderr)

    def test_yaml_files(self):
        for folder in ("config", "maps", "worlds"):
            for path in shipped(folder, "**", "*.yaml"):
                with self.subTest(path), open(path, encoding="utf-8") as file:
                    self.assertIsInstance(yaml.safe_load(file), dict)

    def test_launch_files(self):
        paths = shipped("launch", "*.launch")
        self.assertEqual({os.path.basename(path) for path in paths}, set(ARGUMENTS))
        for path in paths:
            for rviz in ("true", "false"):
                with self.subTest(path, rviz=rviz):
                    nodes, parameters = load_launch_file(
                        path, ARGUMENTS[os.path.basename(path)] + ["rviz:=" + rviz])
                    self.assertIn("localizer", nodes)
                    self.assertEqual("rviz" in nodes, rviz == "true")
                    self.assertIn("/localizer/camera_file", parameters)

    def test_localize_launch_hands_its_arguments_on(self):
        path = shipped("launch", "localize.launch")[0]
        nodes, parameters = load_launch_file(path, [
            "camera_file:=c.yaml", "map_file:=m.yaml", "manager:=camera_manager",
            "odom_frame:=odom", "base_frame:=base", "map_frame:=hall", "image:=/front/image",
            "image_transport:=compressed", "initial_pose:=[1, 2.5, -3]", "queue_size:=7"])
        self.assertEqual(nodes["localizer"].args, "load omnitag/LocalizerNodelet camera_manager")
        self.assertIn(("image", "/front/image"),
                      [tuple(remap) for remap in nodes["localizer"].remap_args])
        expected = {"camera_file": "c.yaml", "map_file": "m.yaml", "odom_frame": "odom",
                    "base_frame": "base", "map_frame": "hall", "image_transport": "compressed",
                    "initial_pose": [1, 2.5, -3], "queue_size": 7}
        for name, value in expected.items():
            self.assertEqual(parameters["/localizer/" + name], value)

    def test_ekf_launch_leaves_tf_to_the_filter(self):
        path = shipped("launch", "ekf.launch")[0]
        nodes, parameters = load_launch_file(path, ["map_file:=m.yaml", "odom:=/wheels"])
        self.assertIs(parameters["/localizer/publish_tf"], False)
        self.assertEqual(parameters["/localizer/odom_frame"], "odom")
        # What the filter fuses is published under these names.
        filter_node = nodes["ekf_localization"]
        self.assertEqual(parameters["/ekf_localization/pose0"], "pose_measured")
        self.assertIn((parameters["/ekf_localization/odom0"], "/wheels"),
                      [tuple(remap) for remap in filter_node.remap_args])
        # Where it is not installed, a line says so and nothing fails.
        result = subprocess.run(["rosrun", "omnitag", filter_node.type, "no_such_package", "node"],
                                stderr=subprocess.PIPE, universal_newlines=True, check=True)
        self.assertIn("'no_such_package' is not installed", result.stderr)

    def test_localize_launch_takes_what_is_not_given_from_the_file(self):
        path = shipped("launch", "localize.launch")[0]
        with tempfile.NamedTemporaryFile("w", suffix=".yaml") as file:
            yaml.safe_dump({"camera_file": "c.yaml", "odom_frame": "wheels"}, file)
            file.flush()
            for arguments, expected in (([], "c.yaml"), (["camera_file:=d.yaml"], "d.yaml")):
                _, parameters = load_launch_file(
                    path, ["map_file:=m.yaml", "params:=" + file.name] + arguments)
                self.assertEqual(parameters["/localizer/camera_file"], expected)
                self.assertEqual(parameters["/localizer/odom_frame"], "wheels")

    def test_rviz_shows_what_is_published(self):
        for path in shipped("config", "rviz", "*.rviz"):
            with open(path, encoding="utf-8") as file:
                manager = yaml.safe_load(file)["Visualization Manager"]
            topics = set()
            for display in manager["Displays"]:
                topics |= {display.get(key) for key in ("Marker Topic", "Topic", "Image Topic")}
            self.assertEqual(topics - {None}, {"/markers", "/path", "/debug_image"})
            self.assertEqual(manager["Global Options"]["Fixed Frame"], "map")

    def test_the_demo_starts_where_the_bag_does(self):
        _, parameters = load_launch_file(shipped("launch", "demo.launch")[0], [])
        with open(os.path.splitext(BAG)[0] + ".tum", encoding="utf-8") as file:
            first = next(line for line in file if not line.startswith("#")).split()
        x, y, _ = parameters["/localizer/initial_pose"]
        self.assertAlmostEqual(x, float(first[1]), 3)
        self.assertAlmostEqual(y, float(first[2]), 3)


if __name__ == "__main__":
    unittest.main()
