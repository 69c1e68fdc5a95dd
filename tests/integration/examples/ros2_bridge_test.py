# SPDX-License-Identifier: Apache-2.0
"""Tries the bridge to ROS 2 as far as that goes without ROS.

usage: ros2_bridge_test.py PACKAGE
"""

from __future__ import annotations

import importlib
import io
import json
import math
import re
import struct
import sys
import tempfile
import types
import unittest
from pathlib import Path
from unittest import mock
from xml.etree import ElementTree

PACKAGE = Path(sys.argv.pop(1))
sys.path.insert(0, str(PACKAGE))

import numpy as np  # noqa: E402
from weft_bridge import conversion, read_points  # noqa: E402

SEED = 20260417
FACES = np.array([[0, 1, 2], [1, 3, 2]])


def frame_of(state: str = "estimated", covariance: bool = True) -> dict:
    """Four vertices; the covariance of vertex v is (v + 1)^2 mm^2 along a direction of its own,
    less along all others."""
    vertices_m = [[0.0, 0.0, 0.5], [0.1, 0.0, 0.5], [0.0, 0.1, 0.5], [0.1, 0.1, 0.625]]
    random = np.random.default_rng(SEED)
    matrices = []
    for v in range(4):
        turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
        large_m2 = ((v + 1) * 1e-3) ** 2
        matrices.append((turn @ np.diag([large_m2, large_m2 / 4, large_m2 / 9]) @ turn.T).tolist())
    return {"frame": 7, "time_s": 0.25, "state": state, "age_frames": 0, "confidence": 0.75,
            "vertices_m": vertices_m, "covariance_m2": matrices if covariance else None}


def packed(frame: dict) -> bytes:
    """The frame in the format `packed`, as the README of sinks/stream has it."""
    numbers = np.asarray(frame["vertices_m"], "<f8").tobytes()
    covariance = frame["covariance_m2"] is not None
    if covariance:
        numbers += np.asarray(frame["covariance_m2"], "<f8").tobytes()
    state = ("none", "estimated", "weak", "predicted", "lost").index(frame["state"])
    return struct.pack("<4sIIIQddiIq", b"WEFT", 1, 56 + len(numbers), len(frame["vertices_m"]),
                       frame["frame"], frame["time_s"], frame["confidence"], state, covariance,
                       frame["age_frames"]) + numbers


def read(data: bytes) -> list:
    return list(read_points.frames(io.BufferedReader(io.BytesIO(data))))


class Conversion(unittest.TestCase):
    def test_both_formats_give_the_same_points(self) -> None:
        for covariance in (True, False):
            frame = frame_of(covariance=covariance)
            of_bytes = read(packed(frame) + packed(frame))
            of_lines = read(json.dumps(frame).encode() + b"\n")
            self.assertEqual(len(of_bytes), 2)
            data = {conversion.point_data(each) for each in of_bytes + of_lines}
            self.assertEqual(data, {conversion.point_data(frame)})

    def test_each_point_has_its_place_and_its_largest_standard_deviation(self) -> None:
        frame = frame_of()
        data = conversion.point_data(frame)
        self.assertEqual(len(data), 4 * conversion.POINT_BYTES)
        for v, (x, y, z, std) in enumerate(struct.iter_unpack("<4f", data)):
            np.testing.assert_allclose((x, y, z), frame["vertices_m"][v], rtol=1e-7)
            self.assertAlmostEqual(std, (v + 1) * 1e-3, delta=1e-9)

    def test_a_point_without_covariance_says_so(self) -> None:
        data = conversion.point_data(frame_of(covariance=False))
        self.assertTrue(all(math.isnan(std) for *_, std in struct.iter_unpack("<4f", data)))

    def test_triangles_have_the_corners_of_their_faces(self) -> None:
        frame = frame_of()
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "template.npz"
            np.savez(file, **{"template/faces": FACES.astype("<i4")})
            faces = conversion.faces_of(file)
        corners_m = conversion.corners_m(frame, faces)
        expected = [frame["vertices_m"][v] for v in (0, 1, 2, 1, 3, 2)]
        self.assertEqual(corners_m.tolist(), expected)

    def test_the_template_of_another_run_is_refused(self) -> None:
        with self.assertRaisesRegex(ValueError, "vertex 4, the frame has 4 .* another run"):
            conversion.corners_m(frame_of(), FACES + 1)

    def test_what_is_not_measured_has_a_colour_of_its_own(self) -> None:
        colours = {state: conversion.colour_of(frame_of(state)) for state in read_points.STATES}
        self.assertEqual(len(set(colours.values())), 3)
        self.assertEqual(colours["predicted"], colours["lost"])


