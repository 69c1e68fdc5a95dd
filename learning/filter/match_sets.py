# SPDX-License-Identifier: Apache-2.0
"""Random match sets by formula: points of a bent surface, their images and several kinds of mismatches."""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np

TOLERANCE_PX = 3.0
IMAGE_PX = np.array([640.0, 480.0])
FOCAL_PX = 820.0


@dataclass
class MatchSet:
    """The matches of one frame. Absent values of a kind are NaN in all rows."""

    template_px: np.ndarray  # [N,2]
    image_px: np.ndarray  # [N,2]
    log_scale: np.ndarray  # [N] logarithm of image scale / template scale
    angle_rad: np.ndarray  # [N] image minus template
    ratio: np.ndarray  # [N] of descriptor distances
    label: np.ndarray  # [N] 1 inlier, 0 mismatch, -1 unknown
    half_diagonal_px: float  # of the template's texture

    def rows(self, chosen: np.ndarray) -> "MatchSet":
        """The set of some of its matches."""
        columns = (self.template_px, self.image_px, self.log_scale, self.angle_rad, self.ratio, self.label)
        return MatchSet(*(column[chosen] for column in columns), self.half_diagonal_px)


def rotation(axis_angle: np.ndarray) -> np.ndarray:
    """Rotation matrix of an axis-angle vector."""
    angle = np.linalg.norm(axis_angle) + 1e-12
    x, y, z = axis_angle / angle
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


class Surface:
    """A random generalised cylinder with a smooth, slightly stretching bump, before a camera."""

    def __init__(self, rng: np.random.Generator, size_m: np.ndarray):
        reach = 0.5 * np.linalg.norm(size_m)
        self.direction = rng.uniform(0, np.pi)
        self.s = np.linspace(-1.2 * reach, 1.2 * reach, 400)
        curvature = rng.normal(0, 3) * np.ones_like(self.s)
        for _ in range(rng.integers(0, 4)):
            period = rng.uniform(0.5, 3) * 2 * reach
            strength = rng.normal(0, 1.6) * 2 * np.pi / period / 3
            curvature += strength * np.sin(2 * np.pi * self.s / period + rng.uniform(0, 2 * np.pi))
        if rng.random() < 0.25:  # a fold or rolled corner: curvature beside one ruling
            at, width = rng.uniform(-0.8, 0.8) * reach, rng.uniform(0.05, 0.3) * reach
            curvature += rng.uniform(-2.4, 2.4) / width / 2.5 * np.exp(-0.5 * ((self.s - at) / width) ** 2)
        step = self.s[1] - self.s[0]
        turn = np.cumsum(curvature) * step
        turn -= np.interp(0.0, self.s, turn)
        self.along, self.depth = np.cumsum(np.cos(turn)) * step, np.cumsum(np.sin(turn)) * step
        self.along -= np.interp(0.0, self.s, self.along)
        self.depth -= np.interp(0.0, self.s, self.depth)
        self.stretch = rng.uniform(-0.1, 0.15) if rng.random() < 0.3 else 0.0
        self.bump = rng.normal(0, 0.012) if rng.random() < 0.4 else 0.0
        self.bump_at, self.bump_m = rng.uniform(-0.4, 0.4, 2) * size_m, rng.uniform(0.25, 0.7) * reach
        self.pose = rotation(rng.normal(0, 1, 3) * np.array([0.25, 0.25, 0.3]))
        self.centre_m = np.array([*rng.normal(0, 0.03, 2), rng.uniform(0.4, 0.95)])

    def image_px(self, point_m: np.ndarray) -> np.ndarray:
        """The image of points of the flat surface."""
        c, s = np.cos(self.direction), np.sin(self.direction)
        point_m = point_m * np.array([1 + self.stretch, 1.0])
        across, beside = point_m @ np.array([c, s]), point_m @ np.array([-s, c])
        along, depth = np.interp(across, self.s, self.along), np.interp(across, self.s, self.depth)
        gap = ((point_m - self.bump_at) ** 2).sum(1) / self.bump_m**2
        depth = depth + self.bump * np.exp(-gap)
        bent = np.stack([c * along - s * beside, s * along + c * beside, depth], 1)
        camera = bent @ self.pose.T + self.centre_m
        return FOCAL_PX * camera[:, :2] / np.maximum(camera[:, 2:], 0.05) + 0.5 * (IMAGE_PX - 1)


def template_points(rng: np.random.Generator, count: int, size_px: np.ndarray) -> np.ndarray:
    """Keypoints of a texture: uniform, in clusters, or a mixture of both."""
    points = rng.uniform(0, 1, (count, 2))
    if rng.random() < 0.6:
        centres = rng.uniform(0, 1, (rng.integers(3, 40), 2))
        clustered = rng.random(count) < rng.uniform(0.2, 0.9)
        near = centres[rng.integers(0, len(centres), count)] + rng.normal(0, rng.uniform(0.01, 0.1), (count, 2))
        points[clustered] = near[clustered]
    return np.clip(points, 0, 1) * size_px


