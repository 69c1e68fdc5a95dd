#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Reads the frames that a run's live view shows, and prints a line for each.

read_frames.py                         of a run whose page is http://127.0.0.1:8090/
read_frames.py 'http://10.0.0.9:8090/?token=...'   the address of the page, with its token
read_frames.py --plot                  draws the points, too; needs python3-matplotlib

It needs python3-websockets and python3-numpy. Take frames() into a program of your own.
"""

import argparse
import asyncio
import base64
import json
import struct
import sys
from urllib.parse import urlsplit

import numpy as np
import websockets
from websockets.exceptions import ConnectionClosed, ConnectionClosedOK, InvalidHandshake

HEAD = struct.Struct("<4sI")  # of a frame, see the README of sinks/live
TYPES = {"f32": "<f4", "u8": "u1"}
READY = json.dumps({"type": "ready"})


def socket_address(page):
    """The WebSocket of the page at that address."""
    place = urlsplit(page)
    if place.scheme not in ("http", "https") or not place.netloc:
        raise ValueError(f"{page} is no address of a page, such as http://127.0.0.1:8090/")
    query = f"?{place.query}" if place.query else ""
    return f"{place.scheme.replace('http', 'ws')}://{place.netloc}/ws{query}"


def scene_of(hello):
    """What holds for all frames: camera (fx, fy, cx, cy in px), vertices_m [V,3] of the template at
    rest, faces [F,3]."""
    def array(name, kind):
        bytes_ = base64.b64decode(hello["template"][name])
        return np.frombuffer(bytes_, kind).reshape(-1, 3)

    return {"camera": hello["camera"], "vertices_m": array("vertices_m", "<f4"),
            "faces": array("faces", "<i4")}


def frame_of(message):
    """A frame as a dictionary: frame, time_s, report (its line of frames.jsonl), and what it has of
    image (bytes of a JPEG), vertices_m [V,3] in the camera's frame, visible [V]."""
    magic, length = HEAD.unpack_from(message)
    if magic != b"WFL1":
        raise ValueError("this is no frame of the protocol weft.live.1")
    at = HEAD.size + length
    frame = json.loads(message[HEAD.size:at])
    for part in frame.pop("parts"):
        content = message[at:at + part["bytes"]]
        if part["type"] in TYPES:
            content = np.frombuffer(content, TYPES[part["type"]])
        frame[part["name"]] = content
        at += (part["bytes"] + 3) // 4 * 4
    if "vertices_m" in frame:
        frame["vertices_m"] = frame["vertices_m"].reshape(-1, 3)
    return frame


async def frames(page):
    """Pairs of scene and frame, until the run ends. Each time it is the newest frame: who takes
    long for one misses some, and the run waits for nobody."""
    options = {"subprotocols": ["weft.live.1"], "max_size": None, "compression": None}
    async with websockets.connect(socket_address(page), **options) as connection:
        scene = None
        try:
            async for message in connection:
                if isinstance(message, bytes):
                    yield scene, frame_of(message)
                else:
                    said = json.loads(message)
                    if said["type"] != "hello":
                        continue  # settings that changed
                    scene = scene_of(said)
                await connection.send(READY)
        except ConnectionClosedOK:
            pass  # the run has ended meanwhile


def described(frame):
    """One line: when, how sure, where the middle of the points is, how many are seen."""
    report = frame["report"] or {}
    time_s = "-" if frame["time_s"] is None else f"{frame['time_s']:.3f} s"
    text = f"frame {frame['frame']}  {time_s}  {report.get('state', '-')}"
    if report.get("confidence") is not None:
        text += f"  confidence {report['confidence']:.2f}"
    if "vertices_m" not in frame:
        return f"{text}  no points"
    x, y, z = frame["vertices_m"].mean(axis=0)
    text += f"  {len(frame['vertices_m'])} points around ({x:.4f}, {y:.4f}, {z:.4f}) m"
    if "visible" in frame:
        text += f", {np.count_nonzero(frame['visible'])} seen"
    return text


class Plot:
    """The points in 3D, as the camera has them before it: y upwards, z away from it."""

    def __init__(self):
        from matplotlib import pyplot  # only who draws needs it

        self.pyplot = pyplot
        pyplot.ion()
        self.axes = pyplot.figure().add_subplot(projection="3d")

    def show(self, frame):
        self.axes.clear()
        self.axes.set(xlabel="x in m", ylabel="z in m", zlabel="-y in m",
                      title=described(frame).split("  confidence")[0])
        if "vertices_m" in frame:
            x, y, z = frame["vertices_m"].T
            seen = frame.get("visible", np.ones(len(x)))
            self.axes.scatter(x, z, -y, c=seen, vmin=0, vmax=1)
            self.axes.set_box_aspect([max(np.ptp(axis), 0.01) for axis in (x, z, y)])
        self.pyplot.pause(0.001)  # the window draws and hears meanwhile


def new_plot():
    try:
        return Plot()
    except ImportError as error:
        print(f"read_frames.py: prints only, since {error}: install python3-matplotlib",
              file=sys.stderr)
        return None


async def read(page, count, plot):
    number = 0
    async for _, frame in frames(page):
        print(described(frame), flush=True)
        if plot is not None:
            plot.show(frame)
        number += 1
        if number == count:
            break


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("page", nargs="?", default="http://127.0.0.1:8090/")
    parser.add_argument("--frames", type=int, default=0, help="end after so many; 0: never")
    parser.add_argument("--plot", action="store_true", help="draw the points of each frame")
    options = parser.parse_args()
    try:
        asyncio.run(read(options.page, options.frames, new_plot() if options.plot else None))
    except ConnectionRefusedError:
        sys.exit(f"read_frames.py: no run listens at {options.page}: start one, weft live --demo")
    except InvalidHandshake as error:
        sys.exit(f"read_frames.py: {options.page} refuses ({error}): where the address of the page "
                 "has a token, give it, too")
    except (ValueError, OSError, ConnectionClosed) as error:
        sys.exit(f"read_frames.py: {error}")


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        pass
