"""Writing a rendered sequence as a bag."""

import contextlib
import os
from typing import Iterable, Iterator, Optional

import cv2
import genpy
import numpy as np
import rosbag
from geometry_msgs.msg import PoseStamped, TransformStamped
from sensor_msgs.msg import CameraInfo, CompressedImage, Image
from tf2_msgs.msg import TFMessage

from omnitag.rendering.camera import FisheyeCamera
from omnitag.rendering.odometry import Odometry, Sample
from omnitag.rendering.poses import leaning_quaternion
from omnitag.rendering.world import Mounting

IMAGE_TOPIC = "/camera/image"
GROUND_TRUTH_TOPIC = "/ground_truth/pose"
BASE_FRAME = "base_link"
ENCODINGS = ("png", "jpeg", "raw")


@contextlib.contextmanager
def sequence_bag(path: str, encoding: str, jpeg_quality: int,
                 image_topic: str = IMAGE_TOPIC) -> "Iterator[SequenceBag]":
    """A bag to write to. It appears at `path` once it is complete, and not at all on failure."""
    unfinished = path + ".unfinished"
    try:
        with rosbag.Bag(unfinished, "w") as bag:
            yield SequenceBag(bag, encoding, jpeg_quality, image_topic)
        os.replace(unfinished, path)
    finally:
        if os.path.exists(unfinished):
            os.remove(unfinished)


class SequenceBag:
    """A bag with the images, the camera's mounting, the odometry and the ground truth."""

    def __init__(self, bag: rosbag.Bag, encoding: str, jpeg_quality: int,
                 image_topic: str) -> None:
        self._bag = bag
        self._encoding = encoding
        self._jpeg_quality = jpeg_quality
        self._image_topic = image_topic

    def write_mounting(self, mounting: Mounting, stamp: int) -> None:
        """Write the static transform from the camera's optical frame to base_link, latched."""
        transform = TransformStamped()
        transform.header.stamp = _time(stamp)
        transform.header.frame_id = BASE_FRAME
        transform.child_frame_id = mounting.frame_id
        _assign(transform.transform.translation, "xyz", mounting.position)
        _assign(transform.transform.rotation, "xyzw", mounting.orientation)
        # The connection of a static transform broadcaster, as rosbag record writes it.
        header = {"topic": "/tf_static", "type": TFMessage._type, "md5sum": TFMessage._md5sum,
                  "message_definition": TFMessage._full_text, "callerid": "/render_sequence",
                  "latching": "1"}
        self._bag.write("/tf_static", TFMessage([transform]), _time(stamp),
                        connection_header=header)

    def write_odometry(self, odometry: Optional[Odometry], samples: Iterable[Sample]) -> None:
        """Write transforms from base_link to the odometry frame, each before an image with its stamp.

        Writes nothing without odometry.
        """
        if odometry is None:
            return
        for sample in samples:
            transform = TransformStamped()
            transform.header.stamp = _time(sample.stamp)
            transform.header.frame_id = odometry.frame_id
            transform.child_frame_id = BASE_FRAME
            _assign(transform.transform.translation, "xyz", (sample.x, sample.y, sample.z))
            _assign(transform.transform.rotation, "xyzw",
                    leaning_quaternion(sample.yaw, sample.roll, sample.pitch))
            # One nanosecond early: at equal times the order would be up to the reader of the bag.
            self._bag.write("/tf", TFMessage([transform]), _time(max(sample.stamp - 1, 0)))

    def write_image(self, pixels: np.ndarray, frame_id: str, stamp: int, received: int) -> None:
        """Write an 8-bit grey image."""
        message = Image() if self._encoding == "raw" else CompressedImage()
        message.header.stamp = _time(stamp)
        message.header.frame_id = frame_id
        if self._encoding == "raw":
            message.height, message.width = pixels.shape
            message.encoding, message.step = "mono8", pixels.shape[1]
            message.data = pixels.tobytes()
            self._bag.write(self._image_topic, message, _time(received))
            return
        message.format = f"mono8; {self._encoding} compressed mono8"
        message.data = self._compress(pixels)
        self._bag.write(self._image_topic + "/compressed", message, _time(received))

    def write_camera_info(self, camera: FisheyeCamera, frame_id: str, stamp: int) -> None:
        """Write what a driver publishes of a calibrated fisheye along with its image."""
        lens = camera.lens
        message = CameraInfo()
        message.header.stamp = _time(stamp)
        message.header.frame_id = frame_id
        message.width, message.height = camera.width, camera.height
        message.distortion_model = "equidistant"
        message.D = [0.0] * 4
        message.K = [lens.fx, 0.0, lens.cx, 0.0, lens.fy, lens.cy, 0.0, 0.0, 1.0]
        message.R = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
        message.P = [lens.fx, 0.0, lens.cx, 0.0, 0.0, lens.fy, lens.cy, 0.0, 0.0, 0.0, 1.0, 0.0]
        topic = self._image_topic.rpartition("/")[0] + "/camera_info"
        self._bag.write(topic, message, message.header.stamp)

    def write_ground_truth(self, position: np.ndarray, orientation: np.ndarray, frame_id: str,
                           stamp: int) -> None:
        """Write the pose of base_link in `frame_id`; metres and a quaternion x, y, z, w."""
        message = PoseStamped()
        message.header.stamp = _time(stamp)
        message.header.frame_id = frame_id
        _assign(message.pose.position, "xyz", position)
        _assign(message.pose.orientation, "xyzw", orientation)
        self._bag.write(GROUND_TRUTH_TOPIC, message, message.header.stamp)

    def _compress(self, pixels: np.ndarray) -> bytes:
        if self._encoding == "jpeg":
            options = [cv2.IMWRITE_JPEG_QUALITY, self._jpeg_quality, cv2.IMWRITE_JPEG_OPTIMIZE, 1]
            return cv2.imencode(".jpg", pixels, options)[1].tobytes()
        options = [cv2.IMWRITE_PNG_COMPRESSION, 9,
                   cv2.IMWRITE_PNG_STRATEGY, cv2.IMWRITE_PNG_STRATEGY_HUFFMAN_ONLY]
        return cv2.imencode(".png", pixels, options)[1].tobytes()


def _time(nanoseconds: int) -> genpy.Time:
    return genpy.Time(*divmod(int(nanoseconds), 10**9))


def _assign(target: object, names: str, values: Iterable[float]) -> None:
    for name, value in zip(names, values):
        setattr(target, name, float(value))
