# SPDX-License-Identifier: Apache-2.0
"""Meshes drawn by matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from weft.programs.geometry import Camera, Template

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MEASURED, FILLED_IN = "#1f5fbf", "#d9731a"


def draw(template: Template, vertices_m: ArrayLike | None = None, *, image: NDArray[np.uint8] | None = None,
         camera: Camera | None = None, values: ArrayLike | None = None, source: ArrayLike | None = None,
         ax: Axes | None = None) -> Axes:
    """Draws a mesh into matplotlib axes, and answers these; `draw(...).figure.savefig("mesh.png")` keeps the
    picture. No window is opened.

    `vertices_m` [V,3] m, camera frame, in the order of `template.vertices_m`, which are drawn where it is None.
    With `camera`: where the camera sees the mesh, in px, over `image`, uint8 [H,W] or [H,W,3] BGR of its size,
    where there is one. Without: in 3D, mm, y down and z away from the camera, as the camera has them.

    `values` [V] are shown as colours of the faces, such as errors in mm; NaN is grey. Without them `source` [V], as
    frames have it, tells faces that were measured (blue) from those that the prior filled in (orange). `ax` are the
    axes to draw into, 3D ones (`projection="3d"`) without `camera`; by default those of a new figure.
    """
    vertices = checked(template, template.vertices_m if vertices_m is None else vertices_m)
    faces = np.asarray(template.faces)
    if image is not None and camera is None:
        raise ValueError("an image is drawn with the camera that took it: camera=...")
    colours = colours_of(faces, len(vertices), values, source)
    if camera is not None:
        return draw_flat(vertices, faces, colours, image, camera, ax)
    return draw_in_space(vertices, faces, colours, ax)


def checked(template: Template, vertices_m: ArrayLike) -> NDArray[np.float64]:
    vertices = np.asarray(vertices_m, np.float64)
    if vertices.shape != (len(template.vertices_m), 3):
        raise ValueError(f"the template has {len(template.vertices_m)} vertices, [{len(template.vertices_m)},3], "
                         f"these are {list(vertices.shape)}")
    if not np.isfinite(vertices).all():
        raise ValueError("vertices hold NaN or infinity")
    return vertices


def colours_of(faces: NDArray[np.int32], vertices: int, values: ArrayLike | None,
               source: ArrayLike | None) -> dict[str, Any]:
    """What tells faces apart: a number of each, or a colour of each."""
    for name, given in (("values", values), ("source", source)):
        if given is not None and np.shape(given) != (vertices,):
            raise ValueError(f"{name} has one entry a vertex, [{vertices}], not {list(np.shape(given))}")
    if values is not None:
        of_faces = np.asarray(values, np.float64)[faces].mean(axis=1)
        masked: Any = np.ma.MaskedArray
        return {"array": masked(of_faces, np.isnan(of_faces))}
    if source is not None:
        measured = np.asarray(source)[faces].all(axis=1)
        return {"facecolor": np.where(measured, MEASURED, FILLED_IN)}
    return {"facecolor": MEASURED}


def coloured(collection: Any, colours: dict[str, Any], ax: Any) -> None:
    """The faces in their colours, with a scale where these are numbers."""
    if "array" in colours:
        import matplotlib
        collection.set_array(colours["array"])
        collection.set_cmap(matplotlib.colormaps["viridis"].with_extremes(bad="0.6"))
        ax.figure.colorbar(collection, ax=ax, shrink=0.8, pad=0.2 if ax.name == "3d" else 0.02)
    else:
        collection.set_facecolor(colours["facecolor"])


def new_figure() -> Any:
    from matplotlib.figure import Figure  # one that no window shows
    return Figure(figsize=(6.4, 4.8), layout="constrained")


def draw_flat(vertices: NDArray[np.float64], faces: NDArray[np.int32], colours: dict[str, Any],
              image: NDArray[np.uint8] | None, camera: Camera, ax: Any) -> Any:
    from matplotlib.collections import PolyCollection
    if ax is None:
        ax = new_figure().add_subplot()
    if image is not None:
        ax.imshow(picture(image, camera), cmap="gray", vmin=0, vmax=255)
    corners = camera.project(vertices)[faces]
    before = np.isfinite(corners).all(axis=(1, 2))
    far_first = np.argsort(-vertices[faces[before], 2].mean(axis=1), kind="stable")
    shown = {name: each[before][far_first] if np.ndim(each) else each for name, each in colours.items()}
    mesh = PolyCollection(corners[before][far_first], alpha=0.6, edgecolor="white", linewidth=0.5)
    coloured(mesh, shown, ax)
    ax.add_collection(mesh)
    ax.set(xlim=(-0.5, camera.width_px - 0.5), ylim=(camera.height_px - 0.5, -0.5), aspect="equal",
           xlabel="u, px", ylabel="v, px")
    return ax


def picture(image: NDArray[np.uint8], camera: Camera) -> NDArray[np.uint8]:
    """The image as matplotlib wants it: RGB for BGR."""
    pixels = np.asarray(image)
    grey, colour = pixels.ndim == 2, pixels.ndim == 3 and pixels.shape[2] == 3
    if pixels.dtype != np.uint8 or not (grey or colour):
        raise ValueError(f"an image is uint8 [H,W] or [H,W,3] BGR, this one {pixels.dtype} {list(pixels.shape)}")
    if pixels.shape[:2] != (camera.height_px, camera.width_px):
        raise ValueError(f"the image has {pixels.shape[1]}x{pixels.shape[0]} px, the camera "
                         f"{camera.width_px}x{camera.height_px} px")
    return pixels if grey else pixels[..., ::-1]


def draw_in_space(vertices: NDArray[np.float64], faces: NDArray[np.int32], colours: dict[str, Any],
                  ax: Any) -> Any:
    from matplotlib.ticker import MaxNLocator
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection
    if ax is None:
        ax = new_figure().add_subplot(projection="3d")
    if ax.name != "3d":
        raise ValueError("without a camera the mesh is drawn in 3D: give axes that are made with projection=\"3d\"")
    x, y, z = 1000.0 * vertices.T
    points = np.stack((x, z, y), axis=1)
    mesh = Poly3DCollection(points[faces], alpha=0.9, edgecolor="white", linewidth=0.3)
    coloured(mesh, colours, ax)
    ax.add_collection3d(mesh)
    low, high = points.min(axis=0), points.max(axis=0)
    middle, half = 0.5 * (low + high), np.maximum(0.5 * (high - low), 0.1 * (high - low).max())
    ax.set_xlim(middle[0] - half[0], middle[0] + half[0])
    ax.set_ylim(middle[1] - half[1], middle[1] + half[1])
    ax.set_zlim(middle[2] + half[2], middle[2] - half[2])  # y points down
    ax.set_box_aspect(half)
    for axis, reach in zip((ax.xaxis, ax.yaxis, ax.zaxis), half):
        axis.set_major_locator(MaxNLocator(max(2, round(6 * reach / half.max()))))
    ax.set(xlabel="x, mm", ylabel="z, mm", zlabel="y, mm")
    return ax
