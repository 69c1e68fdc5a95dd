# SPDX-License-Identifier: Apache-2.0
"""Curves of trainings: as CSV, as Markdown table and as SVG."""

import csv
import io
from pathlib import Path

from .errors import InputError

TABLE = {"samples seen": "samples", "mask IoU": "val_iou", "uv median, mm": "val_uv_median_mm",
         "vertex median, mm": "val_vertex_median_mm"}
FIGURES = {"loss": "loss", "mask": "mask loss", "uv": "uv loss", "depth": "depth loss", "vertices": "vertex loss",
           "val_iou": "mask IoU", "val_uv_median_mm": "uv median (mm)", "val_uv_p90_mm": "uv 90th percentile (mm)",
           "val_vertex_median_mm": "vertex median (mm)"}
LOGARITHMIC = ("mask", "vertices", "val_uv_median_mm", "val_uv_p90_mm", "val_vertex_median_mm")


def curve_text(rows: list[dict[str, float]]) -> str:
    """The curve as CSV; metrics are empty where they were not computed."""
    names = list(dict.fromkeys(name for row in rows for name in row))
    out = io.StringIO()
    writer = csv.DictWriter(out, names, restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows({k: f"{v:.9g}" if isinstance(v, float) else v for k, v in row.items()} for row in rows)
    return out.getvalue()


def read_curve(folder: Path) -> list[dict[str, float]]:
    """Rows of FOLDER/curve.csv without empty values."""
    path = folder / "curve.csv"
    try:
        rows = list(csv.DictReader(path.read_text(encoding="utf-8").splitlines()))
        return [{k: float(v) for k, v in row.items() if k and v} for row in rows]
    except (OSError, ValueError, TypeError) as error:
        raise InputError(f"{path}: cannot be read ({error}); name a folder of train.py") from None


def markdown(curves: dict[str, list[dict[str, float]]]) -> str:
    """Table of the validation metrics over samples seen."""
    several = len(curves) > 1
    lines = ["| " + "training | " * several + " | ".join(TABLE) + " |", "|---" * (len(TABLE) + several) + "|"]
    for name, rows in curves.items():
        for row in rows:
            if "val_iou" not in row:
                continue
            values = [f"{row.get(key, float('nan')):.3g}" for key in TABLE.values()]
            values[0] = f"{int(row['samples']):,}"
            lines.append("| " + f"{name} | " * several + " | ".join(values) + " |")
    return "\n".join(lines) + "\n"


def svg(curves: dict[str, list[dict[str, float]]]) -> str:
    """Figures of losses and metrics over samples seen, with all trainings in each."""
    import matplotlib
    matplotlib.use("svg")
    from matplotlib import pyplot
    matplotlib.rcParams["svg.hashsalt"] = "weft"
    matplotlib.rcParams["font.size"] = 8
    figure, axes = pyplot.subplots(3, 3, figsize=(11, 8), constrained_layout=True)
    for place, (key, title) in zip(axes.flat, FIGURES.items()):
        for name, rows in curves.items():
            seen = [(row["samples"], row[key]) for row in rows if key in row]
            if seen:
                place.plot(*zip(*seen), label=name, linewidth=1, marker="." if key.startswith("val") else None)
        place.set_title(title)
        place.set_xlabel("samples seen")
        if key in LOGARITHMIC and place.lines:
            place.set_yscale("log")
        place.grid(alpha=0.3, which="both")
    axes.flat[0].legend()
    out = io.StringIO()
    figure.savefig(out, format="svg", metadata={"Date": None})
    pyplot.close(figure)
    return out.getvalue()
