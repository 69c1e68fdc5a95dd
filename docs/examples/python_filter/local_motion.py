# SPDX-License-Identifier: Apache-2.0
"""The filter of docs/examples/your_own_filter, in NumPy."""

import numpy as np
import weft


class LocalMotion(weft.Filter):
    """Rejects matches that move on their own."""

    id = "filters/local_motion_numpy"
    version = "1.0.0"
    sweep = ("max_deviation_px", [1, 2, 5, 10, 15, 20, 40, 80, 150])

    radius_px = weft.number(60.0, "px", (1, 1000), "radius of the neighbourhood on the template")
    max_deviation_px = weft.number(15.0, "px", (0, 500), "maximum distance from median")

    def filter(self, given):
        matches = given.correspondences
        judged = np.flatnonzero(matches.kept)  # an earlier filter rejected the others
        if judged.size == 0:
            raise weft.NoResult("no match is left to judge")
        at = matches.template_px[judged]
        motion = matches.image_px[judged] - at
        kept, score = np.zeros(len(matches.kept), np.uint8), np.zeros(len(matches.kept))
        for i, match in enumerate(judged):
            given.call.go_on()
            near = np.hypot(*(at - at[i]).T) <= self.radius_px
            deviation_px = np.hypot(*(motion[i] - np.median(motion[near], axis=0)))
            kept[match] = deviation_px <= self.max_deviation_px
            score[match] = 1.0 / (1.0 + deviation_px)
        return weft.Record(kept=kept, score=score)
