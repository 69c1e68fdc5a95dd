#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Reads the points that sinks/stream sends and prints a line for each frame.

read_points.py tcp://127.0.0.1:5005   connects; waits for up to a minute until the run listens
read_points.py udp://127.0.0.1:5005   listens for datagrams
read_points.py FILE                   a file or a named pipe; - is the standard input

Both formats are understood, told apart by their first byte. `--frames N` ends it after N frames.
Take frames() into a program of your own: it needs the standard library only.
"""

import argparse
import array
import io
import json
import math
import socket
import struct
import sys
import time

HEADER = struct.Struct("<4sIIIQddiIq")  # 56 bytes, see the README of sinks/stream
STATES = ("none", "estimated", "weak", "predicted", "lost")


def rows(numbers, width):
    return [numbers[i:i + width] for i in range(0, len(numbers), width)]


def packed_frame(stream):
    """The next frame of the format `packed`, with the keys of `json_lines`."""
    header = stream.read(HEADER.size)
    if len(header) < HEADER.size:
        return None
    magic, version, size, vertices, frame, time_s, confidence, state, covariance, age = (
        HEADER.unpack(header))
    if magic != b"WEFT" or version != 1:
        raise ValueError("these are no points of sinks/stream, or of a later version")
    body = stream.read(size - HEADER.size)
    if len(body) < size - HEADER.size:
        return None  # the run was ended in the middle of it
    numbers = array.array("d", body)
    if sys.byteorder == "big":
        numbers.byteswap()
    numbers = numbers.tolist()
    matrices = [rows(nine, 3) for nine in rows(numbers[3 * vertices:], 9)]
    return {"frame": frame, "time_s": None if math.isnan(time_s) else time_s,
            "state": STATES[state], "age_frames": age, "confidence": confidence,
            "vertices_m": rows(numbers[:3 * vertices], 3),
            "covariance_m2": matrices if covariance else None}


def json_frame(stream):
    line = stream.readline()
    return json.loads(line) if line.endswith(b"\n") else None


def frames(stream):
    """The frames of a binary stream that can peek(), as dictionaries, until it ends."""
    while first := stream.peek(1)[:1]:
        frame = json_frame(stream) if first == b"{" else packed_frame(stream)
        if frame is None:
            return
        yield frame


def connected(address, patience_s=60.0):
    """A socket to who listens there, now or soon."""
    end = time.monotonic() + patience_s
    while True:
        try:
            return socket.create_connection(address)
        except ConnectionRefusedError:
            if time.monotonic() > end:
                raise
            time.sleep(0.05)


def frames_from(source):
    if source == "-":
        yield from frames(sys.stdin.buffer)
        return
    protocol, _, place = source.partition("://")
    if not place:
        with open(source, "rb") as stream:
            yield from frames(stream)
        return
    host, _, port = place.rpartition(":")
    address = (host.strip("[]"), int(port))
    if protocol == "tcp":
        with connected(address) as connection, connection.makefile("rb") as stream:
            yield from frames(stream)
    elif protocol == "udp":
        family = socket.AF_INET6 if ":" in address[0] else socket.AF_INET
        with socket.socket(family, socket.SOCK_DGRAM) as listening:
            listening.bind(address)
            while True:
                yield from frames(io.BufferedReader(io.BytesIO(listening.recv(65536))))
    else:
        raise SystemExit(f"read_points.py: {protocol}:// is neither tcp:// nor udp://")


def described(frame):
    """One line: when, how sure, where the middle of the points is, how exact they are."""
    points = frame["vertices_m"]
    middle = [sum(axis) / len(points) for axis in zip(*points)]
    time_s = "-" if frame["time_s"] is None else f"{frame['time_s']:.3f} s"
    text = (f"frame {frame['frame']}  {time_s}  {frame['state']}  confidence "
            f"{frame['confidence']:.2f}  {len(points)} points around "
            f"({middle[0]:.4f}, {middle[1]:.4f}, {middle[2]:.4f}) m")
    if frame["covariance_m2"]:
        variance = sum(m[0][0] + m[1][1] + m[2][2] for m in frame["covariance_m2"]) / len(points)
        text += f" +- {1000 * math.sqrt(variance):.2f} mm"
    return text


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source")
    parser.add_argument("--frames", type=int, default=0, help="end after so many; 0: never")
    options = parser.parse_args()
    for count, frame in enumerate(frames_from(options.source), 1):
        print(described(frame), flush=True)
        if count == options.frames:
            break


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        pass
