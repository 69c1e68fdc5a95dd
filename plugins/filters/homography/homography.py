# SPDX-License-Identifier: Apache-2.0
"""A flat sheet in perspective, found among mismatches."""

import math

import numpy as np
import weft

MOST_AT_ONCE = 2**18  # matches times samples
FEWEST_AGREEING = 8
MISSED = 0.01  # chance that no sample so far was without a mismatch


def similarity(points):
    """The map [3,3] to a mean of 0 and a mean norm of sqrt(2) (Hartley 1997)."""
    centre = points.mean(axis=0)
    scale = math.sqrt(2.0) / max(np.hypot(*(points - centre).T).mean(), 1e-12)
    return np.array([[scale, 0.0, -scale * centre[0]], [0.0, scale, -scale * centre[1]], [0.0, 0.0, 1.0]])


def moved(maps, points):
    """Points [N,2] by maps [...,3,3]: [...,N,2], infinite where a map sends them behind the camera."""
    lifted = np.column_stack([points, np.ones(len(points))]) @ np.swapaxes(maps, -1, -2)
    front = np.median(lifted[..., 2:], axis=-2, keepdims=True)
    lifted *= np.where(front < 0.0, -1.0, 1.0)
    depth = lifted[..., 2:]
    ahead = depth > 1e-9
    return np.where(ahead, lifted[..., :2] / np.where(ahead, depth, 1.0), np.inf)


def corner_distance(maps, start, end):
    """How far start, moved by maps [...,3,3], is from end, each [N,2]: [...,N]."""
    return np.hypot(*np.moveaxis(moved(maps, start) - end, -1, 0))


def on_a_line(points):
    if len(points) < 3:
        return True
    spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    return spread[1] <= 1e-3 * spread[0]


def fitted(start, end):
    """The homographies [...,3,3] of least algebraic error from start to end, each [...,N,2]."""
    x, y = start[..., 0], start[..., 1]
    u, v = end[..., 0], end[..., 1]
    zero, one = np.zeros_like(x), np.ones_like(x)
    rows = np.concatenate([
        np.stack([x, y, one, zero, zero, zero, -u * x, -u * y, -u], axis=-1),
        np.stack([zero, zero, zero, x, y, one, -v * x, -v * y, -v], axis=-1)], axis=-2)
    _, _, axes = np.linalg.svd(rows, full_matrices=rows.shape[-2] < 9)
    return axes[..., -1, :].reshape(*axes.shape[:-2], 3, 3)


class Homography(weft.Filter):
    """Keeps the matches of a flat sheet in perspective, by one homography."""

    id = "filters/homography"
    version = "1.0.0"
    reference = "paper: Hartley, In defense of the eight-point algorithm, PAMI 1997; Torr and Zisserman, MLESAC, CVIU 2000"
    determinism = "tolerance"
    random = True
    sweep = ("tolerance_px", [0.5, 1, 2, 3, 5, 10, 20, 40, 80])

    tolerance_px = weft.number(5.0, "px", (0.1, 1000), "kept within this of where the plane puts them")
    most_draws = weft.whole(2048, "", (1, 1000000), "samples of four matches at most")

    def filter(self, given):
        matches = given.correspondences
        judged = np.flatnonzero(matches.kept)  # an earlier filter rejected the others
        if judged.size < 4:
            raise weft.NoResult(f"{judged.size} matches are left; a plane needs 4")
        template_px, image_px = matches.template_px[judged], matches.image_px[judged]
        before, after = similarity(template_px), similarity(image_px)
        start, end = moved(before, template_px), moved(after, image_px)
        bound = self.tolerance_px * after[0, 0]
        found, draws = self.best(given.call, start, end, bound)
        if found is None:
            raise weft.NoResult("no four matches make a plane: they lie on a line, or in one place")
        off_px = corner_distance(found, start, end) / after[0, 0]
        within = off_px <= self.tolerance_px
        if on_a_line(start[within]) or on_a_line(end[within]):
            raise weft.NoResult("the matches that agree lie on a line, or in one place")
        if within.sum() < min(FEWEST_AGREEING, judged.size):
            raise weft.NoResult(f"low consensus: {within.sum()} matches agree on a plane")
        kept, score = np.zeros(len(matches.kept), np.uint8), np.zeros(len(matches.kept))
        kept[judged] = within
        score[judged] = self.tolerance_px / (self.tolerance_px + off_px)
        return weft.Record(kept=kept, score=score,
                           diag={"kept_matches": float(within.sum()), "candidates": float(judged.size),
                                 "draws": float(draws)})

    def best(self, call, start, end, bound):
        """The homography of the least sum of squares, each cut at that of the bound, or None; and how
        many were drawn."""
        rng, count = call.rng(), len(start)
        batch = min(64, max(1, MOST_AT_ONCE // count))
        least, found, draws, wanted = math.inf, None, 0, self.most_draws
        while draws < wanted:
            call.go_on()
            drawn = np.array([rng.choice(count, 4, replace=False) for _ in range(min(batch, wanted - draws))])
            draws += len(drawn)
            maps = fitted(start[drawn], end[drawn])
            maps = maps[np.linalg.cond(maps) < 1e9]
            if not len(maps):
                continue
            off = corner_distance(maps, start, end)
            costs = (np.minimum(off, bound) ** 2).sum(axis=1)
            winner = np.argmin(costs)
            if costs[winner] < least:
                least, found = costs[winner], maps[winner]
                share = max(np.mean(off[winner] <= bound), 1e-9)
                wanted = min(wanted, math.ceil(math.log(MISSED) / math.log1p(-min(share**4, 1.0 - 1e-9))))
        for _ in range(3 if found is not None else 0):
            within = corner_distance(found, start, end) <= bound
            if within.sum() >= 4:
                found = fitted(start[within], end[within])
        return found, draws
