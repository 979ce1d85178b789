"""A ceiling fan that turns above an uplight while the shutter is open: motion blur, of the blades and of their shadows.

The fan (chalice/meshes/*CeilingFan*) is from the Bistro by Amazon Lumberyard (CC-BY 4.0), as niklassanden/ReSTIR_GI_DR has it, whose folder
scenes/chalice/meshes is given with --files; room, materials, lights and camera are this project's.
"""
import math

import bpy
from mathutils import Matrix
from model.materials import grained, plain
from model.shapes import add_block, add_sheet
from model.stage import add_camera, add_lamp, start_scene

PART = "Bistro_Research_Interior_Paris_CeilingFan_01A_%s.ply"
AXIS, SIZE = (192.126, 208.6, -55.207), 0.03  # of the fan in its file, whose y is up; metres of a unit
HEIGHT, TURN = 2.4, math.radians(22)  # of the blades above the floor; a frame


def build(find):
    """find: name of a file -> its path."""
    scene = start_scene((0.02, 0.02, 0.02), (0.35, 0.45, 0.6), 0.6)
    lime, boards = plain("lime", (0.72, 0.69, 0.62), 0.9), grained("boards", (0.10, 0.05, 0.02), (0.32, 0.18, 0.08), 1.6, 0.35, 0.4)
    add_sheet("floor", 6, 6, (0, 0, 0), boards)
    add_block("ceiling", (6, 6, 0.2), (0, 0, 3.1), lime)
    for name, size, place in (("back", (6, 0.2, 3), (0, 3, 1.5)), ("left", (0.2, 6, 3), (-3, 0, 1.5)), ("sill", (0.2, 6, 1), (3, 0, 0.5)),
                              ("lintel", (0.2, 6, 0.5), (3, 0, 2.75)), ("pier", (0.2, 2, 1.5), (3, 2, 1.75))):
        add_block(name, size, place, lime)
    for i in range(7):
        add_block("beam", (0.14, 6, 0.16), (-2.7 + 0.9 * i, 0, 2.92), boards)
    add_block("cupboard", (1.6, 0.5, 1.9), (-1.4, 2.6, 0.95), boards, chamfer=0.03)
    add_part(find(PART % "Base_mesh_01_2364"), "base", plain("brass", (0.75, 0.55, 0.25), 0.25, Metallic=1.0))
    blades = add_part(find(PART % "Blades_me_50bd6e7"), "blades", grained("blades", (0.05, 0.02, 0.01), (0.2, 0.1, 0.05), 2.0))
    for frame in (-2, 0, 2, 4):  # of one line: Blender's curve is straight between them
        blades.rotation_euler = (0, 0, TURN * (frame - 1))
        blades.keyframe_insert("rotation_euler", frame=frame)
    scene.frame_start, scene.frame_end = 1, 2
    scene.frame_set(1)
    scene.render.use_motion_blur, scene.render.motion_blur_shutter = True, 0.7
    add_lamp("uplight", (1.3, 1.1, 1.2), (0.6, 0.5, 3), 0.16, 45, (1.0, 0.82, 0.6))
    add_camera((-0.9, -1.7, 0.6), (0.3, 0.45, 2.3), 22)
    return scene


def add_part(path, name, material):
    """A mesh of the fan, its axis at the origin and upright, hung from the ceiling."""
    read = bpy.ops.wm.ply_import if hasattr(bpy.types, "WM_OT_ply_import") else bpy.ops.import_mesh.ply
    read(filepath=path)
    item = bpy.context.object
    item.name = name
    item.data.transform(Matrix.Scale(SIZE, 4) @ Matrix.Rotation(math.pi / 2, 4, "X") @ Matrix.Translation([-v for v in AXIS]))
    item.data.materials.clear()
    item.data.materials.append(material)
    item.matrix_world = Matrix.Translation((0.3, 0.3, HEIGHT))
    return item
