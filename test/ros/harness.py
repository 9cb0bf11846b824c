"""Feeds a running localizer the shipped bag image by image, so that no test depends on time."""

import os
import threading
import time
import xmlrpc.client
from typing import Dict, List, Optional, Tuple

import cv2
import numpy as np
import rosbag
import rosgraph
import rospy
import tf2_msgs.msg
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped, TransformStamped
from omnitag.msg import LocalizationStatus, MarkerDetectionArray
from rosgraph_msgs.msg import Log
from sensor_msgs.msg import CompressedImage, Image

PACKAGE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
BAG = os.path.join(PACKAGE, "bags", "paper.bag")
TRUTH = os.path.join(PACKAGE, "bags", "paper.tum")
IMAGE_TOPIC = "/camera/image"
TIMEOUT = 60.0  # s, for what must come; a test that passes does not wait for it

# odom in the map: the tests' odometry has no error, but another origin.
ODOM_X, ODOM_Y, ODOM_YAW = 1.5, -0.7, 0.6


def read_truth() -> Dict[rospy.Time, Tuple[float, float, float]]:
    """base_link in the map, (x, y, yaw) in m and rad, by stamp."""
    poses = {}
    with open(TRUTH, encoding="utf-8") as file:
        for line in file:
            fields = line.split()
            if not fields or line.startswith("#"):
                continue
            seconds, nanoseconds = fields[0].split(".")
            x, y, _, _, _, qz, qw = (float(field) for field in fields[1:8])
            poses[rospy.Time(int(seconds), int(nanoseconds))] = (x, y, 2.0 * np.arctan2(qz, qw))
    return poses


def yaw_of(orientation) -> float:
    """rad: angle of a rotation about z."""
    return 2.0 * np.arctan2(orientation.z, orientation.w)


def angle_between(a: float, b: float) -> float:
    """rad: absolute difference."""
    return abs((a - b + np.pi) % (2.0 * np.pi) - np.pi)


def odometry(stamp: rospy.Time, pose: Tuple[float, float, float]) -> TransformStamped:
    """odom -> base_link of a true pose."""
    x, y, yaw = pose
    dx, dy = x - ODOM_X, y - ODOM_Y
    transform = TransformStamped()
    transform.header.stamp = stamp
    transform.header.frame_id = "odom"
    transform.child_frame_id = "base_link"
    transform.transform.translation.x = np.cos(ODOM_YAW) * dx + np.sin(ODOM_YAW) * dy
    transform.transform.translation.y = -np.sin(ODOM_YAW) * dx + np.cos(ODOM_YAW) * dy
    transform.transform.rotation.z = np.sin((yaw - ODOM_YAW) / 2.0)
    transform.transform.rotation.w = np.cos((yaw - ODOM_YAW) / 2.0)
    return transform


def raw_image(compressed: CompressedImage, encoding: str = "mono8") -> Image:
    """The same image, decoded."""
    gray = cv2.imdecode(np.frombuffer(compressed.data, np.uint8), cv2.IMREAD_GRAYSCALE)
    pixels = gray if encoding == "mono8" else cv2.cvtColor(gray, cv2.COLOR_GRAY2BGR)
    return Image(header=compressed.header, height=gray.shape[0], width=gray.shape[1],
                 encoding=encoding, step=pixels.strides[0], data=pixels.tobytes())


class Topic:
    """Keeps all messages of a topic."""

    def __init__(self, name: str, message_type: type) -> None:
        self._changed = threading.Condition()
        self.messages: List = []
        self.subscriber = rospy.Subscriber(name, message_type, self._receive, queue_size=1000,
                                           buff_size=2 ** 24)

    def _receive(self, message) -> None:
        with self._changed:
            self.messages.append(message)
            self._changed.notify_all()

    def wait_for(self, predicate, timeout: float = TIMEOUT):
        """The first message that fulfils the predicate, received or yet to come; None if there is none
        in time."""

        def find():
            return next((message for message in self.messages if predicate(message)), None)

        with self._changed:
            self._changed.wait_for(lambda: find() is not None, timeout)
            return find()

    def at(self, stamp: rospy.Time, timeout: float = TIMEOUT):
        """The message with that stamp."""
        return self.wait_for(lambda message: message.header.stamp == stamp, timeout)


class Diagnostics(Topic):
    """What all nodes report about their health."""

    def __init__(self) -> None:
        super().__init__("/diagnostics", DiagnosticArray)

    def wait_for_report(self, task: str, level: int, *parts: str) -> None:
        """Waits until a task, given by the end of its name, newly reports a line with these parts."""
        start = len(self.messages)

        def reports() -> List[DiagnosticStatus]:
            return [status for message in self.messages[start:] for status in message.status
                    if status.name.endswith(task)]

        assert wait_until(lambda: any(
            report.level == level and all(part in report.message for part in parts)
            for report in reports())), (task, parts, [report.message for report in reports()[-3:]])


