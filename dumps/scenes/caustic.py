"""Light through glass: a small lamp, a solid ball and a thick ring of glass, and what they focus.

Hard for a sampler: the caustic is found by chance alone (a diffuse bounce that meets the small lamp
through two refractions), so most samples there are dark and a few are hundreds of times too bright.
"""
from model.materials import Shader, glowing, plain
from model.shapes import add_ball, add_mesh, add_sheet, turned
from model.stage import add_camera, start_scene

RING = [(0.80, 0.0), (1.00, 0.0), (1.06, 0.12), (1.06, 0.55), (1.00, 0.66), (0.80, 0.66), (0.74, 0.55),
        (0.74, 0.12), (0.80, 0.0)]


def build():
    scene = start_scene((0.01, 0.01, 0.012), (0.03, 0.035, 0.045), 0.6)
    add_sheet("floor", 30, 30, (0, 0, 0), paper())
    glass = plain("glass", (0.97, 0.99, 0.98), 0.0, Transmission=1.0, IOR=1.5)
    amber = plain("amber", (0.95, 0.50, 0.12), 0.0, Transmission=1.0, IOR=1.55)
    add_ball("ball", 0.75, (-0.9, 0.1, 0.76), glass, 40)
    vertices, faces = turned(RING, 48)
    add_mesh("ring", vertices, faces, amber, True, (1.25, -0.3, 0.01))
    add_ball("pebble", 0.3, (0.1, -1.3, 0.3), plain("stone", (0.25, 0.23, 0.21), 0.6), 32)
    add_ball("lamp", 0.28, (-3.2, 3.2, 4.2), glowing("lamp", (1.0, 0.94, 0.84), 260.0), 24)
    add_camera((0.4, -5.6, 3.6), (0.15, -0.15, 0.3), 45)
    return scene


def paper():
    """White, ruled with thin lines that the caustic crosses."""
    shader = Shader("paper", roughness=0.9)
    axes = shader.add("ShaderNodeSeparateXYZ", {0: shader.place()})
    fraction = shader.math("FRACT", shader.math("MULTIPLY", axes.outputs["Y"], 2.5))
    line = shader.math("LESS_THAN", fraction, 0.06)
    shader.feed("Base Color", shader.blend(line, [(0.0, (0.80, 0.79, 0.76)), (1.0, (0.12, 0.18, 0.45))]))
    return shader.material
