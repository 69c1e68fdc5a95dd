# SPDX-License-Identifier: Apache-2.0
"""Match sets of simulated scenes: `weft run` detects and matches, filters/oracle labels.

Data seeds are 1001 and above; those of pipelines/ablations/filters_frex.yaml are 101 to 106. The textures are
random ones that no plan uses.
"""
from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path

import cv2
import numpy as np

from match_sets import TOLERANCE_PX, MatchSet
from textures import KINDS, SHARES, texture

PATTERNS = ("roll", "s_bend", "corner_fold", "wave", "handles", "bulge")
BACKGROUNDS = ("plain", "clutter", "look_alike")
FRAMES = 6


def scene(rng: np.random.Generator, number: int, texture_path: Path) -> dict:
    """The pipeline of a random scene."""
    pattern = PATTERNS[number % len(PATTERNS)]
    source = {
        "texture": str(texture_path), "width_m": 0.297, "pattern": pattern, "frames": FRAMES, "fps": 3,
        "background": BACKGROUNDS[(number // len(PATTERNS)) % len(BACKGROUNDS)], "dense_truth": False,
        "occluder": bool(rng.random() < 0.25), "bend": float(rng.uniform(0.5, 1.2)),
        "stretch": 0.15 if pattern == "s_bend" and rng.random() < 0.5 else 0.0,
        "distance_m": float(rng.uniform(0.45, 0.8)), "tilt_rad": float(rng.uniform(0.1, 0.6)),
        "blur_px": float(rng.uniform(0.3, 1.5)), "noise_grey": float(rng.uniform(1, 5)),
        "copy_size": float(rng.uniform(0.4, 0.7)), "seed": 1001 + number,
    }
    detector, matcher = {"use": "detectors/sift"}, {"use": "matchers/descriptor", "params": {}}
    if rng.random() < 0.25:
        detector = {"use": "detectors/orb"}
    matcher["params"]["ratio"] = [0.8, 0.9, 1.0, 1.0][rng.integers(4)]
    if rng.random() < 0.3:
        matcher["params"]["direction"] = "image_to_template"
    oracle = {"use": "filters/oracle", "params": {"tolerance_px": TOLERANCE_PX}}
    return {"weft": 1, "source": {"use": "sources/frex", "params": source},
            "template": {"use": "templates/rectangular", "params": {
                "texture": str(texture_path), "width_m": 0.297, "columns": 13, "rows": 9}},
            "stages": [detector, matcher, oracle]}


def frame_set(frame: Path, half_diagonal_px: float) -> MatchSet | None:
    """The labelled matches of a frame of a run; None without matches."""
    record = np.load(frame)
    names = record.files
    matches = next((name[:-len("/template_px")] for name in names if name.endswith("/template_px")), None)
    mask = next((name[:-len("/kept")] for name in names if name.endswith("inlier_mask/kept")), None)
    if matches is None or mask is None:
        return None
    count = len(record[f"{matches}/template_px"])
    value = lambda name: record[f"{matches}/{name}"] if f"{matches}/{name}" in names else np.full(count, np.nan)
    score = record[f"{mask}/score"]
    label = np.where(score == 1, 1, np.where(score == 0, 0, -1)).astype(np.int8)
    return MatchSet(record[f"{matches}/template_px"], record[f"{matches}/image_px"], np.log(value("scale_ratio")),
                    value("angle_difference_rad"), value("ratio"), label, half_diagonal_px)


def simulated(weft: str, folder: Path, scenes: int, seed: int, first: int = 0) -> list[MatchSet]:
    """Sets of `scenes` scenes. Scenes that an earlier call left in `folder` are read again."""
    folder.mkdir(parents=True, exist_ok=True)
    sets: list[MatchSet] = []
    for number in range(first, first + scenes):
        rng = np.random.default_rng([seed, number])
        saved = folder / f"scene_{number:04d}.npz"
        if not saved.exists():
            texture_path = folder / f"texture_{number:04d}.png"
            image = texture(str(rng.choice(KINDS, p=SHARES)), int(rng.integers(2**31)))
            cv2.imwrite(str(texture_path), image)
            pipeline = folder / f"scene_{number:04d}.yaml"
            pipeline.write_text(json.dumps(scene(rng, number, texture_path)))
            run = folder / f"run_{number:04d}"
            subprocess.run([weft, "run", str(pipeline), "--out", str(run)], check=False, capture_output=True)
            half = 0.5 * float(np.hypot(*image.shape))
            found = [frame_set(frame, half) for frame in sorted((run / "frames").glob("*.npz"))]
            store(saved, [one for one in found if one is not None])
            shutil.rmtree(run, ignore_errors=True)
            texture_path.unlink()
        sets += load(saved)
    return sets


COLUMNS = ("template_px", "image_px", "log_scale", "angle_rad", "ratio", "label")


def store(path: Path, sets: list[MatchSet]) -> None:
    """Writes sets to one file, which appears complete or not at all."""
    arrays = {f"{k}/{name}": getattr(one, name) for k, one in enumerate(sets) for name in COLUMNS}
    arrays["half_diagonal_px"] = np.array([one.half_diagonal_px for one in sets])
    part = path.with_name("part_" + path.name)
    np.savez_compressed(part, **arrays)
    part.rename(path)


def load(path: Path) -> list[MatchSet]:
    """Reads what store() wrote."""
    with np.load(path) as arrays:
        half = arrays["half_diagonal_px"]
        return [MatchSet(*(arrays[f"{k}/{name}"] for name in COLUMNS), float(half[k])) for k in range(len(half))]
