#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes the figures that several plugin pages share: page_figures.py WEFT FOLDER [FIGURE...]

Runs pipelines with the program WEFT and writes FIGURE.jpg for filters, solvers, detectors and matchers
(default: all) to FOLDER: docs/images. Each panel is one run (COMMANDS, below) and shows its last frame,
labelled with its numbers from `weft eval`.

Needs NumPy and Pillow (Debian: python3-numpy, python3-pil, fonts-dejavu-core). Prints each command and
the size of each figure. Exits 1 if a figure would have more than MOST_BYTES, 2 on wrong usage.
"""

import csv
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

ROOT = Path(__file__).resolve().parent.parent
MOST_BYTES = 300_000
QUALITY = 70
WIDTH, SAVED_WIDTH = 1200, 900  # px, as rendered and as saved
BLUE, ORANGE = (0, 90, 220), (255, 120, 0)
ERROR_COLOURS = np.array([(68, 1, 84), (59, 82, 139), (33, 145, 140), (94, 201, 98), (253, 231, 37)], float)
MOST_MM = 5  # error of the last of these colours
VIEW = np.array([(0.574, 0, 0.819), (0.280, 0.940, -0.196), (-0.770, 0.342, 0.539)])  # from the side

S_BEND = ["source.pattern=s_bend", "source.fps=1", "source.frames=3", "source.distance_m=0.5"]
ALL_MATCHES = ["matchers.direction=image_to_template", "matchers.ratio=0.95"]
BENT = ["source.frames.params.pattern=s_bend", "source.frames.params.bend=1.2"]
VIDEO = ["source.distance_m=0.6", "source.period_s=2", "source.frames=10", "without=overlay,meshes"]
ON_SIGHTLINES = ("brunet_mdh", "brunet_refine", "gauss_newton", "particle_sft")
EXTRA = {"gms": ["filters.preset=weft"], "vfc": ["filters.preset=weft"],
         "coarse_to_fine": ["template.columns=37", "template.rows=25", "passes.reach=0.07"]}
STAGES = {"track": "tracked", "dense_flow": "dense"}  # names of the matchers in their pipelines
FONT = ImageFont.truetype("DejaVuSans.ttf", 17)


def plugins(role: str) -> list[str]:
    return sorted(page.parent.name for page in ROOT.glob(f"plugins/{role}/*/README.md"))


# Name of a panel: the pipeline and the settings of `weft run`.
COMMANDS = {
    "filters": {name: ["filters_frex.yaml", *S_BEND, *ALL_MATCHES, f"filters.use=filters/{name}",
                       *EXTRA.get(name, [])] for name in plugins("filters")},
    "solvers": {name: ["true_matches.yaml", *BENT, f"solvers.use=solvers/{name}",
                       *EXTRA.get(name, [] if name in ON_SIGHTLINES else ["without=warps,passes"])]
                for name in plugins("solvers")},
    "detectors": {name: ["filters_frex.yaml", *S_BEND, f"detectors.use=detectors/{name}",
                         "filters.use=filters/oracle"] for name in plugins("detectors")},
    "matchers": {"descriptor": ["sparse.yaml", *VIDEO], "guided": ["guided.yaml", *VIDEO],
                 "track": ["tracked.yaml", *VIDEO], "dense_flow": ["dense.yaml", *VIDEO]},
}


class Frame:
    """The last frame of a run: its records, its image and its row of `weft eval --csv`."""

    def __init__(self, weft: str, command: list[str], dump: str, folder: Path):
        settings = [word for setting in command[1:] for word in ("--set", setting)]
        print("weft run pipelines/" + " ".join([command[0], *settings]), flush=True)
        subprocess.run([weft, "run", ROOT / "pipelines" / command[0], *settings, "--dump", dump, "--quiet",
                        "--out", folder], check=True, stdout=subprocess.DEVNULL)
        subprocess.run([weft, "eval", folder, "--quiet", "--csv", folder / "frames.csv"], check=True)
        self.figures = list(csv.DictReader((folder / "frames.csv").read_text().splitlines()))[-1]
        self.records = np.load(sorted(folder.glob("frames/*.npz"))[-1])
        self.template = np.load(folder / "template.npz")
        self.image = np.load(sorted(folder.glob(f"dumps/{dump}/[0-9]*.npz"))[-1]).get("in.image/pixels")

    def of(self, ending: str) -> np.ndarray:
        return self.records[next(name for name in self.records if name.endswith(ending))]

    def decisions(self) -> list:
        points, kept = self.of("correspondences/image_px"), self.of("inlier_mask/kept") > 0
        return [(points[~kept], ORANGE), (points[kept], BLUE)]


def panel(width: int, height: int, label: str) -> tuple[Image.Image, ImageDraw.ImageDraw]:
    """A white panel with a label in 30 rows above its content."""
    image = Image.new("RGB", (width, height + 30), "white")
    ImageDraw.Draw(image).text((4, 4), label, "black", FONT)
    return image, ImageDraw.Draw(image)


def match_panel(width: int, label: str, frame: Frame, marks: list) -> Image.Image:
    """The pale image and marks [(points, colour)]."""
    height = width * frame.image.shape[0] // frame.image.shape[1]
    image, draw = panel(width, height, label)
    pale = Image.fromarray((153 + 0.4 * frame.image).astype(np.uint8))
    image.paste(pale.resize((width, height), Image.Resampling.LANCZOS), (0, 30))
    for points, colour in marks:
        for x, y in points * width / frame.image.shape[1]:
            draw.ellipse((x - 2, y + 28, x + 2, y + 32), colour)
    return image


def grid(panels: list[Image.Image], columns: int, begin: int = 0) -> Image.Image:
    """The panels in rows, below `begin` empty rows of pixels."""
    height = panels[0].height
    image = Image.new("RGB", (WIDTH, begin + height * -(-len(panels) // columns)), "white")
    for index, each in enumerate(panels):
        image.paste(each, (index % columns * WIDTH // columns, begin + index // columns * height))
    return image


def filter_figure(frames: dict[str, Frame]) -> Image.Image:
    first = frames["oracle"]
    panels = [match_panel(394, f"{first.figures['filters_entered']} matches", first,
                          [(first.of("correspondences/image_px"), (90, 90, 90))])]
    for name, frame in frames.items():
        right, wrong = (100 * float(frame.figures[f"filters_rejected_{rejected}"])
                        / float(frame.figures[f"filters_{entered}"])
                        for rejected, entered in (("right", "correct"), ("wrong", "mismatches")))
        panels.append(match_panel(394, f"{name}: TPR {wrong:.1f}, FPR {right:.1f} %", frame,
                                  frame.decisions()))
    return grid(panels, 3)


def detector_figure(frames: dict[str, Frame]) -> Image.Image:
    return grid([match_panel(394, f"{name}: {frame.figures['filters_correct']} of "
                             f"{frame.figures['filters_entered']} matches are inliers", frame,
                             frame.decisions()) for name, frame in frames.items()], 3)


def matcher_figure(frames: dict[str, Frame]) -> Image.Image:
    points = {name: frame.of(f"{STAGES.get(name, 'matchers')}.correspondences/image_px")
              for name, frame in frames.items()}
    return grid([match_panel(594, f"{name}: {len(points[name])} matches", frame, [(points[name], BLUE)])
                 for name, frame in frames.items()], 2)


def colour_of(error_mm: float) -> tuple[int, ...]:
    places = np.linspace(0, MOST_MM, len(ERROR_COLOURS))
    return tuple(int(np.interp(error_mm, places, channel)) for channel in ERROR_COLOURS.T)


def shape_panel(label: str, frame: Frame) -> Image.Image:
    """The shape from the side, faces in the colour of their error, and lines of the true surface."""
    flat, points = frame.of("template_xy_m").round(9), frame.of("ground_truth/points_m")
    xs, ys = np.unique(flat[:, 0]), np.unique(flat[:, 1])
    true_grid = points[np.lexsort(flat.T)].reshape(len(ys), len(xs), 3)
    truth = np.array([[np.interp(y, ys, [np.interp(x, xs, row) for row in true_grid[:, :, axis]])
                       for axis in range(3)] for x, y, _ in frame.template["template/vertices_m"]])
    vertices = frame.of("shape/vertices_m")
    error_mm = 1000 * np.linalg.norm(vertices - truth, axis=1)
    seen, true_seen = ((each - points.mean(axis=0)) @ VIEW.T * 880 + (150, 135, 0)
                       for each in (vertices, true_grid))
    image, draw = panel(300, 210, label)
    for face in sorted(frame.template["template/faces"], key=lambda each: -seen[each, 2].mean()):
        draw.polygon([tuple(vertex) for vertex in seen[face, :2]], colour_of(error_mm[face].mean()))
    for line in (*true_seen[::5], *true_seen.transpose(1, 0, 2)[::9]):
        draw.line([tuple(point) for point in line[:, :2]], (120, 120, 120))
    return image


def solver_figure(frames: dict[str, Frame]) -> Image.Image:
    image = grid([shape_panel(f"{name}: {float(frame.figures['mean_mm']):.2f} mm", frame)
                  for name, frame in frames.items()], 4, begin=270)
    first = frames["collins_integrated"]  # which reads the image
    points = first.of("correspondences/image_px")
    image.paste(match_panel(320, f"{len(points)} matches", first, [(points, BLUE)]), (0, 0))
    draw = ImageDraw.Draw(image)
    draw.text((400, 60), "colour: 3D error of the vertices; grey: true surface", "black", FONT)
    for x in range(600):
        draw.line((400 + x, 110, 400 + x, 140), colour_of(x / 600 * MOST_MM))
    for mm in range(MOST_MM + 1):
        draw.text((394 + mm * 120, 146), f"{mm}" + " mm and more" * (mm == MOST_MM), "black", FONT)
    return image


FIGURES = {"filters": (filter_figure, "detectors"), "solvers": (solver_figure, "solvers"),
           "detectors": (detector_figure, "detectors"), "matchers": (matcher_figure, "detectors")}


def main(arguments: list[str]) -> int:
    wanted = arguments[2:] or list(FIGURES)
    if len(arguments) < 2 or not set(wanted) <= set(FIGURES):
        print(__doc__, file=sys.stderr)
        return 2
    Path(arguments[1]).mkdir(parents=True, exist_ok=True)
    for figure in wanted:
        draw, dump = FIGURES[figure]
        with tempfile.TemporaryDirectory() as folder:
            file = Path(arguments[1]) / f"{figure}.jpg"
            image = draw({name: Frame(arguments[0], command, STAGES.get(name, dump), Path(folder) / name)
                          for name, command in COMMANDS[figure].items()})
        image.resize((SAVED_WIDTH, image.height * SAVED_WIDTH // WIDTH), Image.Resampling.LANCZOS).save(
            file, quality=QUALITY, optimize=True, progressive=True)
        print(f"{file}: {file.stat().st_size} bytes")
        if file.stat().st_size > MOST_BYTES:
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
