#!/usr/bin/env python3
"""The nodelet is loaded and unloaded again and again, while images come: its manager survives, and
does not grow."""

import sys
import threading
import unittest
from xmlrpc.client import ServerProxy

import rosgraph
import rospy
import rostest
from geometry_msgs.msg import PoseStamped
from harness import IMAGE_TOPIC, TIMEOUT, Topic, raw_image, read_bag
from nodelet.srv import NodeletList, NodeletLoad, NodeletUnload
from sensor_msgs.msg import Image
from tf2_msgs.msg import TFMessage

TIMES = 50
WARM_UP = 10
MAX_GROWTH = 8.0  # MB, over all the times after the warm-up


class Camera(threading.Thread):
    """Sends the bag's images repeatedly, with stamps that continue."""

    def __init__(self):
        super().__init__()
        images, transforms = read_bag()
        self._images = [raw_image(image) for image in images]
        self._image_publisher = rospy.Publisher(IMAGE_TOPIC, Image, queue_size=1)
        self._transform_publisher = rospy.Publisher("/tf_static", TFMessage, latch=True,
                                                    queue_size=1)
        self._transform_publisher.publish(transforms)
        self._stopped = threading.Event()
        self.stamp = rospy.Time(1000.0)  # of the last image

    def run(self):
        count = 0
        while not self._stopped.wait(0.03):
            image = self._images[count % len(self._images)]
            self.stamp += rospy.Duration(0.25)
            image.header.stamp = self.stamp
            self._image_publisher.publish(image)
            count += 1

    def stop(self):
        """Ends the thread."""
        self._stopped.set()
        self.join()


class ReloadingTest(unittest.TestCase):
    def setUp(self):
        rospy.wait_for_service("/manager/load_nodelet", TIMEOUT)
        self.load = rospy.ServiceProxy("/manager/load_nodelet", NodeletLoad)
        self.unload = rospy.ServiceProxy("/manager/unload_nodelet", NodeletUnload)
        self.list = rospy.ServiceProxy("/manager/list", NodeletList)
        self.pid = ServerProxy(rosgraph.Master("/test").lookupNode("/manager")).getPid("/test")[2]

    def memory(self):
        """MB of memory that the manager uses."""
        with open(f"/proc/{self.pid}/status", encoding="utf-8") as file:
            line = next(line for line in file if line.startswith("VmRSS:"))
        return int(line.split()[1]) / 1024.0

    def test_survives_and_does_not_grow(self):
        poses = Topic("/pose", PoseStamped)
        camera = Camera()
        camera.start()
        self.addCleanup(camera.stop)
        after_warm_up = 0.0
        for count in range(TIMES):
            before = camera.stamp
            self.assertTrue(self.load(name="/localizer", type="omnitag/LocalizerNodelet",
                                      remap_source_args=["/image"],
                                      remap_target_args=[IMAGE_TOPIC]).success)
            self.assertIsNotNone(poses.wait_for(lambda pose: pose.header.stamp > before),
                                 f"no pose after load {count}")
            self.assertTrue(self.unload(name="/localizer").success)
            self.assertEqual(self.list().nodelets, [])
            if count + 1 == WARM_UP:
                after_warm_up = self.memory()
        growth = self.memory() - after_warm_up
        print(f"{after_warm_up:.1f} MB after {WARM_UP} times, {growth:+.1f} MB after {TIMES}")
        self.assertLess(growth, MAX_GROWTH)


if __name__ == "__main__":
    rospy.init_node("reloading_test")
    rostest.rosrun("omnitag", "reloading", ReloadingTest, sys.argv)
