#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints the pixels of PNG images as bytes, blue, green and red of each: raw_frames.py FILE...

For images as sinks/dataset writes them: 8 bits, three colours, not interlaced.
"""

import pathlib
import struct
import sys
import zlib

CHANNELS = 3


def chunks(png):
    at = 8
    while at < len(png):
        length, = struct.unpack(">I", png[at:at + 4])
        yield png[at + 4:at + 8], png[at + 8:at + 8 + length]
        at += 12 + length


def paeth(left, above, corner):
    guess = left + above - corner
    return min((left, above, corner), key=lambda value: abs(guess - value))


def unfiltered(kind, row, above):
    """A row of bytes, of which each may be told as the difference from its neighbours."""
    for i, value in enumerate(row):
        left = row[i - CHANNELS] if i >= CHANNELS else 0
        corner = above[i - CHANNELS] if i >= CHANNELS else 0
        guess = (0, left, above[i], (left + above[i]) // 2, paeth(left, above[i], corner))[kind]
        row[i] = (value + guess) % 256
    return row


def pixels(png):
    parts = list(chunks(png))
    width, height, *form = struct.unpack(">IIBBBBB", parts[0][1])
    if form != [8, 2, 0, 0, 0]:
        raise ValueError(f"not 8 bits of three colours in rows: {form}")
    data = zlib.decompress(b"".join(content for name, content in parts if name == b"IDAT"))
    length = CHANNELS * width
    row = bytearray(length)
    for y in range(height):
        at = y * (length + 1)
        row = unfiltered(data[at], bytearray(data[at + 1:at + 1 + length]), row)
        blue_first = bytearray(row)
        blue_first[0::3], blue_first[2::3] = row[2::3], row[0::3]
        yield bytes(blue_first)


def main():
    for name in sys.argv[1:]:
        sys.stdout.buffer.write(b"".join(pixels(pathlib.Path(name).read_bytes())))


if __name__ == "__main__":
    main()
