# SPDX-License-Identifier: Apache-2.0
"""A small component of each role, which their contracts look at."""

import numpy as np
import weft

STEP_PX = 16
PATCH_PX = 4


def grid_faces(columns, rows):
    """Faces of a grid, counter-clockwise as the camera sees them."""
    corner = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    lower = np.stack([corner, corner + columns, corner + columns + 1], axis=1)
    upper = np.stack([corner, corner + columns + 1, corner + 1], axis=1)
    return np.concatenate([lower, upper]).astype(np.int32)


def affine_fit(matches):
    """The affine map (u, v, 1) -> (x, y) of the kept matches, [3,2], by least squares."""
    kept = matches.kept != 0
    if kept.sum() < 4:
        raise weft.NoResult(f"{kept.sum()} matches are kept; at least 4 are needed")
    start = np.column_stack([matches.template_px[kept], np.ones(kept.sum())])
    found, _, rank, _ = np.linalg.lstsq(start, matches.image_px[kept], rcond=1e-9)
    if rank < 3:
        raise weft.NoResult("the matches lie on a line or in one place")
    return found


class Source(weft.Source):
    """Grey frames that get lighter."""

    id = "sources/test.python"
    version = "1.0.0"
    produces = "image time"
    width = weft.whole(64, "px", (1, 1000), "of the image")

    def open(self, given):
        return weft.Record(fx=100.0, fy=100.0, cx=32.0, cy=24.0, width=self.width, height=48)

    def count(self, given):
        return 3

    def read(self, given):
        frame = given.call.frame
        pixels = given.call.output("image", "pixels", (48, self.width))
        pixels[...] = 10 * (frame + 1)
        return {"image": weft.Record(pixels=pixels, stem=f"{frame:03}"), "time": weft.Record(t_s=0.1 * frame)}


class Template(weft.TemplateBuilder):
    """A flat sheet of 5 x 4 vertices."""

    id = "templates/test.python"
    version = "1.0.0"
    width_m = weft.number(0.2, "m", (0.01, 10), "of the sheet")

    def build(self, given):
        columns, rows, width, height = 5, 4, 80, 60
        u, v = np.meshgrid(np.linspace(-0.5, width - 0.5, columns), np.linspace(-0.5, height - 0.5, rows))
        flat_px = np.column_stack([u.ravel(), v.ravel()])
        m_per_px = self.width_m / width
        vertices_m = np.column_stack([m_per_px * flat_px, np.zeros(len(flat_px))])
        texture = np.add.outer(np.arange(height), np.arange(width)).astype(np.uint8)
        return weft.Record(vertices_m=vertices_m, flat_px=flat_px, faces=grid_faces(columns, rows),
                           m_per_px=[m_per_px, m_per_px], texture=texture,
                           mask=np.ones((height, width), np.uint8))


class Detector(weft.Detector):
    """Keypoints on a grid, each with the pixels around it."""

    id = "detectors/test.python"
    version = "1.0.0"
    reads = "region"

    def detect(self, given):
        pixels = given.image.pixels
        grey = pixels.mean(axis=2) if pixels.ndim == 3 else pixels.astype(np.float64)
        height, width = grey.shape
        if given.region is not None and given.region.mask.shape != grey.shape:
            raise weft.Failure("the region has another size than the image")
        y, x = (each.ravel() for each in np.mgrid[PATCH_PX:height - PATCH_PX:STEP_PX,
                                                 PATCH_PX:width - PATCH_PX:STEP_PX])
        if given.region is not None:
            allowed = given.region.mask[y, x] != 0
            x, y = x[allowed], y[allowed]
        if len(x) == 0:
            raise weft.NoResult("no point of the grid is in the image and its region")
        patch = [grey[y + dy, x + dx] for dy in range(-2, 2) for dx in range(-2, 2)]
        count = len(x)
        return weft.Record(xy_px=np.column_stack([x, y]), scale_px=np.full(count, 2.0),
                           angle_rad=np.zeros(count), response=np.ones(count),
                           octave=np.zeros(count, np.int32), metric="l2",
                           descriptors=np.column_stack(patch).astype(np.float32))


class Matcher(weft.Matcher):
    """The nearest template keypoint of each image keypoint."""

    id = "matchers/test.python"
    version = "1.0.0"
    needs = "keypoints template_keypoints"

    def match(self, given):
        image, template = given.keypoints, given.template_keypoints
        if image.metric != "l2" or template.metric != "l2":
            raise weft.Failure("descriptors of metric l2 are needed; use another detector")
        if len(image.xy_px) == 0 or len(template.xy_px) == 0:
            raise weft.NoResult("there are no keypoints")
        nearest = np.empty(len(image.xy_px), np.int32)
        for i, each in enumerate(image.descriptors):
            given.call.go_on()
            nearest[i] = np.argmin(np.square(template.descriptors - each).sum(axis=1))
        count = len(nearest)
        return weft.Record(template_px=template.xy_px[nearest], image_px=image.xy_px.copy(),
                           template_keypoint=nearest, image_keypoint=np.arange(count, dtype=np.int32),
                           face=template.face[nearest], barycentrics=template.barycentrics[nearest],
                           kept=np.ones(count, bool), score=np.ones(count))


