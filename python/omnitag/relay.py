"""Detections in the messages of other marker packages, so that nodes for docking or mapping that use
these work unchanged. The message types are looked up when the node starts: none of them is required."""

import importlib
from typing import Callable, Dict, List, NamedTuple, Optional

import numpy as np


class Relay(NamedTuple):
    """A topic of another package, and the function that makes its message."""

    topic: str
    message_type: type
    make: Callable


def has_pose(detection) -> bool:
    """Whether a detection has the marker's pose: if not, its first variance is -1."""
    return detection.pose.covariance[0] >= 0.0


def area_of(corners) -> float:
    """Area of a quadrilateral, in square pixels."""
    x = np.array([corner.x for corner in corners])
    y = np.array([corner.y for corner in corners])
    return 0.5 * abs(float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))))


def fiducial_transforms(types, array, detections):
    """fiducial_msgs/FiducialTransformArray, as aruco_detect publishes it."""
    message = types.FiducialTransformArray()
    message.header = array.header
    message.image_seq = array.header.seq
    for detection in detections:
        each = types.FiducialTransform()
        each.fiducial_id = detection.id
        position = detection.pose.pose.position
        translation = each.transform.translation
        translation.x, translation.y, translation.z = position.x, position.y, position.z
        each.transform.rotation = detection.pose.pose.orientation
        each.image_error = detection.residual
        variances = [detection.pose.covariance[i] for i in (0, 7, 14)]
        each.object_error = float(np.sqrt(sum(variances)))
        each.fiducial_area = area_of(detection.corners)
        message.transforms.append(each)
    return message


def fiducial_vertices(types, array, detections):
    """fiducial_msgs/FiducialArray: corners clockwise from the upper left, as in OpenCV."""
    message = types.FiducialArray()
    message.header = array.header
    message.image_seq = array.header.seq
    for detection in detections:
        each = types.Fiducial()
        each.fiducial_id = detection.id
        for i, corner in enumerate(reversed(detection.corners)):
            setattr(each, "x{}".format(i), corner.x)
            setattr(each, "y{}".format(i), corner.y)
        message.fiducials.append(each)
    return message


def tag_detections(types, array, detections):
    """apriltag_ros/AprilTagDetectionArray."""
    message = types.AprilTagDetectionArray()
    message.header = array.header
    for detection in detections:
        each = types.AprilTagDetection()
        each.id = [detection.id]
        each.size = [detection.size]
        each.pose.header = array.header
        each.pose.pose = detection.pose
        message.detections.append(each)
    return message


def aruco_markers(types, array, detections):
    """aruco_msgs/MarkerArray."""
    message = types.MarkerArray()
    message.header = array.header
    for detection in detections:
        each = types.Marker()
        each.header = array.header
        each.id = detection.id
        each.pose = detection.pose
        each.confidence = 1.0 if detection.accepted else 0.5
        message.markers.append(each)
    return message


# Topic, package, message, and the function that makes it.
_KNOWN = [
    ("fiducial_transforms", "fiducial_msgs", "FiducialTransformArray", fiducial_transforms),
    ("fiducial_vertices", "fiducial_msgs", "FiducialArray", fiducial_vertices),
    ("tag_detections", "apriltag_ros", "AprilTagDetectionArray", tag_detections),
    ("aruco_marker_publisher/markers", "aruco_msgs", "MarkerArray", aruco_markers),
]


def _messages_of(package: str) -> Optional[object]:
    try:
        return importlib.import_module(package + ".msg")
    except ImportError:
        return None


def found_relays() -> List[Relay]:
    """The relays whose packages are installed."""
    modules: Dict[str, Optional[object]] = {}
    relays = []
    for topic, package, name, make in _KNOWN:
        if package not in modules:
            modules[package] = _messages_of(package)
        types = modules[package]
        if types is not None:
            relays.append(Relay(topic, getattr(types, name),
                                lambda array, detections, types=types, make=make:
                                make(types, array, detections)))
    return relays


def packages() -> List[str]:
    """Names of all packages that are looked up."""
    return sorted({package for _, package, _, _ in _KNOWN})
