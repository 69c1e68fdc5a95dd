# SPDX-License-Identifier: Apache-2.0
"""What a power cut may leave of a folder, from the notes of power_cut_journal.cpp.

POSIX promises of a file what its last fsync() wrote, and of a folder the entries at its last
fsync(). Everything later may be there, be missing, or be there in part: a file that was not synced
may be empty, cut off, or have zeros where its bytes were.
"""

from __future__ import annotations

import os
import struct
from dataclasses import dataclass
from pathlib import Path
from random import Random

NEVER = 2**62


@dataclass(frozen=True)
class Entry:
    kind: str  # "f": a file, "d": a folder, "l": a link
    number: int  # inode
    target: str = ""  # target of a link


def entry_of(path: Path) -> Entry:
    status = os.lstat(path)
    if path.is_symlink():
        return Entry("l", status.st_ino, os.readlink(path))
    return Entry("d" if path.is_dir() else "f", status.st_ino)


def entries_of(folder: Path) -> dict[str, Entry]:
    return {path.name: entry_of(path) for path in folder.iterdir()}


class Disk:
    """A folder and what is noted of it; `root` has what was there before, which is on the disk."""

    def __init__(self, notes: Path, root: Path) -> None:
        self.notes, self.root = notes, root
        (notes / "store").mkdir(parents=True)
        self.set_cut(NEVER)
        folders = [root, *(path for path in root.rglob("*") if path.is_dir())]
        self.known_folders = {os.stat(path).st_ino: entries_of(path) for path in folders}
        self.known_files = {entry.number for entries in self.known_folders.values()
                            for entry in entries.values() if entry.kind == "f"}

    def set_cut(self, moment: int) -> None:
        (self.notes / "state").write_bytes(struct.pack("4q", 0, 0, moment, 0))

    def environment(self, library: Path) -> dict[str, str]:
        return {"LD_PRELOAD": str(library), "POWER_CUT": str(self.notes),
                "POWER_CUT_ROOT": str(self.root)}

    @property
    def moments(self) -> int:
        return struct.unpack("4q", (self.notes / "state").read_bytes())[1]

    @property
    def is_cut(self) -> bool:
        return struct.unpack("4q", (self.notes / "state").read_bytes())[3] != 0

    def synced_bytes(self, number: int) -> bytes | None:
        """What is certain of a file; None where nothing is."""
        file = self.notes / "store" / f"{number}.synced"
        return file.read_bytes() if file.exists() else None

    def synced_entries(self, number: int) -> dict[str, Entry]:
        """The entries of a folder that are certain."""
        file = self.notes / "store" / f"{number}.folder"
        if not file.exists():
            return self.known_folders.get(number, {})
        words = file.read_bytes().decode().split("\0")[:-1]
        return {name: Entry(kind, int(inode), target)
                for kind, inode, name, target in zip(*[iter(words)] * 4)}

    def leave(self, target: Path, rng: Random) -> None:
        """Makes a folder as the cut may have left it."""
        self.files, self.folders = {}, {}
        for path in [self.root, *self.root.rglob("*")]:
            entry = entry_of(path)
            {"f": self.files, "d": self.folders}.get(entry.kind, {})[entry.number] = path
        target.mkdir()
        self._leave_folder(os.stat(self.root).st_ino, target, rng)

    def _leave_folder(self, number: int, target: Path, rng: Random) -> None:
        certain = self.synced_entries(number)
        now = entries_of(self.folders[number]) if number in self.folders else certain
        chance = rng.choice([0.0, 0.0, 0.5, 1.0])  # probability of each uncertain change
        for name in sorted(certain.keys() | now.keys()):
            known, later = certain.get(name), now.get(name)
            entry = later if known != later and rng.random() < chance else known
            if entry is None:
                continue
            if entry.kind == "l":
                (target / name).symlink_to(entry.target)
            elif entry.kind == "f":
                (target / name).write_bytes(self._left_of_file(entry.number, rng))
            elif entry.number in self.folders:  # else it was removed later
                (target / name).mkdir()
                self._leave_folder(entry.number, target / name, rng)

    def _left_of_file(self, number: int, rng: Random) -> bytes:
        kept = self.notes / "store" / str(number)
        path = kept if kept.exists() else self.files.get(number)
        whole = path.read_bytes() if path else b""
        certain = self.synced_bytes(number)
        if number in self.known_files:
            return whole
        if certain is not None and not whole.startswith(certain):
            return certain
        certain = certain or b""
        rest = whole[len(certain):]
        cut = rng.randrange(len(rest) + 1)
        return certain + rng.choice([b"", b"", rest[:cut], bytes(len(rest)),
                                     rest[:cut] + bytes(len(rest) - cut), rest])
