# SPDX-License-Identifier: Apache-2.0
"""Imports a glTF file and prints the vertices of its mesh in the frames of Blender.

usage: blender --background --python-exit-code 1 --python read_in_blender.py -- FILE FPS FRAME ...

The last line is `vertices` and a JSON list with a list of [x, y, z] in m for each frame; z is up.
"""

import json
import sys

import bpy
import numpy

numpy.bool = bool  # the add-on of Blender 3.4 uses it, and numpy 1.24 lacks it


def vertices_of(surface, frame):
    bpy.context.scene.frame_set(frame)
    shown = surface.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = shown.to_mesh()
    vertices = [list(shown.matrix_world @ vertex.co) for vertex in mesh.vertices]
    shown.to_mesh_clear()
    return vertices


file, fps, *frames = sys.argv[sys.argv.index("--") + 1:]
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.context.scene.render.fps = int(fps)
bpy.ops.import_scene.gltf(filepath=file)
print("vertices", json.dumps([vertices_of(bpy.data.objects["surface"], int(frame)) for frame in frames]))