class LogTopic(Topic):
    """What all nodes log."""

    def __init__(self) -> None:
        super().__init__("/rosout", Log)

    def wait_for_line(self, level: int, part: str, start: int, timeout: float = TIMEOUT) -> bool:
        """Whether a line with this part came, or comes in time, after the first `start` ones."""
        return wait_until(lambda: any(line.level == level and part in line.msg
                                      for line in self.messages[start:]), timeout)


def read_bag() -> Tuple[List[CompressedImage], List]:
    """The images and the static transforms of the shipped bag."""
    images: List[CompressedImage] = []
    static_transforms: List = []
    with rosbag.Bag(BAG) as bag:
        for topic, message, _ in bag.read_messages():
            if topic == IMAGE_TOPIC + "/compressed":
                # As a message of this process's type, not of the bag's own copy of it.
                images.append(CompressedImage(header=message.header, format=message.format,
                                              data=message.data))
            elif topic == "/tf_static":
                static_transforms += message.transforms
    return images, static_transforms


class Harness:
    """Publishes the bag's images and transforms; keeps what the localizer publishes."""

    def __init__(self, transport: str) -> None:
        self.images, self.static_transforms = read_bag()
        self.truth = read_truth()
        self.poses = Topic("pose", PoseStamped)
        self.covariances = Topic("pose_with_covariance", PoseWithCovarianceStamped)
        self.status = Topic("status", LocalizationStatus)
        self.detections = Topic("detections", MarkerDetectionArray)
        self.transforms = Topic("/tf", tf2_msgs.msg.TFMessage)
        self._static_publisher = rospy.Publisher("/tf_static", tf2_msgs.msg.TFMessage, latch=True,
                                                 queue_size=1)
        self._tf_publisher = rospy.Publisher("/tf", tf2_msgs.msg.TFMessage, queue_size=1000)
        self._is_raw = transport == "raw"
        self._image_publisher = (rospy.Publisher(IMAGE_TOPIC, Image, queue_size=100)
                                 if self._is_raw else
                                 rospy.Publisher(IMAGE_TOPIC + "/compressed", CompressedImage,
                                                 queue_size=100))
        self._static_publisher.publish(self.static_transforms)
        assert wait_until(lambda: is_connected(
            self.poses.subscriber, self.covariances.subscriber, self.status.subscriber,
            self.detections.subscriber, self.transforms.subscriber, self._static_publisher,
            self._tf_publisher, self._image_publisher)), "the localizer did not start"

    def publish(self, image: CompressedImage) -> None:
        """Sends an image as the camera would."""
        self._image_publisher.publish(raw_image(image) if self._is_raw else image)

    def publish_any(self, image) -> None:
        """Sends a message of the image topic's type as it is."""
        self._image_publisher.publish(image)

    def publish_transform(self, transform) -> None:
        """Sends one transform on /tf."""
        self._tf_publisher.publish([transform])

    def localize(self, image: CompressedImage) -> Optional[LocalizationStatus]:
        """Sends an image and waits for its status."""
        self.publish(image)
        return self.status.at(image.header.stamp)

    def errors(self, pose: PoseStamped) -> Tuple[float, float]:
        """Distance (m) and angle (rad) from the true pose at its stamp."""
        x, y, yaw = self.truth[pose.header.stamp]
        distance = np.hypot(pose.pose.position.x - x, pose.pose.position.y - y)
        return distance, angle_between(yaw_of(pose.pose.orientation), yaw)

    def published_transforms(self) -> List:
        """What the localizer sent on /tf."""
        return [transform for message in self.transforms.messages
                for transform in message.transforms
                if transform.header.frame_id == "map"]


def is_connected(*ends) -> bool:
    """Whether publishers and subscribers of this process are connected to every node that the
    master knows at the other end of their topic, and that there is one."""
    publishers, subscribers, _ = rosgraph.Master(rospy.get_name()).getSystemState()
    for end in ends:
        if isinstance(end, rospy.Publisher):
            peers = dict(subscribers).get(end.resolved_name, [])
            connected = end.get_num_connections() >= len(peers)
        else:
            peers = dict(publishers).get(end.resolved_name, [])
            connected = all(publishes_to_this_node(peer, end.resolved_name) for peer in peers)
        if not peers or not connected:
            return False
    return True


def publishes_to_this_node(node: str, topic: str) -> bool:
    """Whether what a node publishes from now on comes here. Asks that node, because a subscriber
    counts its connections before they are made."""
    try:
        uri = rosgraph.Master(rospy.get_name()).lookupNode(node)
        _, _, connections = xmlrpc.client.ServerProxy(uri).getBusInfo(rospy.get_name())
    except (OSError, rosgraph.MasterException):
        return False
    return any(peer == rospy.get_name() and direction == "o" and name == topic
               for _, peer, direction, _, name, *_ in connections)


def wait_until(condition, timeout: float = TIMEOUT) -> bool:
    """Whether the condition came true in time: wall time, whatever /clock says."""
    deadline = time.monotonic() + timeout
    while not condition() and time.monotonic() < deadline and not rospy.is_shutdown():
        time.sleep(0.05)
    return condition()
