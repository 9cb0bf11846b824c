"""localize_bag: its results, their formats, and what it says about bad input."""

import copy
import csv
import os
import subprocess
import sys
import tempfile
import unittest

import cv2
import numpy as np
import rosbag
import rospy
from geometry_msgs.msg import TransformStamped
from sensor_msgs.msg import CompressedImage, Image
from tf2_msgs.msg import TFMessage

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from harness import (BAG, PACKAGE, angle_between, raw_image, read_truth,  # noqa: E402
                     yaw_of)
from omnitag.marker_map import load_marker_map  # noqa: E402

CAMERA = os.path.join(PACKAGE, "config", "cameras", "paper.yaml")
MAP = os.path.join(PACKAGE, "maps", "paper.yaml")
MANUAL = os.path.join(PACKAGE, "config", "localizer.yaml")
MOUNTING = "0.1,0.02,1.1,3.14159265,0,0.52359878"  # as in the bag
POSES_HEADER = ("stamp,x,y,yaw,cov_xx,cov_xy,cov_xyaw,cov_yy,cov_yyaw,cov_yawyaw,mode,"
                "markers_used,z,roll,pitch,cov_zz,cov_rollroll,cov_pitchpitch")
DETECTIONS_HEADER = ("stamp,id,family,name,map_entry,accepted,reason,bearing,range,residual,"
                     "u0,v0,u1,v1,u2,v2,u3,v3")


def first_pose():
    """X,Y,YAW of the bag's first image."""
    truth = read_truth()
    return "{:.4f},{:.4f},{:.4f}".format(*truth[min(truth)])


def read_bag(path):
    """(topic, message, time) of all messages."""
    with rosbag.Bag(path) as bag:
        return list(bag.read_messages())