class Filter(weft.Filter):
    """Keeps matches that an affine map of all explains."""

    id = "filters/test.python"
    version = "1.0.0"
    tolerance_px = weft.number(40.0, "px", (0, 1000), "kept if so near")

    def filter(self, given):
        matches = given.correspondences
        found = affine_fit(matches)
        start = np.column_stack([matches.template_px, np.ones(len(matches.kept))])
        off_px = np.hypot(*(start @ found - matches.image_px).T)
        kept = (off_px <= self.tolerance_px) & (matches.kept != 0)
        mask = weft.Record(kept=kept, score=1.0 / (1.0 + off_px), diag={"mean_px": off_px.mean()})
        return mask if kept.any() else weft.degenerate(mask, "no match is explained")


class Warp(weft.WarpModel):
    """One affine map of the whole template."""

    id = "warps/test.python"
    version = "1.0.0"

    def fit(self, given):
        if given.weights is not None and not (given.weights.weight > 0).any():
            raise weft.NoResult("all weights are 0")
        flat_px = given.template.flat_px
        low, high = flat_px.min(axis=0), flat_px.max(axis=0)
        return weft.Record(domain_px=[low[0], high[0], low[1], high[1]],
                           model={"affine": affine_fit(given.correspondences)})

    def evaluate(self, given):
        found, points_px = given.warp.model["affine"], given.points.xy_px
        count, order = len(points_px), given.points.order
        samples = weft.Record(xy_px=np.column_stack([points_px, np.ones(count)]) @ found,
                              valid=np.ones(count, bool))
        if order >= 1:
            samples.jacobian = np.broadcast_to(found[:2].T, (count, 2, 2)).copy()
        if order >= 2:
            samples.hessian = np.zeros((count, 2, 3))
        return samples


class Pass(weft.Pass):
    """Puts the place of each kept match on the ray of its pixel."""

    id = "passes/test.python"
    version = "1.0.0"
    needs = "correspondences"
    produces = "sightlines"

    def run(self, given):
        matches, camera = given.correspondences, given.camera
        used = (matches.kept != 0) & (matches.face >= 0)
        count = int(used.sum())
        if count == 0:
            raise weft.NoResult("no match is kept on the mesh")
        pixel_px = matches.image_px[used]
        ray = np.column_stack([(pixel_px[:, 0] - camera.cx) / camera.fx,
                               (pixel_px[:, 1] - camera.cy) / camera.fy, np.ones(count)])
        hit = len(np.unique(matches.face[used])) / len(given.template.faces)
        return {"sightlines": weft.Record(
            vertex=np.full(count, -1, np.int32), face=matches.face[used],
            barycentrics=matches.barycentrics[used], pixel_px=pixel_px,
            ray=ray / np.linalg.norm(ray, axis=1, keepdims=True), weight=np.ones(count), coverage=hit)}


class Solver(weft.Solver):
    """The sheet, flat before the camera where an affine map of the matches puts it."""

    id = "solvers/test.python"
    version = "1.0.0"
    needs = "correspondences"

    def solve(self, given):
        template, camera = given.template, given.camera
        found = affine_fit(given.correspondences)
        if abs(np.linalg.det(found[:2])) < 1e-9:
            raise weft.NoResult("the matches lie on a line")
        flat_px = template.flat_px
        pixels_px = np.column_stack([flat_px, np.ones(len(flat_px))]) @ found
        spread_m = np.linalg.norm(np.ptp(template.vertices_m, axis=0))
        spread_px = np.linalg.norm(np.ptp(pixels_px, axis=0))
        depth_m = camera.fx * spread_m / spread_px
        vertices_m = np.column_stack([(pixels_px[:, 0] - camera.cx) / camera.fx,
                                      (pixels_px[:, 1] - camera.cy) / camera.fy,
                                      np.ones(len(flat_px))]) * depth_m
        return weft.Record(vertices_m=vertices_m, confidence=0.6, source=np.ones(len(flat_px), np.uint8))


class Sink(weft.Sink):
    """A file of vertices for each frame."""

    id = "sinks/test.python"
    version = "1.0.0"
    needs = "shape"
    path = weft.output_path("vertices", "folder of the files")

    def open(self, given):
        import os
        os.makedirs(self.path, exist_ok=True)

    def write(self, given):
        import os
        target = f"{self.path}/{given.call.frame:06}.csv"
        part = f"{target}.{os.urandom(6).hex()}.part"
        with open(part, "x", encoding="utf-8") as file:
            np.savetxt(file, given.shape.vertices_m, fmt="%.6f", delimiter=",", header="x_m,y_m,z_m")
        os.replace(part, target)
