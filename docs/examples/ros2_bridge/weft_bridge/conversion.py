# SPDX-License-Identifier: Apache-2.0
"""What messages of ROS hold of a frame, as read_points.frames() gives it. Needs NumPy, not ROS."""

import numpy as np

# Of each point four float32: its place in m, and the standard deviation in m along the direction
# in which it is least certain, NaN where the solver gives none.
FIELDS = ("x", "y", "z", "std")
FIELD_BYTES = 4
POINT_BYTES = FIELD_BYTES * len(FIELDS)

# Red, green, blue and opacity of the mesh, by the state of the shape.
COLOURS = {"estimated": (0.2, 0.5, 0.9, 0.9), "weak": (0.9, 0.7, 0.2, 0.9)}
OLDER = (0.6, 0.6, 0.6, 0.5)


def stds_m(frame):
    """[V] m: the root of the largest eigenvalue of each vertex's covariance, or NaN."""
    if frame["covariance_m2"] is None:
        return np.full(len(frame["vertices_m"]), np.nan)
    largest_m2 = np.linalg.eigvalsh(np.asarray(frame["covariance_m2"]))[:, -1]
    return np.sqrt(np.maximum(largest_m2, 0.0))


def point_data(frame):
    """The data of a PointCloud2, little-endian: FIELDS of each vertex."""
    rows = np.empty((len(frame["vertices_m"]), len(FIELDS)), "<f4")
    rows[:, :3] = frame["vertices_m"]
    rows[:, 3] = stds_m(frame)
    return rows.tobytes()


def faces_of(file):
    """[F,3] of the template.npz of a run folder."""
    with np.load(file) as arrays:
        return arrays["template/faces"].astype(np.int64)


def corners_m(frame, faces):
    """[3 F,3] m: the places of the faces' corners, three by three."""
    vertices_m = np.asarray(frame["vertices_m"])
    if len(faces) and faces.max() >= len(vertices_m):
        raise ValueError(f"the template has a vertex {faces.max()}, the frame has "
                         f"{len(vertices_m)} vertices: it is the template of another run")
    return vertices_m[faces].reshape(-1, 3)


def colour_of(frame):
    return COLOURS.get(frame["state"], OLDER)
