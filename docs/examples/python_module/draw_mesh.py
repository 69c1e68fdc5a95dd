#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws the mesh that a pipeline finds in an image: draw_mesh.py PIPELINE IMAGE PICTURE.png"""

import sys

import numpy as np
import weft
from matplotlib.figure import Figure
from PIL import Image

camera = weft.Camera(fx=820.0, fy=820.0, cx=319.5, cy=239.5, width_px=640, height_px=480)
file, name, picture = sys.argv[1:]

image = np.asarray(Image.open(name).convert("RGB"))[..., ::-1]
with weft.Pipeline(file, camera) as pipeline:
    frame = pipeline.process(image)
if frame.vertices_m is None:
    sys.exit(f"{name}: no shape: " + "; ".join(stage.reason for stage in frame.stages if stage.reason))

figure = Figure(figsize=(9.6, 3.6), layout="constrained")
weft.draw(pipeline.template, frame.vertices_m, image=image, camera=camera, source=frame.source,
          ax=figure.add_subplot(1, 2, 1))
std_mm = None
if frame.covariance_m2 is not None:
    std_mm = 1000 * np.sqrt(np.trace(frame.covariance_m2, axis1=1, axis2=2))
weft.draw(pipeline.template, frame.vertices_m, values=std_mm, ax=figure.add_subplot(1, 2, 2, projection="3d"))
figure.axes[1].set_title("" if std_mm is None else "standard deviation, mm", fontsize="medium")
figure.savefig(picture)
print(f"{name}: {frame.state}, {len(frame.vertices_m)} vertices, drawn into {picture}")