def read_text(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def enlarged(message):
    """A compressed image with each pixel as a block of four."""
    pixels = cv2.imdecode(np.frombuffer(message.data, dtype=np.uint8), cv2.IMREAD_GRAYSCALE)
    larger = np.repeat(np.repeat(pixels, 2, axis=0), 2, axis=1)
    height, width = larger.shape
    return Image(header=message.header, height=height, width=width, encoding="mono8", step=width,
                 data=larger.tobytes())


class LocalizeBagTest(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.directory = directory.name

    def path(self, name):
        return os.path.join(self.directory, name)

    def run_tool(self, *arguments, **options):
        """Runs with the shipped files; an option that is None is left out."""
        values = {"camera": CAMERA, "map": MAP, "bag": BAG, "trajectory": self.path("out.tum"),
                  "initial_pose": first_pose()}
        values.update(options)
        command = ["rosrun", "omnitag", "localize_bag", *arguments]
        for name, value in values.items():
            for each in value if isinstance(value, list) else [value] * (value is not None):
                command += ["--" + name.replace("_", "-"), each]
        return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              universal_newlines=True, timeout=200, check=False)

    def assert_runs(self, *arguments, **options):
        result = self.run_tool(*arguments, **options)
        self.assertEqual(result.returncode, 0, result.stderr)
        return result

    def assert_refused(self, *parts, **options):
        """Expects status 1, nothing on standard output, one line on standard error with these parts."""
        result = self.run_tool(**options)
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertEqual(result.stdout, "")
        lines = result.stderr.splitlines()
        self.assertEqual(len(lines), 1, result.stderr)
        for part in ("localize_bag: ",) + parts:
            self.assertIn(part, lines[0])

    def write_bag(self, name, messages):
        """A bag of (topic, message, time)."""
        with rosbag.Bag(self.path(name), "w") as bag:
            for topic, message, time in messages:
                bag.write(topic, message, time)
        return self.path(name)

    def test_refines_a_taped_map(self):
        """Markers that hang 5 mm beside the map's places: the map as a whole stays off by their mean."""
        off, found = self.path("off.yaml"), self.path("found.yaml")
        subprocess.run([os.path.join(PACKAGE, "tools", "disturb_files"), "--map", MAP, "--output-map", off,
                        "--deviation", "0.005", "--orientation-deviation", "0.0175", "--seed", "3",
                        "--say"], check=True, stdout=subprocess.DEVNULL)
        with open(self.path("refine.yaml"), "w", encoding="utf-8") as file:
            file.write("refine_map: true\n")
        result = self.assert_runs(map=off, params=self.path("refine.yaml"), save_map=found)
        self.assertIn("markers refined:   17", result.stdout)
        truth = load_marker_map(MAP).markers
        before, after = ([np.subtract(marker.position, true.position)
                          for marker, true in zip(load_marker_map(path).markers, truth)]
                         for path in (off, found))
        within = [np.linalg.norm(errors - np.mean(errors, axis=0)) for errors in (before, after)]
        self.assertLess(within[1], 0.35 * within[0])
        for error, marker in zip(after, load_marker_map(found).markers):
            self.assertLess(np.abs(error).max(), 4.0 * marker.deviation, marker.id)
            self.assertLessEqual(marker.deviation, 0.005)
            self.assertLess(marker.orientation_deviation, 0.009)

    def test_several_cameras(self):
        """The images alternating between two topics, in separate bags; the first one on both."""
        messages = {"front": [], "back": []}
        count = 0
        for topic, message, time in read_bag(BAG):
            if topic != "/camera/image/compressed":
                messages["front"].append((topic, message, time))
                continue
            for name in ("front", "back") if count == 0 else (("front", "back")[count % 2],):
                messages[name].append(("/" + name + "/image/compressed", message, time))
            count += 1
        bags = [self.write_bag(name + ".bag", messages[name]) for name in ("front", "back")]
        rig = self.path("rig.yaml")
        with open(rig, "w", encoding="utf-8") as file:
            file.write("cameras:\n" + "".join(
                "  - {{name: {0}, camera_file: {1}, image: /{0}/image}}\n".format(name, CAMERA)
                for name in ("front", "back")))
        options = {"camera": None, "params": rig, "bag": bags}
        result = self.assert_runs(output=self.path("out.bag"), poses=self.path("poses.csv"),
                                  **options)
        self.assertIn("67 of 67 images", result.stderr)
        truth = read_truth()
        lines = [line.split(" ") for line in read_text(self.path("out.tum")).splitlines()]
        self.assertEqual([fields[0] for fields in lines],
                         ["{}.{:09d}".format(stamp.secs, stamp.nsecs) for stamp in sorted(truth)])
        for fields, stamp in zip(lines, sorted(truth)):
            self.assertLess(np.hypot(float(fields[1]) - truth[stamp][0],
                                     float(fields[2]) - truth[stamp][1]), 0.002)
        rows = list(csv.DictReader(read_text(self.path("poses.csv")).splitlines()))
        self.assertEqual(len(rows), 67)
        # Two images of the same moment tell more than one.
        self.assertLess(float(rows[1]["cov_xx"]), float(rows[0]["cov_xx"]))
        topics = {topic for topic, _, _ in read_bag(self.path("out.bag"))}
        self.assertLessEqual({"/front/debug_image/compressed", "/back/debug_image/compressed"},
                             topics)
        for option, value in (("camera", CAMERA), ("image_topic", "/front/image"),
                              ("mounting", MOUNTING)):
            self.assert_refused("--" + option.replace("_", "-"), "cameras",
                                **dict(options, **{option: value}))
        self.assert_refused("/front/image/compressed", "'/side/image'", **dict(
            options, params=self.written("side.yaml", read_text(rig).replace(
                "/back/image", "/side/image"))))

    def written(self, name, text):
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write(text)
        return self.path(name)

    def test_results(self):
        result = self.assert_runs(poses=self.path("poses.csv"),
                                  detections=self.path("detections.csv"))
        self.assertIn("66 of 66 images", result.stderr)
        summary = dict(line.split(":") for line in result.stdout.splitlines())
        self.assertEqual(summary["frames"].strip(), "66")
        self.assertEqual(summary["frames with pose"].strip(), "66")
        self.assertGreater(float(summary["markers per frame"]), 3.0)
        self.assertIn("99th percentile", summary["ms per frame"])

        truth = {"{}.{:09d}".format(stamp.secs, stamp.nsecs): pose
                 for stamp, pose in read_truth().items()}
        lines = [line.split(" ") for line in read_text(self.path("out.tum")).splitlines()]
        self.assertEqual([fields[0] for fields in lines], sorted(truth))
        for fields in lines:
            self.assertEqual(len(fields), 8)
            x, y, z, qx, qy, qz, qw = (float(field) for field in fields[1:])
            self.assertEqual((z, qx, qy), (0.0, 0.0, 0.0))
            self.assertAlmostEqual(qz ** 2 + qw ** 2, 1.0, 8)
            true_x, true_y, _ = truth[fields[0]]
            self.assertLess(abs(x - true_x) + abs(y - true_y), 0.02)

        poses = read_text(self.path("poses.csv")).splitlines()
        self.assertEqual(poses[0], POSES_HEADER)
        self.assertEqual(len(poses), 67)
        for row, fields in zip(csv.DictReader(poses), lines):
            self.assertEqual(row["stamp"], fields[0])
            self.assertAlmostEqual(float(row["x"]), float(fields[1]), 9)
            self.assertEqual(row["mode"], "tracking")
            self.assertGreater(float(row["cov_xx"]), 0.0)
            self.assertGreaterEqual(int(row["markers_used"]), 3)

        detections = read_text(self.path("detections.csv")).splitlines()
        self.assertEqual(detections[0], DETECTIONS_HEADER)
        names = {}
        for row in csv.DictReader(detections):
            self.assertIn(row["accepted"], ("0", "1"))
            self.assertEqual(row["accepted"] == "1", row["reason"] == "")
            self.assertTrue(0.0 <= float(row["u0"]) < 500.0)
            if row["accepted"] == "1":
                names[row["map_entry"]] = row["name"]
                self.assertEqual(row["id"], row["map_entry"])
        self.assertEqual(names["0"], "north west")

    def test_same_result_every_time(self):
        files = []
        for run in ("first", "second"):
            self.assert_runs(trajectory=self.path(run + ".tum"), poses=self.path(run + ".poses"),
                             detections=self.path(run + ".detections"))
            files.append([read_text(self.path(run + ending))
                          for ending in (".tum", ".poses", ".detections")])
        self.assertEqual(files[0], files[1])

    def test_params(self):
        self.assert_runs(params=MANUAL)
        with_manual = read_text(self.path("out.tum"))
        self.assert_runs()
        self.assertEqual(with_manual, read_text(self.path("out.tum")))
        with open(self.path("params.yaml"), "w", encoding="utf-8") as file:
            file.write("estimator: triangulation\n")
        self.assert_runs(params=self.path("params.yaml"))
        self.assertNotEqual(with_manual, read_text(self.path("out.tum")))

    def test_options_override_params_where_they_are_given(self):
        wrong = self.path("no_such_file.yaml")
        params = self.path("params.yaml")

        def first_mode(camera_file, pose, **options):
            with open(params, "w", encoding="utf-8") as file:
                file.write(f"camera_file: {camera_file}\nmap_file: {wrong}\n"
                           f"initial_pose: [{pose}]\n")
            self.assert_runs(params=params, poses=self.path("poses.csv"), **options)
            rows = csv.DictReader(read_text(self.path("poses.csv")).splitlines())
            return next(iter(rows))["mode"]

        self.assertEqual(first_mode(CAMERA, first_pose(), camera=None, initial_pose=None),
                         "tracking")
        self.assertEqual(first_mode(wrong, "100, 100, 0"), "tracking")

    def test_without_initial_pose_every_frame_has_a_row(self):
        self.assert_runs(initial_pose=None, poses=self.path("poses.csv"))
        rows = list(csv.DictReader(read_text(self.path("poses.csv")).splitlines()))
        self.assertEqual(len(rows), 66)
        self.assertEqual(rows[0]["mode"], "found")
        self.assertEqual(rows[1]["mode"], "tracking")

    def test_output_bag(self):
        stale = TransformStamped()
        stale.header.frame_id, stale.child_frame_id = "map", "base_link"
        stale.header.stamp = rospy.Time(1000, 1)
        stale.transform.rotation.w = 1.0
        other = TransformStamped()
        other.header.frame_id, other.child_frame_id = "base_link", "wheel"
        other.header.stamp = rospy.Time(1000, 1)
        other.transform.rotation.w = 1.0
        messages = read_bag(BAG)
        time = messages[0][2]
        source = self.write_bag("in.bag", messages + [("/tf", TFMessage([stale, other]), time),
                                                      ("/pose", messages[-1][1], time)])
        self.assert_runs(bag=source, image_topic="/camera/image", output=self.path("out.bag"))
        topics = {}
        for topic, message, time in read_bag(self.path("out.bag")):
            topics.setdefault(topic, []).append(message)
        for topic in ("/camera/image/compressed", "/ground_truth/pose", "/pose",
                      "/pose_with_covariance", "/pose_measured", "/detections", "/status",
                      "/debug_image/compressed"):
            self.assertEqual(len(topics[topic]), 66, topic)
        (marker_map,) = topics["/marker_map"]
        self.assertEqual(len(marker_map.markers), 17)
        for array in topics["/detections"]:
            for detection in array.detections:
                self.assertEqual(marker_map.markers[detection.map_entry].name, detection.name)
                self.assertGreater(detection.pose.covariance[0], 0.0)
        with rosbag.Bag(self.path("out.bag")) as bag:
            headers = {connection.topic: connection.header
                       for connection in bag._get_connections()}  # pylint: disable=W0212
        for topic in ("/marker_map", "/path"):
            self.assertEqual(headers[topic]["latching"], b"1", topic)
        self.assertEqual(len(topics["/tf_static"]), 1)
        self.assertEqual({pose._type for pose in topics["/pose"]}, {"geometry_msgs/PoseStamped"})
        transforms = [t for message in topics["/tf"] for t in message.transforms]
        self.assertEqual(len([t for t in transforms if t.child_frame_id == "wheel"]), 1)
        poses = {pose.header.stamp: pose for pose in topics["/pose"]}
        own = [t for t in transforms if t.header.frame_id == "map"]
        self.assertEqual(len(own), 66)
        for transform in own:
            pose = poses[transform.header.stamp].pose
            self.assertAlmostEqual(transform.transform.translation.x, pose.position.x, 12)
            self.assertLess(angle_between(yaw_of(transform.transform.rotation),
                                          yaw_of(pose.orientation)), 1e-9)

    def test_output_changes_no_result(self):
        self.assert_runs()
        expected = read_text(self.path("out.tum"))
        self.assert_runs(output=self.path("out.bag"))
        self.assertEqual(read_text(self.path("out.tum")), expected)
        # The output is a recording, too; its debug images are not images of the camera.
        self.assert_runs(bag=self.path("out.bag"), output=self.path("again.bag"))
        self.assertEqual(read_text(self.path("out.tum")), expected)
        counts = [len([1 for topic, _, _ in read_bag(self.path(name)) if topic != "/tf"])
                  for name in ("out.bag", "again.bag")]
        self.assertEqual(*counts)

    def test_several_bags(self):
        self.assert_runs(poses=self.path("all.csv"))
        expected = read_text(self.path("all.csv"))
        messages = read_bag(BAG)
        middle = len(messages) // 2
        first = self.write_bag("first.bag", messages[:middle])
        second = self.write_bag("second.bag", messages[middle:])
        self.assertNotIn("/tf_static", [topic for topic, _, _ in messages[middle:]])
        self.assert_runs(bag=[first, second], poses=self.path("poses.csv"))
        self.assertEqual(read_text(self.path("poses.csv")), expected)

        # In the given order, whenever they were recorded.
        result = self.assert_runs(bag=[second, first], poses=self.path("poses.csv"),
                                  initial_pose=None)
        self.assertIn("stamps went back", result.stderr)
        stamps = [line.split(",")[0] for line in read_text(self.path("poses.csv")).splitlines()]
        self.assertEqual(len(stamps), 67)
        self.assertGreater(stamps[1], stamps[-1])

        # Images in one and transforms in another.
        images = self.write_bag("images.bag", [each for each in messages if "image" in each[0]])
        others = self.write_bag("others.bag", [each for each in messages if "image" not in each[0]])
        self.assert_runs(bag=[images, others], poses=self.path("poses.csv"))
        self.assertEqual(read_text(self.path("poses.csv")), expected)
        self.assert_refused("is an input", bag=[first, second], output=second)
        self.assert_refused("missing", bag=[first, self.path("missing")])

    def test_a_part_of_a_bag(self):
        messages = read_bag(BAG)
        start = messages[0][2]
        images = [(message.header.stamp, (time - start).to_sec())
                  for topic, message, time in messages if "image" in topic]
        self.assertGreater(images[0][1], -1.0)
        expected = [stamp for stamp, time in images if 1.5 <= time <= 3.25]
        self.assertTrue(2 < len(expected) < len(images) - 2)
        self.assert_runs("--from", "1.5", "--until", "3.25", initial_pose=None,
                         poses=self.path("poses.csv"), output=self.path("out.bag"))
        rows = list(csv.DictReader(read_text(self.path("poses.csv")).splitlines()))
        self.assertEqual([row["stamp"] for row in rows],
                         ["{}.{:09d}".format(stamp.secs, stamp.nsecs) for stamp in expected])
        # The output has the mounting, although it was sent before the part begins.
        written = read_bag(self.path("out.bag"))
        self.assertEqual([topic for topic, _, _ in written].count("/tf_static"), 1)
        self.assertLessEqual(max((time - start).to_sec() for _, _, time in written), 3.25)
        self.assertGreaterEqual(min((time - start).to_sec() for _, _, time in written), 1.5)

        self.assert_refused("--from, --until: expected a part of the recording with images",
                            **{"from": "1000"})
        self.assert_refused("--from: expected seconds", **{"from": "-1"})
        self.assert_refused("--until: expected seconds", until="nan")
        self.assert_refused("--until: expected no less than --from", until="1", **{"from": "2"})

    def test_rectified_images_beside_others(self):
        self.assert_runs()
        expected = read_text(self.path("out.tum"))
        messages = []
        for topic, message, time in read_bag(BAG):
            messages.append((topic.replace("/camera/image", "/camera/image_rect"), message, time))
            if "image" in topic:
                small = Image(header=message.header, height=1, width=1, step=1, encoding="mono8",
                              data=bytes(1))
                messages.append(("/camera/image_raw", small, time))
        bag = self.write_bag("rectified.bag", messages)
        self.assert_refused("/camera/image_raw, /camera/image_rect/compressed", bag=bag)
        self.assert_runs(bag=bag, image_topic="/camera/image_rect")
        self.assertEqual(read_text(self.path("out.tum")), expected)

    def test_output_bag_has_one_parent_for_the_robot(self):
        odometry = TransformStamped()
        odometry.header.frame_id, odometry.child_frame_id = "odom", "base_link"
        odometry.header.stamp = rospy.Time(1000, 1)
        odometry.transform.rotation.w = 1.0
        messages = read_bag(BAG)
        source = self.write_bag("in.bag", messages + [("/tf", TFMessage([odometry]),
                                                       messages[0][2])])
        result = self.assert_runs(bag=source, output=self.path("out.bag"))
        self.assertIn("tf has 'odom' as the parent of 'base_link'", result.stderr)
        self.assertIn("odom_frame", result.stderr)
        written = read_bag(self.path("out.bag"))
        self.assertEqual([t.header.frame_id for topic, message, _ in written if topic == "/tf"
                          for t in message.transforms], ["odom"])
        self.assertEqual(len([1 for topic, _, _ in written if topic == "/pose"]), 66)

    def test_raw_and_compressed_images_give_the_same(self):
        self.assert_runs(image_topic="camera/image/compressed")
        compressed = read_text(self.path("out.tum"))
        raw = self.write_bag("raw.bag", [
            ("/camera/image", raw_image(message), time) if topic.startswith("/camera/image") else
            (topic, message, time) for topic, message, time in read_bag(BAG)])
        self.assert_runs(bag=raw)
        self.assertEqual(compressed, read_text(self.path("out.tum")))

    def test_skips_images_that_are_no_images(self):
        messages = read_bag(BAG)
        first, torn = [i for i, (topic, _, _) in enumerate(messages) if "image" in topic][:11:10]
        messages[torn][1].data = messages[torn][1].data[:40]
        result = self.assert_runs(bag=self.write_bag("torn.bag", messages),
                                  poses=self.path("poses.csv"))
        self.assertIn("cannot be decoded", result.stderr)
        self.assertIn("unusable frames:   1", result.stdout)
        self.assertEqual(len(read_text(self.path("poses.csv")).splitlines()), 67)

        messages[first][1].data = b"123"
        result = self.assert_runs(bag=self.write_bag("torn.bag", messages), mounting=MOUNTING)
        self.assertIn("unusable frames:   2", result.stdout)

    def test_mounting_replaces_what_the_bag_says(self):
        self.assert_runs(mounting=MOUNTING)
        expected = read_text(self.path("out.tum"))
        messages = read_bag(BAG)
        mounting = next(message for topic, message, _ in messages if topic == "/tf_static")
        mounting.transforms[0].transform.translation.x += 0.5
        for parent in ("base_link", "mast"):
            moving = [each for each in messages if each[0] != "/tf_static"]
            for _, message, time in [each for each in moving if "image" in each[0]]:
                transform = copy.deepcopy(mounting.transforms[0])
                transform.header.stamp = message.header.stamp
                transform.header.frame_id = parent
                moving.append(("/tf", TFMessage([transform]), time))
            self.assert_runs(bag=self.write_bag("moving.bag", moving), mounting=MOUNTING,
                             image_topic="/camera/image")
            self.assertEqual(read_text(self.path("out.tum")), expected)

    def test_missing_odometry_is_reported(self):
        result = self.assert_runs(odom_frame="odom")
        self.assertIn("from 'base_link' to 'odom'", result.stderr)
        self.assertIn("without odometry:  66", result.stdout)

    def test_camera_info_instead_of_a_camera_file(self):
        fisheye = os.path.join(PACKAGE, "config", "cameras", "fisheye.yaml")
        fisheye_map = os.path.join(PACKAGE, "maps", "fisheye.yaml")
        bag = self.path("fisheye.bag")
        subprocess.run([sys.executable, os.path.join(PACKAGE, "tools", "render_sequence"),
                        "--camera", fisheye,
                        "--world", os.path.join(PACKAGE, "worlds", "fisheye.yaml"),
                        "--trajectory", os.path.join(PACKAGE, "worlds", "paper_route.csv"),
                        "--frames", "0:1", "--output", bag], stderr=subprocess.PIPE, check=True)
        true_pose = read_truth()[min(read_truth())]

        def assert_finds_its_pose(camera, images=bag):
            self.assert_runs(camera=camera, map=fisheye_map, bag=images, initial_pose=None)
            x, y = (float(field) for field in read_text(self.path("out.tum")).split()[1:3])
            self.assertLess(abs(x - true_pose[0]) + abs(y - true_pose[1]), 2e-3, camera)

        for camera in (None, fisheye):
            assert_finds_its_pose(camera)
        for kind in ("omnitag", "kalibr", "opencv", "camera_info", "ocam"):
            converted = self.path("fisheye." + kind)
            subprocess.run(["rosrun", "omnitag", "convert_camera", fisheye, converted,
                            "--to", kind], stdout=subprocess.PIPE, check=True)
            assert_finds_its_pose(converted + ("#cam0" if kind == "kalibr" else ""))

        # Each pixel becomes four: only a camera that may be scaled fits them.
        larger = self.write_bag("larger.bag", [
            ("/camera/image", enlarged(message), time) if topic == "/camera/image/compressed"
            else (topic, message, time) for topic, message, time in read_bag(bag)])
        self.assertIn("the image has 1000 x 1000 pixels, expected 500 x 500 pixels",
                      self.run_tool(camera=fisheye, map=fisheye_map, bag=larger).stderr)
        scalable = self.path("scalable.yaml")
        with open(scalable, "w", encoding="utf-8") as file:
            file.write(read_text(fisheye) + "\nscale_to_image: true\n")
        assert_finds_its_pose(scalable, larger)
        assert_finds_its_pose(scalable)

        def spoil(message):
            message.K = [0.0] * 9
            return message

        messages = read_bag(bag)
        empty = self.write_bag("empty.bag", [
            (topic, spoil(message) if topic.endswith("camera_info") else message, time)
            for topic, message, time in messages])
        self.assert_refused("empty.bag: /camera/camera_info: K: expected", camera=None,
                            map=fisheye_map, bag=empty)
        without = self.write_bag("without.bag", [
            each for each in messages if not each[0].endswith("camera_info")])
        self.assert_refused("without.bag: expected camera_info on /camera/camera_info", "--camera",
                            camera=None, map=fisheye_map, bag=without)

    def test_help(self):
        result = subprocess.run(["rosrun", "omnitag", "localize_bag", "--help"],
                                stdout=subprocess.PIPE, universal_newlines=True, check=True)
        for option in ("camera", "map", "bag", "trajectory", "image-topic", "initial-pose",
                       "odom-frame", "params", "poses", "detections", "output", "from", "until"):
            self.assertIn("--" + option, result.stdout)

    def test_bad_options(self):
        for name in ("camera", "map", "bag", "trajectory"):
            self.assert_refused("--" + name, **{name: None})
        for pose in ("", "1", "1,2", "1,2,3,4", "1,2,x", "nan,0,0", "1 2 3"):
            self.assert_refused("--initial-pose", "X,Y,YAW", initial_pose=pose)
        self.assert_refused("no-such-option", no_such_option="1")

    def test_bad_files(self):
        missing = self.path("missing")
        with open(self.path("text"), "w", encoding="utf-8") as file:
            file.write("camera_fil: x\n")
        text = self.path("text")
        for name in ("camera", "map", "bag", "params"):
            self.assert_refused(missing, **{name: missing})
            self.assert_refused(text, **{name: text})
        for name in ("trajectory", "poses", "detections", "output"):
            self.assert_refused("/no/such/directory", **{name: "/no/such/directory/file"})
        self.assert_refused("would be overwritten", trajectory=BAG)
        self.assert_refused("--poses", poses=self.path("out.tum"))

    def test_bad_bags(self):
        messages = read_bag(BAG)
        images = [(topic, message, time) for topic, message, time in messages if "image" in topic]
        transforms = [m for m in messages if m[0] == "/tf_static"]

        with open(BAG, "rb") as file:
            content = file.read()
        with open(self.path("cut.bag"), "wb") as file:
            file.write(content[:len(content) // 2])
        self.assert_refused("cut.bag", bag=self.path("cut.bag"))

        self.assert_refused("has no images", bag=self.write_bag("none.bag", transforms))
        self.assert_refused("--image-topic", "/camera/image/compressed", "'/other'",
                            image_topic="/other")
        two = self.write_bag("two.bag", transforms + images[:2] + [
            ("/rear/image/compressed", message, time) for _, message, time in images[:2]])
        self.assert_refused("/camera/image/compressed, /rear/image/compressed", bag=two)
        self.assert_runs(bag=two, image_topic="/camera/image")

        self.assert_refused_in_the_end("from 'camera_optical_frame' to 'base_link'",
                                       self.write_bag("still.bag", images[:2]))
        small = Image(header=images[0][1].header, height=10, width=20, step=20, encoding="mono8",
                      data=bytes(200))
        self.assert_refused_in_the_end(
            "20 x 10 pixels, expected 500 x 500 pixels",
            self.write_bag("small.bag", transforms + [("/image", small, images[0][2])]))
        broken = CompressedImage(header=images[0][1].header, format="jpeg", data=b"123")
        self.assert_refused_in_the_end(
            "cannot be decoded",
            self.write_bag("broken.bag", transforms + [("/image/compressed", broken,
                                                        images[0][2])]))

    def assert_refused_in_the_end(self, part, bag):
        """Expects status 1, and a last line that names the bag and the reason."""
        result = self.run_tool(bag=bag)
        self.assertEqual(result.returncode, 1)
        self.assertEqual(result.stdout, "")
        last = result.stderr.splitlines()[-1]
        self.assertIn(bag + ": no image could be used: ", last)
        self.assertIn(part, last)


if __name__ == "__main__":
    unittest.main()
