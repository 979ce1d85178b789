"""A room lit only by what a small lamp throws on a glossy hood: no wall sees the lamp itself.

Hard for everything: all light is indirect, glossy metal focuses it, and single samples are a thousand
times brighter than the pixel. Means of few samples say little, and outlier rules are put to the test.
"""
import math

from model.materials import glowing, grained, plain
from model.shapes import add_ball, add_block, add_sheet, add_turned
from model.stage import add_camera, start_scene


def build():
    scene = start_scene((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0)
    build_room()
    chrome = plain("chrome", (0.92, 0.90, 0.86), 0.22, Metallic=1.0)
    copper = plain("copper", (0.90, 0.45, 0.28), 0.16, Metallic=1.0)
    # an open cup below the lamp hides it from all that is not above; the hood above sends light back
    add_turned("cup", [(0.0, 0.0), (0.30, 0.02), (0.34, 0.30), (0.32, 0.30), (0.28, 0.05), (0.0, 0.04)],
               plain("soot", (0.05, 0.05, 0.05), 0.8), (0, 0.6, 1.55), 32)
    add_ball("lamp", 0.12, (0, 0.6, 1.66), glowing("lamp", (1.0, 0.85, 0.62), 1700.0), 16)
    hood = [(1.0, 0.0), (0.9, 0.28), (0.6, 0.48), (0.25, 0.56), (0.0, 0.57)]
    add_turned("hood", hood, chrome, (0, 0.6, 2.2), 40)
    add_block("stand", (0.12, 0.12, 1.55), (0, 0.6, 0.78), chrome)
    add_ball("copper ball", 0.55, (-1.25, -0.2, 0.55), copper, 40)
    add_ball("chalk ball", 0.45, (1.15, -0.4, 0.45), plain("chalk", (0.80, 0.78, 0.74), 0.9), 40)
    add_block("box", (0.7, 0.7, 0.9), (1.5, 1.2, 0.45), plain("blue", (0.12, 0.22, 0.50), 0.35), (0, 0, 0.5), 0.04)
    add_camera((0.0, -4.7, 1.9), (0.0, 0.4, 1.15), 32)
    return scene


def build_room():
    plaster = plain("plaster", (0.74, 0.72, 0.68), 0.9)
    add_sheet("floor", 6, 12, (0, 0, 0), grained("planks", (0.30, 0.17, 0.09), (0.48, 0.30, 0.17), 1.2, 0.35, 0.2))
    add_sheet("ceiling", 6, 12, (0, 0, 3.6), plaster, (math.pi, 0, 0))
    add_sheet("back", 6, 3.6, (0, 2.6, 1.8), plaster, (math.pi / 2, 0, 0))
    for side, colour in ((-1, (0.62, 0.16, 0.12)), (1, (0.18, 0.42, 0.20))):
        add_sheet("side", 3.6, 12, (3 * side, 0, 1.8), plain("side", colour, 0.9), (0, -side * math.pi / 2, 0))
