# SPDX-License-Identifier: Apache-2.0
"""The camera and the object at rest, as pipelines and run folders have them."""

from __future__ import annotations

import dataclasses

import numpy as np
from numpy.typing import ArrayLike, NDArray
from weft.programs import notebooks


@dataclasses.dataclass(frozen=True)
class Camera:
    """A pinhole camera without distortion: u = fx X / Z + cx, v = fy Y / Z + cy, with x right, y down and z
    forward, in px; pixel centres are at integers."""

    fx: float
    fy: float
    cx: float
    cy: float
    width_px: int
    height_px: int

    @classmethod
    def of_matrix(cls, matrix: ArrayLike, width_px: int, height_px: int) -> Camera:
        """Of a camera matrix [3,3] as OpenCV has it, in px. Its skew must be 0."""
        values = np.asarray(matrix, np.float64)
        if values.shape != (3, 3):
            raise ValueError(f"a camera matrix is [3,3], this one {list(values.shape)}")
        if values[0, 1] or values[1, 0] or not np.array_equal(values[2], (0, 0, 1)):
            raise ValueError("this camera matrix has skew, or a last row other than 0 0 1")
        return cls(float(values[0, 0]), float(values[1, 1]), float(values[0, 2]), float(values[1, 2]),
                   int(width_px), int(height_px))

    @property
    def matrix(self) -> NDArray[np.float64]:
        """The camera matrix [3,3], px."""
        return np.array([[self.fx, 0, self.cx], [0, self.fy, self.cy], [0, 0, 1]], np.float64)

    def project(self, points_m: ArrayLike) -> NDArray[np.float64]:
        """Points [...,3] in m, camera frame, in the image: [...,2] px. NaN for those that are not before the
        camera."""
        points = np.asarray(points_m, np.float64)
        if points.ndim < 1 or points.shape[-1] != 3:
            raise ValueError(f"points are [...,3], these {list(points.shape)}")
        depth = np.where(points[..., 2] > 0, points[..., 2], np.nan)
        return np.stack((self.fx * points[..., 0] / depth + self.cx,
                         self.fy * points[..., 1] / depth + self.cy), axis=-1)


@dataclasses.dataclass(frozen=True, eq=False)
class Template:
    """The object at rest: a mesh, where each vertex lies in the texture, and the texture.

    `vertices_m` [V,3] m, template frame; `faces` [F,3] vertex indices, those of every shape; `flat_px` [V,2] px
    of the texture; `texture` uint8 [H,W] grey levels or [H,W,3] BGR; `mask` uint8 [H,W], 1 where the texture
    belongs to the object; `m_per_px` [2] m per px along u and v, or None.
    """

    vertices_m: NDArray[np.float64]
    faces: NDArray[np.int32]
    flat_px: NDArray[np.float64]
    texture: NDArray[np.uint8]
    mask: NDArray[np.uint8]
    m_per_px: NDArray[np.float64] | None = None

    def __repr__(self) -> str:
        return (f"Template({len(self.vertices_m)} vertices, {len(self.faces)} faces, "
                f"texture {'x'.join(map(str, self.texture.shape))})")

    def _repr_html_(self) -> str:
        extent_mm = 1000 * np.ptp(self.vertices_m, axis=0)
        rows = [("mesh", f"{len(self.vertices_m)} vertices, {len(self.faces)} faces"),
                ("extent", " x ".join(f"{each:.0f}" for each in extent_mm) + " mm"),
                ("texture", f"{self.texture.shape[1]} x {self.texture.shape[0]} px")]
        return notebooks.titled("Template", notebooks.mesh(self.flat_px, self.faces) + notebooks.facts(rows))
