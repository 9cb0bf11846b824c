"""Every YAML, launch and RViz file that is shipped can be loaded."""

import ast
import glob
import json
import os
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

import numpy as np
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
    "example_robot.launch": [],
}


def shipped(*parts):
    """The files that match a pattern below the package; there must be at least one."""
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
                    self.assertEqual("rviz" in nodes, rviz == "true")
                    if os.path.basename(path) == "example_robot.launch":
                        self.assertIn("/robot_description", parameters)
                        continue
                    self.assertIn("localizer", nodes)
                    self.assertIn("/localizer/camera_file", parameters)
                    # Whatever sets it takes it back.
                    self.assertEqual("/use_sim_time" in parameters, "take_back_sim_time" in nodes)

    def test_localize_launch_hands_its_arguments_on(self):
        path = shipped("launch", "localize.launch")[0]
        nodes, parameters = load_launch_file(path, [
            "camera_file:=c.yaml", "map_file:=m.yaml", "manager:=camera_manager",
            "odom_frame:=odom", "base_frame:=base", "map_frame:=hall", "image:=/front/image",
            "image_transport:=compressed", "initial_pose:=[1, 2.5, -3]", "queue_size:=7",
            "camera_info:=/front/info", "transform_tolerance:=0.3", "output:=log",
            "respawn:=true"])
        self.assertEqual(nodes["localizer"].args, "load omnitag/LocalizerNodelet camera_manager")
        remappings = [tuple(remap) for remap in nodes["localizer"].remap_args]
        self.assertIn(("image", "/front/image"), remappings)
        self.assertIn(("camera_info", "/front/info"), remappings)
        self.assertTrue(nodes["localizer"].respawn)
        self.assertEqual(nodes["localizer"].output, "log")
        expected = {"camera_file": "c.yaml", "map_file": "m.yaml", "odom_frame": "odom",
                    "base_frame": "base", "map_frame": "hall", "image_transport": "compressed",
                    "initial_pose": [1, 2.5, -3], "queue_size": 7, "transform_tolerance": 0.3}
        for name, value in expected.items():
            self.assertEqual(parameters["/localizer/" + name], value)

    def test_localize_launch_in_a_namespace(self):
        for name in ("localize.launch", "ekf.launch"):
            path = shipped("launch", name)[0]
            nodes, parameters = load_launch_file(path, ["map_file:=m.yaml", "ns:=front"])
            self.assertEqual({node.namespace for node in nodes.values()}, {"/front/"})
            self.assertEqual(parameters["/front/localizer/map_file"], "m.yaml")
        self.assertIn(("image", "camera/image_raw"),
                      [tuple(remap) for remap in nodes["localizer"].remap_args])

    def test_replay_launch_hands_bags_on(self):
        nodes, _ = load_launch_file(shipped("launch", "replay.launch")[0], [
            "map_file:=m.yaml", "bag:=a.bag b.bag", "loop:=true", "pause:=true", "start:=5"])
        arguments = nodes["player"].args.split()
        self.assertEqual(arguments[:2], ["a.bag", "b.bag"])
        self.assertLess({"--loop", "--pause", "--clock"}, set(arguments))
        self.assertEqual(arguments[arguments.index("--start") + 1], "5")

    def test_the_example_robot_has_the_camera_of_the_bag(self):
        robot = xml.etree.ElementTree.parse(shipped("urdf", "example_robot.urdf")[0]).getroot()
        joint = robot.find("joint[@name='camera_optical_joint']")
        with rosbag.Bag(BAG) as bag:
            transform = next(message.transforms[0] for _, message, _ in
                             bag.read_messages(topics=["/tf_static"]))
        self.assertEqual(joint.find("parent").get("link"), transform.header.frame_id)
        self.assertEqual(joint.find("child").get("link"), transform.child_frame_id)
        place, turn = ([float(word) for word in joint.find("origin").get(key).split()]
                       for key in ("xyz", "rpy"))
        expected = transform.transform
        np.testing.assert_allclose(place, [expected.translation.x, expected.translation.y,
                                           expected.translation.z], atol=1e-9)
        roll, pitch, yaw = 0.5 * np.array(turn)
        # Rz Ry Rx, with no pitch.
        self.assertEqual(pitch, 0.0)
        quaternion = [np.cos(yaw) * np.sin(roll), np.sin(yaw) * np.sin(roll),
                      np.sin(yaw) * np.cos(roll), np.cos(yaw) * np.cos(roll)]
        rotation = expected.rotation
        self.assertAlmostEqual(abs(np.dot(quaternion, [rotation.x, rotation.y, rotation.z,
                                                       rotation.w])), 1.0, 12)
        # The mesh that it draws exists.
        meshes = [mesh.get("filename") for mesh in robot.iter("mesh")]
        self.assertEqual(len(meshes), 1)
        self.assertTrue(os.path.exists(meshes[0].replace("package://omnitag", PACKAGE)))

    def test_the_example_robot_is_what_xacro_makes(self):
        try:
            import xacro  # pylint: disable=import-outside-toplevel
        except ImportError:
            self.skipTest("xacro is not installed")

        def elements(root):
            return [(each.tag, sorted(each.attrib.items())) for each in root.iter()]

        path = shipped("urdf", "example_robot.urdf")[0]
        made = xml.etree.ElementTree.fromstring(xacro.process_file(path + ".xacro").toxml())
        self.assertEqual(elements(xml.etree.ElementTree.parse(path).getroot()), elements(made))

    def test_rqt_shows_what_is_published(self):
        from omnitag.msg import LocalizationStatus  # pylint: disable=import-outside-toplevel
        with open(shipped("config", "rqt", "*.perspective")[0], encoding="utf-8") as file:
            manager = json.load(file)["groups"]["pluginmanager"]
        running = ast.literal_eval(manager["keys"]["running-plugins"]["repr"])
        plugins = {"plugin__{}__{}".format(name.replace("/", "__"), serial)
                   for name, serials in running.items() for serial in serials}
        self.assertEqual(plugins, set(manager["groups"]))
        topics = []
        for name in sorted(plugins):
            settings = manager["groups"][name]["groups"]["plugin"]["keys"]
            topics += [settings["topic"]] if "topic" in settings else []
            topics += [settings["topics"]] if "topics" in settings else []
        shown = [ast.literal_eval(topic["repr"]) for topic in topics]
        self.assertEqual(shown[0], "/debug_image")
        for (plotted,) in shown[1:]:
            topic, field = plotted.rsplit("/", 1)
            self.assertEqual(topic, "/status")
            self.assertIn(field, LocalizationStatus.__slots__)

    def test_ekf_launch_leaves_tf_to_the_filter(self):
        path = shipped("launch", "ekf.launch")[0]
        nodes, parameters = load_launch_file(path, ["map_file:=m.yaml", "odom:=/wheels"])
        self.assertIs(parameters["/localizer/publish_tf"], False)
        self.assertEqual(parameters["/localizer/odom_frame"], "odom")
        # The localizer publishes what the filter fuses under these names.
        filter_node = nodes["ekf_localization"]
        self.assertEqual(parameters["/ekf_localization/pose0"], "pose_measured")
        self.assertIn((parameters["/ekf_localization/odom0"], "/wheels"),
                      [tuple(remap) for remap in filter_node.remap_args])
        # If it is not installed, a line says so and nothing fails.
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
        for name, frame, shown in (("omnitag", "map", {"markers", "path", "debug_image"}),
                                   ("robot", "base_link", set())):
            path = shipped("config", "rviz", name + ".rviz")[0]
            with open(path, encoding="utf-8") as file:
                manager = yaml.safe_load(file)["Visualization Manager"]
            topics = set()
            for display in manager["Displays"]:
                topics |= {display.get(key) for key in ("Marker Topic", "Topic", "Image Topic")}
            self.assertEqual(topics - {None}, shown)
            self.assertEqual(manager["Global Options"]["Fixed Frame"], frame)
            # The view follows the robot.
            self.assertEqual(manager["Views"]["Current"]["Target Frame"], "base_link")

    def test_the_demo_starts_where_the_bag_does(self):
        _, parameters = load_launch_file(shipped("launch", "demo.launch")[0], [])
        with open(os.path.splitext(BAG)[0] + ".tum", encoding="utf-8") as file:
            first = next(line for line in file if not line.startswith("#")).split()
        x, y, _ = parameters["/localizer/initial_pose"]
        self.assertAlmostEqual(x, float(first[1]), 3)
        self.assertAlmostEqual(y, float(first[2]), 3)


if __name__ == "__main__":
    unittest.main()
