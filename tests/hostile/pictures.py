# SPDX-License-Identifier: Apache-2.0
"""Small grey PNG files, so that real sources and templates have something to read."""

from __future__ import annotations

import struct
import zlib
from functools import cache


def chunk(name: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))


@cache
def png(width: int, height: int) -> bytes:
    rows = b"".join(b"\0" + bytes((7 * x + 13 * y) % 256 for x in range(width))
                    for y in range(height))
    head = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows)) +
            chunk(b"IEND", b""))
