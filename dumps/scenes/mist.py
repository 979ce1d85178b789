"""A slatted window in a hall full of mist: beams of light in a medium that scatters.

Hard for a sampler: noise without texture over the whole picture, and features (normal, albedo, depth)
that know nothing of the beams. Camera rays scatter before they reach a surface.
"""
import math

import bpy

from model.materials import plain
from model.shapes import add_ball, add_block, add_sheet, add_turned
from model.stage import add_camera, add_lamp, start_scene


def build():
    scene = start_scene((0.02, 0.022, 0.028), (0.03, 0.035, 0.045), 0.4)
    stone = plain("stone", (0.42, 0.39, 0.35), 0.85)
    add_sheet("floor", 9, 12, (0, 1, 0), plain("flags", (0.30, 0.28, 0.26), 0.4), (0, 0, 0))
    add_sheet("back", 9, 5, (0, 4.5, 2.5), stone, (math.pi / 2, 0, 0))
    add_sheet("right", 5, 12, (3.2, 1, 2.5), stone, (0, -math.pi / 2, 0))
    for i in range(7):
        add_block("slat", (0.12, 0.34, 4.4), (-3.0, -1.2 + 0.8 * i, 2.2), stone)
    column = [(0.0, 0.0), (0.42, 0.0), (0.42, 0.2), (0.28, 0.32), (0.25, 3.2), (0.40, 3.4), (0.40, 3.6), (0.0, 3.6)]
    for x, y in ((1.7, 3.2), (1.9, 0.8), (-0.6, 3.6)):
        add_turned("column", column, stone, (x, y, 0), 32)
    add_ball("ball", 0.5, (0.2, 0.4, 0.5), plain("red", (0.65, 0.06, 0.05), 0.2, Clearcoat=0.5), 40)
    add_block("mist", (9, 12, 5), (0, 1, 2.45), medium())
    lamp = add_lamp("sun", (-9.0, 2.0, 7.0), (0.5, 1.4, 0.0), 0.8, 3600, (1.0, 0.86, 0.66))
    lamp.visible_camera = False
    add_camera((0.3, -4.2, 1.7), (0.1, 1.5, 1.55), 30)
    return scene


def medium():
    """Thin, grey, scattering a little forward; no surface."""
    material = bpy.data.materials.new("mist")
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    scatter = nodes.new("ShaderNodeVolumeScatter")
    scatter.inputs["Color"].default_value = (0.85, 0.88, 0.92, 1)
    scatter.inputs["Density"].default_value = 0.06
    scatter.inputs["Anisotropy"].default_value = 0.35
    output = nodes.new("ShaderNodeOutputMaterial")
    links.new(scatter.outputs["Volume"], output.inputs["Volume"])
    return material