class Message(types.SimpleNamespace):
    """Stands for a message of ROS."""

    FLOAT32, TRIANGLE_LIST, ADD = 7, 11, 0


class StandInNode:
    """Stands for rclpy.node.Node: keeps what is published."""

    given: dict = {}

    def __init__(self, name: str) -> None:
        self.name, self.published = name, []

    def declare_parameter(self, name: str, usual):
        return types.SimpleNamespace(value=self.given.get(name, usual))

    def create_publisher(self, _kind, topic: str, _depth: int):
        return types.SimpleNamespace(
            publish=lambda message: self.published.append((topic, message)))

    def get_clock(self):
        return types.SimpleNamespace(now=lambda: types.SimpleNamespace(to_msg=lambda: "now"))


def stand_ins() -> dict:
    """Modules in place of those of ROS."""
    names = {"rclpy": {}, "rclpy.executors": {"ExternalShutdownException": Exception},
             "rclpy.node": {"Node": StandInNode}}
    for package, kinds in {"geometry_msgs": "Point Pose Quaternion Vector3",
                           "sensor_msgs": "PointCloud2 PointField",
                           "std_msgs": "ColorRGBA Header",
                           "visualization_msgs": "Marker"}.items():
        names[package] = {}
        names[f"{package}.msg"] = dict.fromkeys(kinds.split(), Message)
    modules = {}
    for name, members in names.items():
        modules[name] = types.ModuleType(name)
        vars(modules[name]).update(members)
    return modules


class BridgeNode(unittest.TestCase):
    def bridge(self, **given):
        with mock.patch.dict(sys.modules, stand_ins()):
            sys.modules.pop("weft_bridge.node", None)
            node = importlib.import_module("weft_bridge.node")
        with mock.patch.object(StandInNode, "given", given):
            return node.Bridge()

    def template(self) -> str:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        file = Path(folder.name) / "template.npz"
        np.savez(file, **{"template/faces": FACES.astype("<i4")})
        return str(file)

    def test_points_are_published_in_the_camera_frame(self) -> None:
        bridge = self.bridge(frame_id="eye")
        bridge.publish(frame_of())
        [(topic, cloud)] = bridge.published
        self.assertEqual(topic, "~/points")
        self.assertEqual((cloud.header.frame_id, cloud.header.stamp), ("eye", "now"))
        self.assertEqual((cloud.height, cloud.width, cloud.point_step), (1, 4, 16))
        self.assertEqual(cloud.row_step, len(cloud.data))
        self.assertEqual(bytes(cloud.data), conversion.point_data(frame_of()))
        self.assertEqual([(field.name, field.offset) for field in cloud.fields],
                         [("x", 0), ("y", 4), ("z", 8), ("std", 12)])

    def test_points_of_older_shapes_are_left_out_and_the_mesh_shows_them(self) -> None:
        bridge = self.bridge(template=self.template())
        bridge.publish(frame_of("predicted"))
        [(topic, marker)] = bridge.published
        self.assertEqual(topic, "~/mesh")
        self.assertEqual(len(marker.points), 6)
        self.assertEqual(marker.points[4].z, 0.625)
        self.assertEqual(marker.color.a, conversion.OLDER[3])
        asked_for = self.bridge(states=["estimated", "predicted"])
        asked_for.publish(frame_of("predicted"))
        self.assertEqual([topic for topic, _ in asked_for.published], ["~/points"])

    def test_a_source_that_is_no_address_is_refused(self) -> None:
        with self.assertRaisesRegex(ValueError, "tcp://ADDRESS:PORT"):
            self.bridge(source="127.0.0.1:5005")


class Package(unittest.TestCase):
    def test_its_files_call_it_by_one_name(self) -> None:
        manifest = ElementTree.parse(PACKAGE / "package.xml").getroot()
        name = manifest.findtext("name")
        setup = (PACKAGE / "setup.py").read_text()
        self.assertEqual(re.search(r'^NAME = "(\w+)"$', setup, re.MULTILINE)[1], name)
        self.assertIn(f'version="{manifest.findtext("version")}"', setup)
        self.assertTrue((PACKAGE / "resource" / name).is_file())
        self.assertIn(f"$base/lib/{name}\n", (PACKAGE / "setup.cfg").read_text())
        node = (PACKAGE / name / "node.py").read_text()
        self.assertIn("\ndef main():\n", node)
        needed = set(re.findall(r"^(?:from|import) (\w+)", node, re.MULTILINE))
        listed = {each.text for each in manifest.findall("exec_depend")}
        ours = {name, "array", "threading", "time"}
        self.assertEqual(needed - ours, listed - {"python3-numpy"})


if __name__ == "__main__":
    unittest.main()
