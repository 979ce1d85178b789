"""Chess in a dim room: strong depth of field, bright small bulbs far behind, a lacquered board.

Hard for a sampler: bulbs out of focus become discs of rare bright samples, brass beads and crosses
are small and glossy, and the only sharp things stand in the middle of the board.
"""
import math
import random

from model.materials import Shader, glowing, grained, plain
from model.shapes import (add_ball, add_block, add_mesh, add_sheet, place_copy, rounded, turned)
from model.stage import add_camera, add_lamp, start_scene

FOOT = [(0.0, 0.0), (0.37, 0.0), (0.41, 0.05), (0.39, 0.12), (0.31, 0.17), (0.32, 0.22), (0.25, 0.27)]
PIECES = {                                             # (radius, height) above the foot
    "pawn": [(0.15, 0.46), (0.12, 0.64), (0.23, 0.69), (0.22, 0.73), (0.12, 0.77), (0.21, 0.88),
             (0.22, 0.98), (0.13, 1.10), (0.0, 1.14)],
    "rook": [(0.20, 0.52), (0.17, 0.88), (0.29, 0.97), (0.30, 1.20), (0.21, 1.21), (0.19, 1.09),
             (0.0, 1.08)],
    "bishop": [(0.16, 0.62), (0.12, 0.97), (0.26, 1.03), (0.25, 1.08), (0.13, 1.13), (0.22, 1.29),
               (0.19, 1.45), (0.06, 1.59), (0.08, 1.66), (0.0, 1.73)],
    "queen": [(0.18, 0.64), (0.13, 1.17), (0.27, 1.24), (0.26, 1.30), (0.15, 1.35), (0.21, 1.58),
              (0.31, 1.77), (0.25, 1.79), (0.10, 1.83), (0.08, 1.92), (0.0, 1.95)],
    "king": [(0.19, 0.64), (0.14, 1.26), (0.28, 1.33), (0.27, 1.39), (0.16, 1.45), (0.22, 1.72),
             (0.28, 1.88), (0.18, 1.99), (0.0, 2.02)],
}
WHITE = "bishop c4, bishop f1, king e1, queen g4, rook a1, rook h1, pawn a2, pawn b2, pawn c2, pawn d4, " \
        "pawn e3, pawn h2"
BLACK = "rook a8, rook h8, bishop c8, bishop f5, queen d8, king e8, pawn a7, pawn b7, pawn c7, pawn d5, " \
        "pawn e6, pawn g7, pawn h7"


def build():
    scene = start_scene((0.09, 0.065, 0.05), (0.22, 0.27, 0.40), 0.9)
    build_board()
    brass = plain("brass", (0.94, 0.70, 0.31), 0.09, Metallic=1.0)
    ivory = grained("ivory", (0.84, 0.76, 0.60), (0.71, 0.60, 0.42), 4.0, 0.16, 0.7)
    ebony = grained("ebony", (0.02, 0.013, 0.01), (0.07, 0.034, 0.02), 6.0, 0.13, 0.8)
    for men, wood in ((WHITE, ivory), (BLACK, ebony)):
        build_men(men, wood, brass)
    build_bulbs()
    add_lamp("window", (-5.0, -2.5, 7.0), (0, 0, 0), 2.4, 1450, (1.0, 0.93, 0.84))
    add_lamp("lamp", (6.0, 4.0, 4.2), (0, 1, 0.5), 1.0, 780, (0.74, 0.85, 1.0))
    add_camera((2.8, -7.2, 2.75), (0.15, 0.15, 0.5), 46, focus=6.3, radius=0.19)
    return scene


def build_board():
    shader = Shader("board", roughness=0.12, Clearcoat=0.6)
    place = shader.place()
    grain = shader.add("ShaderNodeTexWave", {"Vector": place, "Scale": 2.5, "Distortion": 9.0,
                                             "Detail": 3.0}).outputs["Fac"]
    light = shader.blend(grain, [(0.0, (0.56, 0.37, 0.18)), (1.0, (0.79, 0.59, 0.34))])
    dark = shader.blend(grain, [(0.0, (0.034, 0.016, 0.01)), (1.0, (0.10, 0.045, 0.022))])
    checker = shader.add("ShaderNodeTexChecker", {"Vector": place, "Color1": light, "Color2": dark,
                                                  "Scale": 1.0})
    shader.feed("Base Color", checker.outputs["Color"])
    # a checker texture is undecided at whole heights, so the sheet lies a little above zero
    add_sheet("board", 8, 8, (0, 0, 0), shader.material).data.transform(_raise(0.0005))
    frame = grained("frame", (0.10, 0.04, 0.02), (0.22, 0.09, 0.04), 2.5)
    for x, y, width, depth in ((0, 4.3, 9.2, 0.6), (0, -4.3, 9.2, 0.6), (4.3, 0, 0.6, 8),
                               (-4.3, 0, 0.6, 8)):
        add_block("frame", (width, depth, 0.3), (x, y, -0.06), frame, chamfer=0.05)
    top = grained("tabletop", (0.16, 0.09, 0.05), (0.30, 0.18, 0.10), 0.6, 0.5)
    add_sheet("tabletop", 80, 80, (0, 0, -0.25), top)


def _raise(height):
    from mathutils import Matrix
    return Matrix.Translation((0, 0, height))


def build_men(men, wood, brass):
    meshes = {}
    for i, (kind, square) in enumerate(man.split() for man in men.split(", ")):
        x, y = ord(square[0]) - ord("a") - 3.5, int(square[1]) - 4.5
        turn = 0.7 * i
        if kind in meshes:
            place_copy(kind, meshes[kind], (x, y, 0), (0, 0, turn))
        else:
            vertices, faces = turned(rounded(FOOT + PIECES[kind], 2), 28)
            meshes[kind] = add_mesh(kind, vertices, faces, wood, True, (x, y, 0), (0, 0, turn)).data
        if kind == "king":
            add_block("cross", (0.05, 0.05, 0.30), (x, y, 2.14), brass, (0, 0, turn))
            add_block("crossbar", (0.18, 0.05, 0.05), (x, y, 2.18), brass, (0, 0, turn))
        elif kind == "queen":
            for angle in (2 * math.pi * k / 9 for k in range(9)):
                add_ball("bead", 0.045, (x + 0.29 * math.cos(angle), y + 0.29 * math.sin(angle), 1.82),
                         brass, 16)
        elif kind == "rook":
            for angle in (2 * math.pi * k / 6 for k in range(6)):
                add_block("merlon", (0.10, 0.14, 0.14), (x + 0.25 * math.cos(angle),
                                                         y + 0.25 * math.sin(angle), 1.27),
                          wood, (0, 0, angle))


def build_bulbs():
    numbers = random.Random(29)
    glow = glowing("bulb", (1.0, 0.8, 0.5), 60.0)
    for _ in range(12):
        place = (numbers.uniform(-11, 8), numbers.uniform(9, 18), numbers.uniform(0.9, 5.0))
        add_ball("bulb", 0.06, place, glow, 12)
