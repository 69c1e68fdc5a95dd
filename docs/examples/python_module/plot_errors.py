#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws the error of each frame of a run that `weft eval` has measured: plot_errors.py RUN PICTURE.png"""

import sys

import numpy as np
import weft
from matplotlib.figure import Figure

run = weft.open_run(sys.argv[1])
errors_mm = run.errors_mm
figure = Figure(figsize=(6.4, 3.2), layout="constrained")
axes = figure.add_subplot(xlabel="frame", ylabel="mean 3D error, mm")
axes.plot([frame.index for frame in run], errors_mm, ".-")
axes.set_ylim(bottom=0)
figure.savefig(sys.argv[2])

solved = np.isfinite(errors_mm)
print(f"{solved.sum()} of {len(run)} frames with an error, {errors_mm[solved].mean():.3f} mm on average, "
      f"{errors_mm[solved].max():.3f} mm at worst; matches {run.stage('matchers', 'matches').mean():.0f} a frame")
