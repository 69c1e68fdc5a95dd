# SPDX-License-Identifier: Apache-2.0
"""A flat plain disc: a vertex in its middle and others on rings around it."""

import numpy as np
import weft

PLAIN_GREY = 200


class MyPluginTemplate(weft.TemplateBuilder):
    """Makes a flat plain disc."""

    id = "templates/my_plugin"
    version = "1.0.0"

    radius_m = weft.number(0.08, "m", (1e-6, 1000), "radius of the disc")
    rings = weft.whole(4, "", (1, 500), "number of rings of vertices around the centre")
    spokes = weft.whole(16, "", (3, 1000), "number of vertices per ring")
    texture_px = weft.whole(320, "px", (8, 4000), "side of the texture, which is grey")

    def build(self, given):
        pitch_m = 2.0 * self.radius_m / (self.texture_px - 1)
        vertices_m = self.vertices_m()
        from_middle_px = np.arange(self.texture_px) - 0.5 * (self.texture_px - 1)
        mask = np.hypot.outer(from_middle_px, from_middle_px) <= 0.5 * (self.texture_px - 1)
        return weft.Record(vertices_m=vertices_m, flat_px=vertices_m[:, :2] / pitch_m, faces=self.faces(),
                           m_per_px=[pitch_m, pitch_m], mask=mask,
                           texture=np.full(mask.shape, PLAIN_GREY, np.uint8))

    def vertices_m(self):
        """The middle of the disc is the middle of the texture; its edge goes through the outer texels."""
        angle_rad = 2.0 * np.pi * np.arange(self.spokes) / self.spokes
        from_middle_m = self.radius_m * np.arange(1, self.rings + 1) / self.rings
        x_m = np.append(0.0, np.outer(from_middle_m, np.cos(angle_rad)))
        y_m = np.append(0.0, np.outer(from_middle_m, np.sin(angle_rad)))
        return np.column_stack([self.radius_m + x_m, self.radius_m + y_m, np.zeros(len(x_m))])

    def faces(self):
        """Counter-clockwise as the camera sees them, whose y points down."""
        spoke = np.arange(self.spokes)
        after = (spoke + 1) % self.spokes
        faces = [np.column_stack([np.zeros_like(spoke), 1 + after, 1 + spoke])]
        for ring in range(1, self.rings):
            inner, outer = 1 + (ring - 1) * self.spokes, 1 + ring * self.spokes
            faces.append(np.column_stack([inner + spoke, outer + after, outer + spoke]))
            faces.append(np.column_stack([inner + spoke, inner + after, outer + after]))
        return np.concatenate(faces).astype(np.int32)
