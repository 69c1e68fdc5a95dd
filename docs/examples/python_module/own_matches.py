#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The shape of each file of matches: own_matches.py PIPELINE MATCHES.csv ..."""

import sys

import numpy as np
import weft

camera = weft.Camera(fx=820.0, fy=820.0, cx=319.5, cy=239.5, width_px=640, height_px=480)
file, *tables = sys.argv[1:]

with weft.Pipeline(file, camera, inputs=["matches"]) as pipeline:
    for name in tables:
        # The columns template_x_px, template_y_px, image_x_px and image_y_px.
        table = np.loadtxt(name, delimiter=",", skiprows=1, usecols=(0, 1, 2, 3))
        matches = weft.Matches(table[:, :2], table[:, 2:])
        frame = pipeline.process(matches=matches)
        kept = frame.report["stages"][1]["kept"]
        print(f"{name}: {frame.state}, {kept} of {len(matches)} matches kept")