def mismatch_images(rng, surface, to_m, template_px, size_px, true_px):
    """Images, log scales and turns of mismatches of a mixture of kinds."""
    count = len(template_px)
    kinds = rng.choice(6, count, p=rng.dirichlet([1.2, 0.7, 0.6, 0.9, 0.6, 0.25]))
    low, high = np.percentile(true_px, [2, 98], axis=0)
    image = rng.uniform(0, IMAGE_PX, (count, 2))  # kind 0: anywhere
    log_scale, angle = rng.normal(0, 0.7, count), rng.uniform(-np.pi, np.pi, count)
    image[kinds == 1] = rng.uniform(low, high, ((kinds == 1).sum(), 2))
    hubs = rng.uniform(0, IMAGE_PX, (rng.integers(2, 30), 2))  # few image points attract many
    hub = rng.integers(0, len(hubs), count)
    hubbed = kinds == 2
    image[hubbed] = hubs[hub[hubbed]] + rng.normal(0, rng.choice([0.01, 6.0]), (hubbed.sum(), 2))
    copy = kinds == 3  # look-alike copies of the texture
    copies = rng.integers(1, 4)
    which = rng.integers(0, copies, count)
    for k in range(copies):
        mine = copy & (which == k)
        turn, scale = rng.uniform(-np.pi, np.pi), rng.uniform(0.15, 0.6)
        c, s = np.cos(turn), np.sin(turn)
        offset = rng.uniform(0, IMAGE_PX) - scale * (0.5 * size_px) @ np.array([[c, s], [-s, c]])
        image[mine] = scale * template_px[mine] @ np.array([[c, s], [-s, c]]) + offset
        image[mine] += rng.normal(0, 0.8, (mine.sum(), 2))
        log_scale[mine] = np.log(scale) + rng.normal(0, 0.15, mine.sum())
        angle[mine] = turn + rng.normal(0, 0.1, mine.sum())
    repeat = kinds == 4  # another instance of a repeated detail of the texture
    period = rng.uniform(0.04, 0.3) * size_px
    jumps = rng.integers(-2, 3, (count, 2)) * rng.choice([[1, 1], [1, 0], [0, 1]])
    jumps[(jumps == 0).all(1), 0] = 1
    image[repeat] = surface.image_px(to_m(template_px[repeat] + jumps[repeat] * period))
    image[repeat] += rng.normal(0, 0.8, (repeat.sum(), 2))
    near = kinds == 5  # a neighbouring detail
    away = rng.exponential(12, (count, 1)) + 3.5
    heading = rng.normal(0, 1, (count, 2))
    heading /= np.linalg.norm(heading, axis=1, keepdims=True)
    image[near] = true_px[near] + (away * heading)[near]
    return image, log_scale, angle, repeat | near


def draw(rng: np.random.Generator, most: int = 1200) -> MatchSet:
    """A random match set of 4 to `most` matches."""
    count = int(np.exp(rng.uniform(np.log(30), np.log(most))))
    size_px = np.array([rng.uniform(400, 1600), 1.0])
    size_px[1] = size_px[0] * rng.uniform(0.45, 1.4)
    metres = rng.uniform(0.15, 0.4) / size_px[0]
    to_m = lambda points: (points - 0.5 * size_px) * metres
    surface = Surface(rng, size_px * metres)
    template_px = template_points(rng, count, size_px)
    true_px = surface.image_px(to_m(template_px))
    step = 1.0
    du = (surface.image_px(to_m(template_px + [step, 0])) - true_px) / step
    dv = (surface.image_px(to_m(template_px + [0, step])) - true_px) / step
    area = du[:, 0] * dv[:, 1] - du[:, 1] * dv[:, 0]
    seen = (area > 0.02 * np.abs(area).mean()) & ((true_px > 0) & (true_px < IMAGE_PX)).all(1)
    if rng.random() < 0.35:  # something covers a part
        at, radius = rng.uniform(0.1, 0.9, 2) * IMAGE_PX, rng.uniform(30, 150)
        seen &= np.linalg.norm(true_px - at, axis=1) > radius
    image = true_px + rng.normal(0, 1, (count, 2)) * rng.choice([0.3, 0.6, 1.0])
    log_scale = 0.5 * np.log(np.maximum(area, 1e-4)) + rng.standard_t(3, count) * 0.1
    true_angle = np.arctan2(du[:, 1] - dv[:, 0], du[:, 0] + dv[:, 1])
    angle = true_angle + np.where(rng.random(count) < 0.05, rng.uniform(-3, 3, count), rng.normal(0, 0.1, count))
    inlier = seen & (rng.random(count) < rng.uniform(0.08, 1.0))
    wrong, wrong_scale, wrong_angle, alike = mismatch_images(rng, surface, to_m, template_px, size_px, true_px)
    wrong_scale[~alike] += np.log(rng.uniform(0.3, 0.9))
    wrong_scale[alike], wrong_angle[alike] = log_scale[alike], angle[alike]
    image[~inlier], log_scale[~inlier], angle[~inlier] = wrong[~inlier], wrong_scale[~inlier], wrong_angle[~inlier]
    inside = ((image > -0.5) & (image < IMAGE_PX)).all(1)
    label = ((np.linalg.norm(image - true_px, axis=1) < TOLERANCE_PX) & seen).astype(np.int8)
    cut = rng.choice([0.8, 1.0])
    right_ratio = rng.beta(rng.uniform(2, 5), 2.5, count)
    wrong_ratio = 1 - np.abs(rng.normal(0, 0.08, count))
    ratio = np.where(inlier | (rng.random(count) < 0.1), right_ratio, wrong_ratio) * (cut if cut < 1 else 1)
    found = MatchSet(template_px, image, log_scale, np.remainder(angle + np.pi, 2 * np.pi) - np.pi, ratio, label,
                     0.5 * float(np.linalg.norm(size_px)))
    return found.rows(inside)


def draw_many(count: int, seed: int) -> list[MatchSet]:
    """Sets with both inliers and mismatches; the same for the same seed."""
    rng = np.random.default_rng(seed)
    sets: list[MatchSet] = []
    while len(sets) < count:
        drawn = draw(rng)
        if (drawn.label == 1).sum() >= 4 and len(drawn.label) >= 8:
            sets.append(drawn)
    return sets
