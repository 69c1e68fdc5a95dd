# SPDX-License-Identifier: Apache-2.0
"""Keeps a match that lies where one affine map of the whole template puts it."""

import numpy as np
import weft

FEWEST = 4  # matches; three lie on an affine map whatever they are
ROUNDS = 30
NOTHING_PX = 0.1  # added to residuals, so that no weight is infinite


def affine_fit(start, end, go_on):
    """Distance of each match [N] from its prediction by the affine map y = (x, 1) A, px. A minimises the
    sum of these distances, by iterative reweighting with 1 / residual. Also returns the rank of the fit,
    below 3 for matches on a line or in one place."""
    weight = np.ones((len(start), 1))
    for _ in range(ROUNDS):
        go_on()
        found, _, rank, _ = np.linalg.lstsq(weight * start, weight * end, rcond=1e-9)
        residual_px = np.linalg.norm(end - start @ found, axis=1)
        weight = 1.0 / np.sqrt(residual_px + NOTHING_PX)[:, None]
    return residual_px, rank


class MyPluginFilter(weft.Filter):
    """Keeps matches that agree with one affine map of the template."""

    id = "filters/my_plugin"
    version = "1.0.0"
    sweep = ("tolerance_px", [1, 2, 4, 8, 16, 32, 64, 128])

    tolerance_px = weft.number(30.0, "px", (0, 1000), "maximum distance of a kept match from the affine map")

    def filter(self, given):
        matches = given.correspondences
        judged = np.flatnonzero(matches.kept)  # matches that an earlier filter rejected do not count
        if len(judged) < FEWEST:
            raise weft.NoResult(f"{len(judged)} matches are left; at least {FEWEST} are needed")
        start = np.column_stack([matches.template_px[judged], np.ones(len(judged))])
        residual_px, rank = affine_fit(start, matches.image_px[judged], given.call.go_on)

        kept, score = np.zeros(len(matches.kept), bool), np.zeros(len(matches.kept))
        kept[judged] = residual_px <= self.tolerance_px
        score[judged] = 1.0 / (1.0 + residual_px)
        mask = weft.Record(kept=kept, score=score, diag={"mean_residual_px": residual_px.mean()})
        if rank < 3:
            return weft.degenerate(mask, "the matches lie on a line or in one place")
        return mask
