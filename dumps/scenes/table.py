"""A laid table by a window: fine textures, glass, china, thin metal, one wide soft light. No lens blur.

Hard for a filter: the stripes of the cloth are near the size of a pixel, shadows are wide and soft, and
the edges of cutlery and glass are thin and bright.
"""
import math
import random

from model.materials import Shader, glowing, grained, plain
from model.shapes import add_ball, add_block, add_sheet, add_turned, rounded
from model.stage import add_camera, add_lamp, start_scene

PLATE = [(0, 0.02), (0.55, 0.03), (0.78, 0.08), (1.15, 0.20), (1.18, 0.22), (1.15, 0.16), (0.75, 0.03), (0, 0)]
GOBLET = [(0, 0), (0.42, 0.0), (0.40, 0.03), (0.06, 0.08), (0.05, 0.80), (0.12, 0.97), (0.40, 1.25), (0.46, 1.6),
          (0.36, 2.1), (0.345, 2.1), (0.44, 1.6), (0.38, 1.28), (0.08, 1.02), (0, 1.0)]
TUMBLER = [(0, 0.0), (0.34, 0.0), (0.38, 0.06), (0.44, 1.1), (0.42, 1.12), (0.40, 1.1), (0.34, 0.13), (0, 0.1)]


def build():
    scene = start_scene((0.03, 0.03, 0.03), (0.20, 0.22, 0.25), 0.7)
    oak = grained("oak", (0.35, 0.20, 0.09), (0.55, 0.36, 0.18), 1.6, 0.35, 0.2)
    add_sheet("top", 12, 8, (0, 0, 0), oak)
    add_sheet("cloth", 5.4, 4.2, (-0.4, -0.4, 0.004), gingham(), (0, 0, 0.35))
    add_sheet("wall", 14, 8, (0, 3.6, 3.6), tiles(), (math.pi / 2, 0, 0))
    china = plain("china", (0.85, 0.85, 0.82), 0.08, Clearcoat=0.5)
    glass = plain("glass", (0.98, 0.99, 0.98), 0.0, Transmission=1.0, IOR=1.45)
    steel = plain("steel", (0.75, 0.75, 0.76), 0.12, Metallic=1.0)
    add_turned("plate", rounded(PLATE, 2), china, (-0.9, -0.9, 0.01), 48)
    add_turned("goblet", rounded(GOBLET, 2), glass, (0.35, 0.55, 0.01), 32)
    add_turned("tumbler", rounded(TUMBLER, 2), glass, (1.25, -0.75, 0.01), 40)
    lay_cutlery(steel)
    fill_bowl(china)
    wax = plain("wax", (0.9, 0.85, 0.7), 0.4)
    add_turned("candle", [(0, 0), (0.2, 0), (0.2, 1.15), (0.16, 1.18), (0, 1.15)], wax, (-1.6, 1.7, 0.01))
    flame = add_ball("flame", 0.06, (-1.6, 1.7, 1.32), glowing("flame", (1.0, 0.55, 0.18), 120.0), 16)
    flame.scale = (1, 1, 2.2)
    add_lamp("window", (-6.0, -0.5, 4.0), (0, 0, 0.4), 2.4, 650, (0.85, 0.93, 1.0), 3.2)
    add_camera((1.1, -6.6, 3.4), (-0.1, 0.25, 0.55), 48)
    return scene


def gingham():
    """Checks of two stripes, and a fine diagonal weave near the size of a pixel."""
    shader = Shader("gingham", roughness=0.9)
    axes = shader.add("ShaderNodeSeparateXYZ", {0: shader.place()})
    x, y = axes.outputs["X"], axes.outputs["Y"]

    def stripes(along, count):
        return shader.math("GREATER_THAN", shader.math("FRACT", shader.math("MULTIPLY", along, count)), 0.5)

    checks = shader.math("MULTIPLY", shader.math("ADD", stripes(x, 4.0), stripes(y, 4.0)), 0.46)
    weave = shader.math("MULTIPLY", stripes(shader.math("ADD", x, y), 34.0), 0.08)
    shader.feed("Base Color", shader.blend(shader.math("ADD", checks, weave),
                                           [(0.0, (0.85, 0.84, 0.80)), (1.0, (0.55, 0.03, 0.04))]))
    return shader.material


def tiles():
    shader = Shader("tiles", roughness=0.15, Clearcoat=0.3)
    brick = shader.add("ShaderNodeTexBrick", {
        "Vector": shader.place(), "Scale": 1.6, "Mortar Size": 0.014, "Color1": (0.62, 0.70, 0.72, 1),
        "Color2": (0.35, 0.50, 0.56, 1), "Mortar": (0.75, 0.73, 0.68, 1)})
    shader.feed("Base Color", brick.outputs["Color"])
    return shader.material


def lay_cutlery(steel):
    for name, x, y, turn in (("knife", 0.50, -1.0, 0.33), ("spoon", 0.78, -1.05, 0.36), ("fork", -2.35, -1.0, 0.28)):
        along, across = (-math.sin(turn), math.cos(turn)), (math.cos(turn), math.sin(turn))

        def place(forward, sideways, height=0.03):
            return (x + forward * along[0] + sideways * across[0],
                    y + forward * along[1] + sideways * across[1], height)

        add_block(name, (0.09, 1.3, 0.03), place(0, 0), steel, (0, 0, turn), 0.01)
        if name == "knife":
            add_block("blade", (0.15, 0.9, 0.012), place(1.05, 0), steel, (0, 0, turn))
        elif name == "spoon":
            add_ball("bowl", 0.2, place(0.8, 0, 0.04), steel, 32, (0, 0, turn)).scale = (0.8, 1.3, 0.2)
        else:
            add_block("neck", (0.26, 0.12, 0.028), place(0.66, 0), steel, (0, 0, turn))
            for tine in range(4):
                add_block("tine", (0.022, 0.55, 0.025), place(0.95, (tine - 1.5) * 0.07), steel, (0, 0, turn))


def fill_bowl(china):
    numbers = random.Random(5)
    bowl = [(0, 0), (0.5, 0), (0.75, 0.12), (1.15, 0.62), (1.12, 0.64), (0.72, 0.18), (0, 0.1)]
    add_turned("bowl", rounded(bowl, 2), china, (2.1, 1.2, 0.01), 48)
    kinds = [fruit("apple", (0.55, 0.02, 0.02), (0.75, 0.45, 0.06), 3.0),
             fruit("orange", (0.85, 0.30, 0.02), (0.90, 0.42, 0.04), 25.0),
             fruit("pear", (0.50, 0.58, 0.10), (0.30, 0.40, 0.05), 9.0)]
    for i, (x, y, z) in enumerate(((-0.38, -0.1, 0.45), (0.36, 0.0, 0.47), (0.0, 0.5, 0.45), (0.02, 0.1, 0.98))):
        turn = (numbers.uniform(0, 6), numbers.uniform(0, 6), 0)
        add_ball("fruit", 0.36, (2.1 + x, 1.2 + y, z), kinds[i % 3], 40, turn)
    add_ball("fruit", 0.36, (-0.95, -0.75, 0.42), kinds[0], 40)


def fruit(name, low, high, scale):
    shader = Shader(name, low, 0.3, Clearcoat=0.3)
    noise = shader.add("ShaderNodeTexNoise", {"Vector": shader.place(), "Scale": scale, "Detail": 4.0})
    shader.feed("Base Color", shader.blend(noise.outputs["Fac"], [(0.4, low), (0.62, high)]))
    return shader.material
