# SPDX-License-Identifier: Apache-2.0
"""A disk of 32 megabytes that can be filled up to a few bytes, where this user may mount one."""

from __future__ import annotations

import subprocess
from pathlib import Path


class SmallDisk:
    """A file system in memory at the folder; use as a context."""

    SIZE_KiB = 32 * 1024

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        folder.mkdir(exist_ok=True)

    def __enter__(self) -> SmallDisk:
        mounted = subprocess.run(
            ["mount", "-t", "tmpfs", "-o", f"size={self.SIZE_KiB}k", "tmpfs", str(self.folder)],
            capture_output=True, check=False)
        if mounted.returncode != 0:
            raise PermissionError("this user may not mount a file system")
        return self

    def __exit__(self, *_: object) -> None:
        subprocess.run(["umount", "-l", str(self.folder)], capture_output=True, check=False)

    def fill(self, left_bytes: int) -> None:
        """Takes all room but so many bytes, in whole pages."""
        with open(self.folder / "filler", "wb", buffering=0) as filler:
            try:
                while filler.write(b"x" * 65536) > 0:
                    pass
            except OSError:
                pass
            size = filler.tell() // 4096 * 4096
            filler.truncate(max(0, size - left_bytes // 4096 * 4096))

    def empty(self) -> None:
        (self.folder / "filler").unlink(missing_ok=True)


def can_mount(scratch: Path) -> bool:
    try:
        with SmallDisk(scratch / "trial"):
            return True
    except (OSError, PermissionError):
        return False
