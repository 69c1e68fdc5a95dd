#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Feeds images to a pipeline and prints what came of each: from_memory.py PIPELINE IMAGE..."""

import sys

import numpy as np
import weft
from PIL import Image

camera = weft.Camera(fx=820.0, fy=820.0, cx=319.5, cy=239.5, width_px=640, height_px=480)
file, *images = sys.argv[1:]

with weft.Pipeline(file, camera) as pipeline:
    for name in images:
        image = np.asarray(Image.open(name).convert("RGB"))[..., ::-1]  # BGR, as cv2.imread() gives it
        frame = pipeline.process(image)
        if frame.vertices_m is None:
            print(f"{name}: {frame.state}: " + "; ".join(s.reason for s in frame.stages if s.reason))
            continue
        x_m, y_m, z_m = frame.vertices_m.mean(axis=0)
        print(f"{name}: {frame.state}, confidence {frame.confidence:.2f}, centre at {x_m:.3f} {y_m:.3f} {z_m:.3f} m")
