# SPDX-License-Identifier: Apache-2.0
"""Generates matches of a surface that is rolled ever more tightly, with exact ground truth."""

import numpy as np
import weft

WIDTH_M, HEIGHT_M = 0.297, 0.178
COLUMNS, ROWS = 24, 14  # size of the grid of matches
FRAMES_A_SECOND = 30.0
FOCAL_PX, CENTRE_PX = 820.0, (319.5, 239.5)


def rolled(place_m, curvature_per_m, distance_m):
    """Points of a surface rolled about an upright axis behind it, as a circular cylinder: [N,3] m,
    camera frame, for the template positions [N,2] m. Lengths along the surface are kept."""
    arc_m = place_m[:, 0] - 0.5 * WIDTH_M
    half_turn_rad = 0.5 * curvature_per_m * arc_m
    # sinc(a / pi) is sin(a) / a, and 1 where nothing is bent.
    across_m = arc_m * np.sinc(curvature_per_m * arc_m / np.pi)
    behind_m = arc_m * np.sin(half_turn_rad) * np.sinc(half_turn_rad / np.pi)
    return np.column_stack([across_m, place_m[:, 1] - 0.5 * HEIGHT_M, distance_m + behind_m])


class MyPluginSource(weft.Source):
    """Generates matches of a surface that is rolled ever more tightly, with exact ground truth."""

    id = "sources/my_plugin"
    version = "1.0.0"
    produces = "time correspondences ground_truth"
    random = True

    frames = weft.whole(5, "", (1, 1000000), "number of frames")
    bend_per_m = weft.number(6.0, "1/m", (0, 10), "curvature of the surface in the last frame")
    distance_m = weft.number(0.65, "m", (0.1, 100), "distance from the camera to the centre of the surface")
    noise_px = weft.number(0.5, "px", (0, 1000), "standard deviation, along u and v, of the image points")

    def open(self, given):
        return weft.Record(fx=FOCAL_PX, fy=FOCAL_PX, cx=CENTRE_PX[0], cy=CENTRE_PX[1], width=640, height=480)

    def count(self, given):
        return self.frames

    def read(self, given):
        frame = given.call.frame
        if frame >= self.frames:
            raise weft.Failure(f"there is no frame {frame}")
        column, row = np.meshgrid(np.arange(COLUMNS), np.arange(ROWS))
        place_m = np.column_stack([(column.ravel() + 0.5) * WIDTH_M / COLUMNS,
                                   (row.ravel() + 0.5) * HEIGHT_M / ROWS])
        points_m = rolled(place_m, (frame + 1) / self.frames * self.bend_per_m, self.distance_m)
        pixels_px = FOCAL_PX * points_m[:, :2] / points_m[:, 2:] + CENTRE_PX
        # The random numbers belong to this frame, in any order of reading.
        noise_px = self.noise_px * given.call.rng().standard_normal(pixels_px.shape)
        count = len(place_m)
        matches = weft.Record(
            template_px=np.zeros((count, 2)),  # the host makes it of the next
            template_xy_m=place_m, image_px=pixels_px + noise_px,
            face=np.full(count, -1, np.int32),  # the host finds it
            barycentrics=np.zeros((count, 3)), kept=np.ones(count, bool), score=np.ones(count))
        truth = weft.Record(template_xy_m=place_m, points_m=points_m, match_xy_px=pixels_px, kind="formula")
        return {"time": weft.Record(t_s=frame / FRAMES_A_SECOND), "correspondences": matches,
                "ground_truth": truth}
