# SPDX-License-Identifier: Apache-2.0
"""Gives the sightline of each kept match."""

import numpy as np
import weft


def area_share(template, chosen):
    """Share of the mesh's area at rest that these faces have."""
    corners_m = template.vertices_m[template.faces]
    sides_m = corners_m[:, 1:] - corners_m[:, :1]
    area = np.linalg.norm(np.cross(sides_m[:, 0], sides_m[:, 1]), axis=1)
    return float(area[chosen].sum() / area.sum()) if area.sum() > 0.0 else 0.0


def unit_rays(camera, pixels_px):
    """[N,3] camera frame."""
    across = (pixels_px - [camera.cx, camera.cy]) / [camera.fx, camera.fy]
    rays = np.column_stack([across, np.ones(len(across))])
    return rays / np.linalg.norm(rays, axis=1, keepdims=True)


class MyPluginPass(weft.Pass):
    """Gives the sightline of each kept match."""

    id = "passes/my_plugin"
    version = "1.0.0"
    needs = "correspondences"
    produces = "sightlines"

    fewest = weft.whole(8, "", (3, 1000000), "minimum number of sightlines for a result")

    def run(self, given):
        matches, faces = given.correspondences, given.template.faces
        # The face is -1 where the match is beyond the mesh.
        used = (matches.kept != 0) & (matches.face >= 0) & (matches.face < len(faces))
        count = int(np.count_nonzero(used))
        if count < self.fewest:
            raise weft.NoResult(f"{count} matches are kept on the mesh, of at least {self.fewest}")
        pixels_px = matches.image_px[used]
        return {"sightlines": weft.Record(
            vertex=np.full(count, -1, np.int32),  # none: the points lie inside faces
            face=matches.face[used], barycentrics=matches.barycentrics[used], pixel_px=pixels_px,
            ray=unit_rays(given.camera, pixels_px), weight=np.ones(count),
            coverage=area_share(given.template, np.unique(matches.face[used])))}
