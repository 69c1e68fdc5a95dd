# SPDX-License-Identifier: Apache-2.0
"""Reads shards of rendered samples (format weft.shards/1) by numpy memmap, while others may still be written."""

import dataclasses
import json
import resource
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import xxhash

from .errors import InputError

FORMAT = "weft.shards/1"
NO_LABEL = 65535  # uv of a cell where no point of the template is seen
UV_SCALE = 65534.0
DEPTH_UNIT_M = 1e-4
SPLITS = ("train", "validation", "test")


@dataclasses.dataclass(frozen=True)
class Description:
    """Content of shards.json."""

    frames: int | None  # None while shards are being written
    recipe_hash: str  # of make.yaml, the pipeline that made them; empty without that file
    width_px: int
    height_px: int
    cell_px: int
    camera: tuple[float, float, float, float]  # fx, fy, cx, cy in px of the small image
    width_m: float
    height_m: float
    columns: int
    rows: int
    texture_hash: str

    def arrays(self, samples: int) -> dict[str, tuple[np.dtype, tuple[int, ...]]]:
        """Type and shape of each array of a shard with so many samples."""
        rows, columns = self.height_px // self.cell_px, self.width_px // self.cell_px
        nodes = self.rows * self.columns
        shapes = {"image": ("u1", (self.height_px, self.width_px, 3)), "uv": ("<u2", (rows, columns, 2)),
                  "depth": ("<u2", (rows, columns)), "mask": ("u1", (rows, columns)),
                  "vertices_m": ("<f4", (nodes, 3)), "visible": ("u1", (nodes,))}
        return {name: (np.dtype(kind), (samples, *shape)) for name, (kind, shape) in shapes.items()}


def read_description(folder: Path) -> Description:
    """Reads and checks FOLDER/shards.json."""
    path = folder / "shards.json"
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}; name a folder that sinks/shards wrote") from None
    except ValueError as error:
        raise InputError(f"{path}: no JSON ({error}); write the shards again") from None
    if not isinstance(content, dict) or content.get("format") != FORMAT:
        raise InputError(f"{path}: format is not {FORMAT}; write the shards again with sinks/shards of this version")
    try:
        image, camera, template = content["image"], content["camera"], content["template"]
        description = Description(
            None if content["frames"] is None else _whole(content, "frames", 1), _recipe_hash(folder),
            _whole(image, "width_px", 1), _whole(image, "height_px", 1), _whole(image, "cell_px", 1),
            tuple(float(camera[key]) for key in ("fx", "fy", "cx", "cy")), _length(template, "width_m"),
            _length(template, "height_m"), _whole(template, "columns", 2), _whole(template, "rows", 2),
            str(template["texture_hash"]))
    except KeyError as error:
        raise InputError(f"{path}: {error.args[0]} is missing; write the shards again") from None
    except (TypeError, ValueError) as error:
        raise InputError(f"{path}: {error}; write the shards again") from None
    if description.cell_px != 4 or description.width_px % 32 or description.height_px % 8:
        raise InputError(f"{path}: image of {description.width_px} x {description.height_px} px with cells of "
                         f"{description.cell_px} px; the network needs a width that is a multiple of 32 px, a height "
                         "that is a multiple of 8 px and cells of 4 px")
    return description


def _recipe_hash(folder: Path) -> str:
    """XXH3-64 of the pipeline that made the shards, as 16 hexadecimal digits."""
    recipe = folder / "make.yaml"
    return xxhash.xxh3_64_hexdigest(recipe.read_bytes()) if recipe.is_file() else ""


def _whole(group: dict[str, Any], key: str, least: int) -> int:
    value = group[key]
    if not isinstance(value, int) or isinstance(value, bool) or value < least:
        raise ValueError(f"{key} is {value!r}, not a whole number of at least {least}")
    return value


def _length(group: dict[str, Any], key: str) -> float:
    value = float(group[key])
    if not (np.isfinite(value) and value > 0):
        raise ValueError(f"{key} is {value!r}, not a positive length")
    return value


