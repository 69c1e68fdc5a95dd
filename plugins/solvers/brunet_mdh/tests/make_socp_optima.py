#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes socp_optima.txt: 20 random maximum-depth problems and their optima by CVXOPT's interior-point
solver (Debian: python3-cvxopt), which has nothing in common with the plugin.

usage: make_socp_optima.py > socp_optima.txt

Points are drawn on a sheet that is rolled to a cylinder, turned and moved in front of the camera; rays
are noisy; distances are those of the flat sheet between near points, and join all. Instances are
rounded to what is written before they are solved.
"""

import math
import random

from cvxopt import matrix, solvers, spmatrix

SEED = 20251104
INSTANCES = 20
NEIGHBOURS = 4
NOISE = 5e-4  # of a ray: 0.4 px at a focal length of 820 px


def turned(point, angles):
    """Turned about x, y and z, in this order."""
    x, y, z = point
    a, b, c = angles
    y, z = y * math.cos(a) - z * math.sin(a), y * math.sin(a) + z * math.cos(a)
    x, z = x * math.cos(b) + z * math.sin(b), z * math.cos(b) - x * math.sin(b)
    return x * math.cos(c) - y * math.sin(c), x * math.sin(c) + y * math.cos(c), z


def neighbours(flat):
    """Pairs of near points, and those that join what is left apart (Prim)."""
    count = len(flat)
    pairs = set()
    for i in range(count):
        near = sorted(range(count), key=lambda j: math.dist(flat[i], flat[j]))
        pairs.update((min(i, j), max(i, j)) for j in near[1:NEIGHBOURS + 1])
    joined = {0}
    while len(joined) < count:
        i, j = min(((i, j) for i in joined for j in range(count) if j not in joined),
                   key=lambda pair: math.dist(flat[pair[0]], flat[pair[1]]))
        pairs.add((min(i, j), max(i, j)))
        joined.add(j)
    return sorted(pairs)


def draw_instance(rng):
    """Rays [n][3] and edges [(i, j, distance in m)]."""
    flat = [(rng.uniform(-0.15, 0.15), rng.uniform(-0.1, 0.1)) for _ in range(rng.randint(5, 16))]
    radius = rng.choice((-1, 1)) * rng.uniform(0.12, 0.5)
    angles = [rng.uniform(-0.4, 0.4), rng.uniform(-0.4, 0.4), rng.uniform(-1.5, 1.5)]
    distance = rng.uniform(0.4, 0.9)
    rays = []
    for u, v in flat:
        x, y, z = turned((radius * math.sin(u / radius), v, radius * (1.0 - math.cos(u / radius))), angles)
        ray = [x / (z + distance) + rng.gauss(0.0, NOISE), y / (z + distance) + rng.gauss(0.0, NOISE), 1.0]
        length = math.hypot(*ray)
        rays.append([round(value / length, 9) for value in ray])
    return rays, [(i, j, round(math.dist(flat[i], flat[j]), 6)) for i, j in neighbours(flat)]


def optimum(rays, edges):
    """max sum mu  subject to  |mu_i v_i - mu_j v_j| <= d_ij for all edges, mu >= 0; in m."""
    count = len(rays)
    cones, limits = [], []
    for i, j, length in edges:
        values = [-value for value in rays[i]] + list(rays[j])
        cones.append(spmatrix(values, [1, 2, 3, 1, 2, 3], [i] * 3 + [j] * 3, (4, count)))
        limits.append(matrix([length, 0.0, 0.0, 0.0]))
    not_behind = spmatrix(-1.0, range(count), range(count))
    solvers.options.update(show_progress=False, abstol=1e-8, reltol=1e-8, feastol=1e-8)
    solution = solvers.socp(matrix(-1.0, (count, 1)), Gl=not_behind, hl=matrix(0.0, (count, 1)),
                            Gq=cones, hq=limits)
    assert solution["status"] == "optimal", solution["status"]
    return -solution["primal objective"]


def main():
    print("# SPDX-License-Identifier: Apache-2.0")
    print(f"# By make_socp_optima.py, seed {SEED}: points and edges, then rays, then edges as i j m,")
    print("# then the largest sum of depths in m.")
    rng = random.Random(SEED)
    for _ in range(INSTANCES):
        rays, edges = draw_instance(rng)
        best = optimum(rays, edges)
        print(len(rays), len(edges))
        for ray in rays:
            print(*(f"{value:.9f}" for value in ray))
        for i, j, length in edges:
            print(i, j, f"{length:.6f}")
        print(f"{best:.9f}")


if __name__ == "__main__":
    main()
