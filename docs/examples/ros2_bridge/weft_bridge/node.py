# SPDX-License-Identifier: Apache-2.0
"""The node `weft_bridge`: points and mesh of a run, as sinks/stream sends them, as messages."""

import array
import threading
import time

import rclpy
from geometry_msgs.msg import Point, Pose, Quaternion, Vector3
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import PointCloud2, PointField
from std_msgs.msg import ColorRGBA, Header
from visualization_msgs.msg import Marker

from weft_bridge import conversion
from weft_bridge.read_points import frames_from

PAUSE_S = 1.0  # between a run that ended and the next try
NEWEST = 1  # message that waits for a subscriber


class Bridge(Node):
    def __init__(self):
        super().__init__("weft_bridge")
        self.source = self.declare_parameter("source", "tcp://127.0.0.1:5005").value
        self.frame_id = self.declare_parameter("frame_id", "camera_optical_frame").value
        self.states = self.declare_parameter("states", ["estimated"]).value
        template = self.declare_parameter("template", "").value
        if not self.source.startswith(("tcp://", "udp://")):
            raise ValueError(f"source is tcp://ADDRESS:PORT or udp://ADDRESS:PORT, not "
                             f"'{self.source}'")
        self.faces = conversion.faces_of(template) if template else None
        self.points = self.create_publisher(PointCloud2, "~/points", NEWEST)
        self.mesh = self.create_publisher(Marker, "~/mesh", NEWEST)

    def read(self):
        """Publishes frames of one run after another until ROS ends."""
        while rclpy.ok():
            try:
                for frame in frames_from(self.source):
                    self.publish(frame)
                self.get_logger().info(f"the run at {self.source} has ended; waiting for another")
            except OSError as error:
                self.get_logger().warning(f"{self.source}: {error}; trying again")
            except ValueError as error:
                self.get_logger().fatal(f"{self.source}: {error}")
                rclpy.try_shutdown()
            time.sleep(PAUSE_S)

    def publish(self, frame):
        header = Header(stamp=self.get_clock().now().to_msg(), frame_id=self.frame_id)
        if frame["state"] in self.states:
            self.points.publish(self.point_cloud(frame, header))
        if self.faces is not None:
            self.mesh.publish(self.marker(frame, header))

    @staticmethod
    def point_cloud(frame, header):
        count = len(frame["vertices_m"])
        fields = [PointField(name=name, offset=i * conversion.FIELD_BYTES,
                             datatype=PointField.FLOAT32, count=1)
                  for i, name in enumerate(conversion.FIELDS)]
        return PointCloud2(header=header, height=1, width=count, fields=fields, is_bigendian=False,
                           point_step=conversion.POINT_BYTES,
                           row_step=conversion.POINT_BYTES * count,
                           data=array.array("B", conversion.point_data(frame)), is_dense=True)

    def marker(self, frame, header):
        corners = [Point(x=x, y=y, z=z)
                   for x, y, z in conversion.corners_m(frame, self.faces).tolist()]
        red, green, blue, opacity = conversion.colour_of(frame)
        return Marker(header=header, ns="weft", id=0, type=Marker.TRIANGLE_LIST, action=Marker.ADD,
                      pose=Pose(orientation=Quaternion(x=0.0, y=0.0, z=0.0, w=1.0)),
                      scale=Vector3(x=1.0, y=1.0, z=1.0),
                      color=ColorRGBA(r=red, g=green, b=blue, a=opacity), points=corners)


def main():
    rclpy.init()
    node = Bridge()
    threading.Thread(target=node.read, daemon=True).start()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()
