# SPDX-License-Identifier: Apache-2.0
"""What a pipeline in a program takes beside images: matches, known points, and a lens."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from weft.programs.errors import Error
from weft.programs.geometry import Camera


def numbers(values: ArrayLike, where: str, shape: tuple[int | None, ...]) -> NDArray[np.float64]:
    """Finite numbers as float64 [shape] in C order; None is any length. Raises Error with the place."""
    array = np.asarray(values)
    if array.dtype.kind not in "fiu":
        raise Error(f"must be numbers, not {array.dtype}", where)
    fits = array.ndim == len(shape) and all(want in (None, have) for want, have in zip(shape, array.shape))
    if not fits:
        wanted = ",".join("N" if each is None else str(each) for each in shape)
        raise Error(f"must be [{wanted}], not {list(array.shape)}", where)
    finite = np.isfinite(array)
    if not finite.all():
        raise Error(f"has a value that is not finite, at {np.argwhere(~finite)[0].tolist()}; leave such rows out", where)
    return np.ascontiguousarray(array, np.float64)


def same_length(first: NDArray[Any], second: NDArray[Any], where: str) -> None:
    if len(first) != len(second):
        raise Error(f"has {len(second)} rows where there are {len(first)}", where)


class Matches:
    """Matches of one image: `template_px` [N,2] px of the texture, `image_px` [N,2] px of the image, and
    `covariance_px2` [N,2,2] px², that of image_px, or None. Pixel centres are at integers.

    Raises Error for other shapes, values that are not finite, and a covariance that is not symmetric and positive.
    """

    def __init__(self, template_px: ArrayLike, image_px: ArrayLike, covariance_px2: ArrayLike | None = None) -> None:
        self.template_px = numbers(template_px, "matches.template_px", (None, 2))
        self.image_px = numbers(image_px, "matches.image_px", (None, 2))
        same_length(self.template_px, self.image_px, "matches.image_px")
        self.covariance_px2: NDArray[np.float64] | None = None
        if covariance_px2 is None:
            return
        given = numbers(covariance_px2, "matches.covariance_px2", (None, 2, 2))
        same_length(self.template_px, given, "matches.covariance_px2")
        is_positive = (given[:, 0, 0] > 0) & (np.linalg.det(given) > 0) if len(given) else np.ones(0, bool)
        is_symmetric = np.isclose(given[:, 0, 1], given[:, 1, 0])
        if not (is_positive & is_symmetric).all():
            row = int(np.flatnonzero(~(is_positive & is_symmetric))[0])
            raise Error(f"must be symmetric and positive definite; row {row} is {given[row].tolist()}",
                        "matches.covariance_px2")
        self.covariance_px2 = given

    def __len__(self) -> int:
        return len(self.template_px)

    def __repr__(self) -> str:
        return f"Matches({len(self)})"

    @property
    def arrays(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64] | None]:
        """As the library takes them."""
        return self.template_px, self.image_px, self.covariance_px2


class KnownPoints:
    """Vertices of the mesh whose positions are known: `vertex` [P] indices, `points_m` [P,3] m, camera frame, and
    `radius_m`, m, one for all or [P]: the point lies within; 0 is exact, None is the solver's own tolerance.

    Raises Error for other shapes, values that are not finite, and indices that are no whole numbers or negative.
    """

    def __init__(self, vertex: ArrayLike, points_m: ArrayLike, radius_m: ArrayLike | None = None) -> None:
        indices = np.asarray(vertex)
        if indices.dtype.kind not in "iu" and indices.size:
            raise Error(f"must be whole numbers, not {indices.dtype}", "known_points.vertex")
        whole = numbers(indices, "known_points.vertex", (None,))
        if (whole < 0).any() or (whole > np.iinfo(np.int32).max).any():
            raise Error(f"must be indices from 0, not {int(whole[(whole < 0) | (whole > 2**31 - 1)][0])}",
                        "known_points.vertex")
        self.vertex: NDArray[np.int32] = np.ascontiguousarray(whole, np.int32)
        self.points_m = numbers(points_m, "known_points.points_m", (None, 3))
        same_length(self.vertex, self.points_m, "known_points.points_m")
        radii = np.asarray(-1.0 if radius_m is None else radius_m)
        if radii.ndim == 0:
            radii = np.full(len(self.vertex), radii)
        self.radius_m = numbers(radii, "known_points.radius_m", (None,))
        same_length(self.vertex, self.radius_m, "known_points.radius_m")

    def __len__(self) -> int:
        return len(self.vertex)

    def __repr__(self) -> str:
        return f"KnownPoints({len(self)})"

    @property
    def arrays(self) -> tuple[NDArray[np.int32], NDArray[np.float64], NDArray[np.float64]]:
        """As the library takes them."""
        return self.vertex, self.points_m, self.radius_m


@dataclasses.dataclass(frozen=True)
class Lens:
    """A camera with the distortion of its lens, as OpenCV calibrates it.

    `camera` is the pinhole. `coefficients` are k1 k2 p1 p2, then k3, then k4 k5 k6; of a fisheye k1 k2 k3 k4. A
    Pipeline with a Lens takes images and image_px of matches as the real camera has them. Raises Error for other
    numbers of coefficients, and for those that fold the image.
    """

    camera: Camera
    coefficients: tuple[float, ...]
    fisheye: bool = False

    def __post_init__(self) -> None:
        if not isinstance(self.camera, Camera):
            raise TypeError(f"camera must be a weft.Camera, not {type(self.camera).__name__}")
        values = tuple(map(float, numbers(np.ravel(self.coefficients), "lens.coefficients", (None,))))
        object.__setattr__(self, "coefficients", values)
        from weft.programs.pipelines import compiled
        object.__setattr__(self, "_made", compiled().Lens(dataclasses.astuple(self.camera), self.fisheye, values))

    @property
    def made(self) -> Any:
        """Its compiled part."""
        return self.__dict__["_made"]

    def undistorted(self, image: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """The image, uint8 [H,W] or [H,W,3], as the pinhole has it; black where the lens does not look."""
        from weft.programs.pipelines import pixels_of
        undistorted: NDArray[np.uint8] = self.made.undistorted(pixels_of(image))
        return undistorted

    def ideal_px(self, seen_px: ArrayLike) -> NDArray[np.float64]:
        """Pixels [N,2] of the real image as those of the pinhole, px."""
        ideal: NDArray[np.float64] = self.made.ideal_px(numbers(seen_px, "lens.seen_px", (None, 2)))
        return ideal