def open_shard(folder: Path, description: Description) -> dict[str, np.ndarray]:
    """Maps the arrays of one shard into memory and checks them."""
    arrays: dict[str, np.ndarray] = {}
    for name in description.arrays(0):
        path = folder / f"{name}.npy"
        try:
            array = np.load(path, mmap_mode="r", allow_pickle=False)
        except FileNotFoundError:
            raise InputError(f"{path}: missing; remove {folder} and make it again") from None
        except (OSError, ValueError, EOFError) as error:
            raise InputError(f"{path}: cannot be read ({error}); remove {folder} and make it again") from None
        samples = len(arrays["image"]) if arrays else (array.shape[0] if array.ndim else 0)
        dtype, shape = description.arrays(samples)[name]
        if array.dtype != dtype or array.shape != shape or samples == 0:
            raise InputError(f"{path}: {array.dtype.str} {array.shape} where shards.json and image.npy imply "
                             f"{dtype.str} {shape}; remove {folder} and make it again")
        arrays[name] = array
    _check_vertices(folder / "vertices_m.npy", np.asarray(arrays["vertices_m"]))
    return arrays


def _check_vertices(path: Path, vertices_m: np.ndarray) -> None:
    """A sample has all vertices, in front of the camera, or none: NaN in all of them."""
    absent = np.isnan(vertices_m).all(axis=(1, 2))
    with np.errstate(invalid="ignore"):
        whole = np.isfinite(vertices_m).all(axis=(1, 2)) & (vertices_m[:, :, 2] > 0).all(axis=1)
    wrong = np.flatnonzero(~absent & ~whole)
    if wrong.size:
        raise InputError(f"{path}: sample {wrong[0]} has vertices that are not finite or not in front of the camera "
                         f"({wrong.size} such samples); remove {path.parent} and make it again")


class Shards:
    """All samples of a folder by index; waits for shards that are not yet written."""

    def __init__(self, folder: Path, samples: int | None, wait: Callable[[str], None]) -> None:
        """Uses the first `samples`, default all. `wait(message)` is called repeatedly until a shard exists."""
        self.folder = folder
        self._wait = wait
        self.description = read_description(folder)
        frames = self.description.frames if self.description.frames is not None else samples
        if frames is None:
            raise InputError(f"{folder}: shards are still being written; give --samples or wait for the end")
        self.samples = frames if samples is None else samples
        if not 1 <= self.samples <= frames:
            raise InputError(f"{folder}: --samples {samples} of {frames} frames; give 1 to {frames} or make more")
        self._open: dict[int, dict[str, np.ndarray]] = {}
        # Each memmap keeps a file open, and hundreds of shards exceed the usual limit of 1024.
        hard = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
        resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))
        self._frames = frames
        self.length = min(len(self.shard(0)["image"]), frames)

    def shard(self, number: int) -> dict[str, np.ndarray]:
        """The arrays of a shard, after waiting for it."""
        if number not in self._open:
            path = self.folder / f"{number:06d}"
            while not path.is_dir():
                frames = read_description(self.folder).frames
                if frames is not None and not path.is_dir():
                    raise InputError(f"{path}: missing, but the {frames} frames of {self.folder} are complete; make "
                                     "them again or give fewer --samples")
                self._wait(f"waiting for {path}")
            arrays = open_shard(path, self.description)
            self._check_length(path, number, len(arrays["image"]))
            self._open[number] = arrays
        return self._open[number]

    def _check_length(self, path: Path, number: int, length: int) -> None:
        if number == 0:
            return
        expected = min(self.length, self._frames - number * self.length)
        # While shards are being written, those behind the wanted samples are complete.
        if length < expected or (length > expected and self.description.frames is not None):
            raise InputError(f"{path}: {length} samples where {expected} are expected (each shard but the last has "
                             f"{self.length}); remove {path} and make it again")

    def indices(self, split: str) -> np.ndarray:
        """Indices of the samples of a split."""
        index = np.arange(self.samples)
        place = {"validation": index % 20 == 18, "test": index % 20 == 19, "train": index % 20 < 18}[split]
        return index[place]

    def gather(self, indices: np.ndarray) -> dict[str, np.ndarray]:
        """Copies the samples with these indices."""
        shards = [(self.shard(int(k) // self.length), int(k) % self.length) for k in indices]
        return {name: np.stack([arrays[name][place] for arrays, place in shards])
                for name in self.description.arrays(0)}


def order_of_epoch(indices: np.ndarray, seed: int, epoch: int, window: int = 8192) -> np.ndarray:
    """Order of the samples in an epoch; the first runs through windows in order so that it can follow the writer."""
    random = np.random.default_rng([seed, 1, epoch])
    if epoch > 0:
        return random.permutation(indices)
    parts = [random.permutation(indices[k:k + window]) for k in range(0, len(indices), window)]
    return np.concatenate(parts)
