# SPDX-License-Identifier: Apache-2.0
"""Fits the template at rest as a rigid body."""

import numpy as np
import weft

FEWEST = 4  # sightlines
SETTLED = 1e-12  # largest change of a rotation that ends the rounds
AGREES_PX = 3.0
WIDELY = 8  # sightlines that agree, below which the confidence is less


def aligned(start, end):
    """The rotation R and translation t with the least sum of |R start + t - end|^2, of points [N,3]."""
    middle, target = start.mean(axis=0), end.mean(axis=0)
    u, spread, vt = np.linalg.svd((start - middle).T @ (end - target))
    if not spread[1] > 1e-12 * max(spread[0], 1e-300):
        raise weft.NoResult("the points lie on a line or in one place")
    flip = np.diag([1.0, 1.0, np.sign(np.linalg.det(vt.T @ u.T))])
    rotation = vt.T @ flip @ u.T
    return rotation, target - rotation @ middle


def rigid_pose(rest_m, ray, rounds, go_on):
    """The rotation and translation with the least sum of squared distances of the points from their rays, by
    orthogonal iteration. The best translation of a rotation has a closed form. The next rotation aligns
    the points with their nearest points on the rays."""
    # The initial pose faces the camera, with the rotation of the image.
    rotation, place_m = aligned(rest_m, ray / ray[:, 2:])
    across = np.eye(3) - ray[:, :, None] * ray[:, None, :]  # takes away what lies along a ray
    inverse = np.linalg.inv(across.sum(axis=0))
    for _ in range(rounds):
        go_on()
        turned_m = rest_m @ rotation.T
        place_m = -inverse @ np.einsum("nij,nj->i", across, turned_m)
        moved_m = turned_m + place_m
        on_ray_m = (moved_m * ray).sum(axis=1, keepdims=True) * ray
        before = rotation
        rotation, place_m = aligned(rest_m, on_ray_m)
        if np.abs(rotation - before).max() < SETTLED:
            break
    return rotation, place_m


def checked(lines, template):
    """Refuses a sightline that names no vertex or face of the template."""
    bad = np.where(lines.vertex >= 0, lines.vertex >= len(template.vertices_m),
                   (lines.face < 0) | (lines.face >= len(template.faces)))
    if bad.any():
        raise weft.Failure(f"sightline {np.argmax(bad)} names no vertex or face of the template")
    return lines


class MyPluginSolver(weft.Solver):
    """Fits the template at rest as a rigid body."""

    id = "solvers/my_plugin"
    version = "1.0.0"
    reference = ("paper: Lu, Hager and Mjolsness, Fast and globally convergent pose estimation from video images, IEEE "
                 "PAMI 22(6), 2000")
    needs = "sightlines"

    rounds = weft.whole(500, "", (1, 100000), "maximum number of iterations of the pose search")

    def solve(self, given):
        template, camera = given.template, given.camera
        lines = checked(given.sightlines, template)
        used = (lines.weight > 0.0) & (lines.ray[:, 2] > 0.0)
        if np.count_nonzero(used) < FEWEST:
            raise weft.NoResult(f"{np.count_nonzero(used)} sightlines count; at least {FEWEST} are needed")
        vertex, ray = lines.vertex[used], lines.ray[used]
        corners = template.faces[np.maximum(lines.face[used], 0)]
        inside_m = np.einsum("nk,nkj->nj", lines.barycentrics[used], template.vertices_m[corners])
        rest_m = np.where((vertex >= 0)[:, None], template.vertices_m[np.maximum(vertex, 0)], inside_m)
        rotation, place_m = rigid_pose(rest_m, ray, self.rounds, given.call.go_on)

        vertices_m = template.vertices_m @ rotation.T + place_m
        if not (np.isfinite(vertices_m).all() and vertices_m[:, 2].min() > 0.0):
            raise weft.NoResult("the surface would reach behind the camera")
        source = np.zeros(len(vertices_m), np.uint8)
        source[vertex[vertex >= 0]] = 1
        source[corners[vertex < 0]] = 1
        placed_m = rest_m @ rotation.T + place_m
        off_ray_m = placed_m - (placed_m * ray).sum(axis=1, keepdims=True) * ray
        seen_px = placed_m[:, :2] / placed_m[:, 2:] * [camera.fx, camera.fy] + [camera.cx, camera.cy]
        agree = np.count_nonzero(np.linalg.norm(seen_px - lines.pixel_px[used], axis=1) < AGREES_PX)
        return weft.Record(vertices_m=vertices_m, source=source,
                           confidence=min(1.0, agree / WIDELY) * agree / len(ray),
                           diag={"rms_from_rays_m": np.sqrt(np.square(off_ray_m).sum(axis=1).mean())})
