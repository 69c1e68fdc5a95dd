#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints the pixels of PNG images as bytes, blue, green and red of each: raw_frames.py FILE...

For images as sinks/dataset writes them: 8 bits, grey or three colours, not interlaced.
"""

import pathlib
import struct
import sys
import zlib

CHANNELS = {0: 1, 2: 3}  # by the number of PNG for a kind of colour


def chunks(png):
    at = 8
    while at < len(png):
        length, = struct.unpack(">I", png[at:at + 4])
        yield png[at + 4:at + 8], png[at + 8:at + 8 + length]
        at += 12 + length


def paeth(left, above, corner):
    guess = left + above - corner
    return min((left, above, corner), key=lambda value: abs(guess - value))


def unfiltered(kind, row, above, channels):
    """A row of bytes, of which each may be told as the difference from its neighbours."""
    for i, value in enumerate(row):
        left = row[i - channels] if i >= channels else 0
        corner = above[i - channels] if i >= channels else 0
        guess = (0, left, above[i], (left + above[i]) // 2, paeth(left, above[i], corner))[kind]
        row[i] = (value + guess) % 256
    return row


def pixels(png):
    parts = list(chunks(png))
    width, height, *form = struct.unpack(">IIBBBBB", parts[0][1])
    depth, colour, *rest = form
    if depth != 8 or colour not in CHANNELS or rest != [0, 0, 0]:
        raise ValueError(f"not 8 bits, grey or of three colours, in rows: {form}")
    channels = CHANNELS[colour]
    data = zlib.decompress(b"".join(content for name, content in parts if name == b"IDAT"))
    length = channels * width
    row = bytearray(length)
    for y in range(height):
        at = y * (length + 1)
        row = unfiltered(data[at], bytearray(data[at + 1:at + 1 + length]), row, channels)
        blue_first = bytearray(3 * width)
        for i in range(3):
            blue_first[i::3] = row[channels - 1 - min(i, channels - 1)::channels]
        yield bytes(blue_first)


def main():
    for name in sys.argv[1:]:
        sys.stdout.buffer.write(b"".join(pixels(pathlib.Path(name).read_bytes())))


if __name__ == "__main__":
    main()
