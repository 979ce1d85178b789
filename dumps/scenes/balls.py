"""Pool balls under two rectangular lamps; one ball moves and rolls while the shutter is open.

Hard for a sampler: lens blur, motion blur and the penumbrae of two lamps at once, beside large parts
that are clean after few samples.
"""
import math
import random

from model.materials import Shader, grained, plain
from model.shapes import add_ball, add_block, add_sheet, add_turned
from model.stage import add_camera, add_lamp, start_scene

RADIUS = 0.5
COLOURS = [(0.9, 0.6, 0.02), (0.02, 0.06, 0.5), (0.7, 0.02, 0.02), (0.15, 0.02, 0.3), (0.9, 0.22, 0.02),
           (0.01, 0.22, 0.06), (0.28, 0.02, 0.03), (0.01, 0.01, 0.01)]
PLACES = [(-2.2, 1.2), (-0.75, 0.4), (0.6, 1.7), (1.9, 0.3), (-1.3, 3.2), (0.1, 4.4), (2.7, 3.0), (3.9, 4.9),
          (-3.9, 4.7), (-0.2, -1.6), (-3.3, -0.9)]


def build():
    scene = start_scene((0.01, 0.01, 0.012), (0.05, 0.06, 0.08), 0.5)
    cloth = felt()
    add_sheet("cloth", 24, 24, (0, 0, 0), cloth)
    add_block("cushion", (24, 0.5, 0.65), (0, 6.2, 0.32), cloth, chamfer=0.12)
    rail = grained("rail", (0.09, 0.03, 0.012), (0.25, 0.10, 0.04), 1.2, 0.15, 0.8)
    add_block("rail", (24, 1.6, 0.75), (0, 7.25, 0.37), rail, chamfer=0.1)
    pearl = plain("pearl", (0.9, 0.88, 0.8), 0.1, Clearcoat=1.0)
    for i in range(-4, 5):
        add_block("mark", (0.16, 0.16, 0.02), (i * 1.6, 7.25, 0.755), pearl, (0, 0, math.pi / 4))
    numbers = random.Random(11)
    for i, (x, y) in enumerate(PLACES):
        turn = tuple(numbers.uniform(0, 6) for _ in range(3))
        add_ball("ball", RADIUS, (x, y, RADIUS), ball_paint(i, COLOURS[i % 8], i > 6), 40, turn)
    add_ball("cue ball", RADIUS, (0.7, -1.5, RADIUS), plain("ivory", (0.88, 0.85, 0.76), 0.05, Clearcoat=0.8), 40)
    roll(scene, add_ball("moving", RADIUS, (0, 0, RADIUS), ball_paint(20, (0.75, 0.02, 0.02), True), 40))
    ash = plain("ash", (0.75, 0.55, 0.30), 0.2, Clearcoat=0.6)
    cue = [(0, 0), (0.06, 0.0), (0.065, 0.2), (0.17, 9.0), (0, 9.0)]
    add_turned("cue", cue, ash, (0.45, -2.05, 0.60), 24, (math.radians(84), 0, math.radians(-25)))
    add_lamp("left lamp", (-2.6, 1.0, 5.2), (-2.6, 1.0, 0), 2.2, 420, (1.0, 0.90, 0.72), 0.9)
    add_lamp("right lamp", (2.8, 2.0, 5.2), (2.8, 2.0, 0), 2.2, 420, (1.0, 0.90, 0.72), 0.9)
    add_camera((0.4, -7.2, 2.7), (0.25, 0.9, 0.35), 50, focus=6.55, radius=0.156)
    return scene


def roll(scene, ball):
    """The shutter is open around frame 1. Four keys on one line keep Blender's smooth curve nearly straight
    there; to ask for a straight one differs between versions."""
    for frame in (-2, 0, 2, 4):
        ball.location = (2.3 + 0.75 * (frame - 1), -1.35 + 0.6 * (frame - 1), RADIUS)
        ball.rotation_euler = (0.3, 1.8 * frame, 0.4)
        ball.keyframe_insert("location", frame=frame)
        ball.keyframe_insert("rotation_euler", frame=frame)
    scene.frame_start, scene.frame_end = 1, 2
    scene.frame_set(1)
    scene.render.use_motion_blur = True
    scene.render.motion_blur_shutter = 0.7


def felt():
    shader = Shader("felt", (0.02, 0.22, 0.09), 0.95, Specular=0.1)
    noise = shader.add("ShaderNodeTexNoise", {"Vector": shader.place(), "Scale": 60.0, "Detail": 6.0})
    shader.feed("Base Color", shader.blend(noise.outputs["Fac"],
                                           [(0.35, (0.010, 0.13, 0.05)), (0.65, (0.03, 0.30, 0.12))]))
    return shader.material


def ball_paint(number, colour, striped):
    """A white disc with a ring where the number stands, and a white cap above and below a stripe."""
    shader = Shader("ball %d" % number, colour, 0.05, Clearcoat=0.8)
    unit = shader.add("ShaderNodeVectorMath", {0: shader.place()}, operation="NORMALIZE").outputs[0]
    axes = shader.add("ShaderNodeSeparateXYZ", {0: unit})
    side, height = (shader.math("ABSOLUTE", axes.outputs[a]) for a in "XZ")
    white = shader.math("GREATER_THAN", side, 0.93)
    if striped:
        white = shader.math("MAXIMUM", white, shader.math("GREATER_THAN", height, 0.5))
    ring = shader.math("MULTIPLY", shader.math("GREATER_THAN", side, 0.955), shader.math("LESS_THAN", side, 0.985))
    painted = shader.add("ShaderNodeMixRGB", {0: white, 1: (*colour, 1), 2: (0.86, 0.83, 0.74, 1)})
    ringed = shader.add("ShaderNodeMixRGB", {0: ring, 1: painted.outputs[0], 2: (0.01, 0.01, 0.01, 1)})
    shader.feed("Base Color", ringed.outputs[0])
    return shader.material
