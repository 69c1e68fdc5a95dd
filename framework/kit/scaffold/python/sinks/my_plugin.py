# SPDX-License-Identifier: Apache-2.0
"""One CSV file for each frame with a shape: its vertices."""

import os

import weft

ESTIMATED, WEAK = 1, 2  # states of shapes that were measured in the frame


class MyPluginSink(weft.Sink):
    """Writes the vertices of each frame as CSV."""

    id = "sinks/my_plugin"
    version = "1.0.0"
    needs = "shape"

    path = weft.output_path("vertices", "folder of the tables")
    measured_only = weft.flag(True, "omission of frames whose shape is carried over from an earlier frame")

    def open(self, given):
        try:
            os.makedirs(self.path, exist_ok=True)
        except OSError as error:
            raise weft.Failure(f"the folder {self.path} cannot be made ({error.strerror}): choose another "
                               "'path'") from None

    def write(self, given):
        shape = given.shape
        if self.measured_only and shape.state not in (ESTIMATED, WEAK):
            return
        lines = ["x_m,y_m,z_m,measured"]
        for vertex_m, measured in zip(shape.vertices_m.tolist(), shape.source.tolist(), strict=True):
            lines.append(",".join(map(repr, vertex_m)) + f",{int(measured != 0)}")
        target = os.path.join(self.path, f"{given.call.frame:06}.csv")
        part = f"{target}.{os.urandom(6).hex()}.part"
        with open(part, "x", encoding="utf-8") as file:  # always a new file, through no link
            file.write("\n".join(lines) + "\n")
        os.replace(part, target)
