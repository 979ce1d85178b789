"""A hedge of leaves in front of a wall, under sun and sky: fine foliage.

The leaf (common/textures/leaf_mask.png) is that of mitsuba-renderer/mitsuba-data (BSD 3-clause), whose folder
common/textures is given with --files; where leaves are, wall, camera and light are this project's.
"""
import math
import random

LEAVES, SEED = 1500, 7


def scene(mi):
    draw, place = random.Random(SEED), mi.ScalarTransform4f
    made = {"type": "scene", "integrator": {"type": "path", "max_depth": 12},
            "sensor": {"type": "perspective", "fov": 32, "film": {"type": "hdrfilm", "width": 512, "height": 512},
                       "to_world": place().look_at([-1.2, 1.5, 6.4], [0, 1.1, 0], [0, 1, 0])},
            "sky": {"type": "sunsky", "sun_direction": [-0.55, 0.72, 0.42], "sun_aperture": 1.5,
                    "to_world": place().rotate([1, 0, 0], -90)},
            "leaf": {"type": "mask", "opacity": {"type": "bitmap", "filename": "leaf_mask.png", "raw": True},
                     "bsdf": {"type": "twosided", "bsdf": {"type": "roughplastic", "alpha": 0.15,
                              "diffuse_reflectance": {"type": "rgb", "value": [0.14, 0.42, 0.09]}}}},
            "ground": {"type": "rectangle", "to_world": place().rotate([1, 0, 0], -90) @ place().scale(2000),
                       "material": {"type": "diffuse", "reflectance": {"type": "rgb", "value": [0.32, 0.27, 0.2]}}},
            "wall": {"type": "cube", "to_world": place().translate([0.9, 0.7, -1.6]) @ place().scale([1.6, 0.7, 0.1]),
                     "material": {"type": "diffuse", "reflectance": {"type": "rgb", "value": [0.62, 0.5, 0.42]}}}}
    for number in range(LEAVES):
        angle, height = draw.uniform(0, 2 * math.pi), draw.random()
        reach = (0.9 - 0.55 * height) * math.sqrt(draw.random()) * 1.6
        turned = place().rotate([0, 1, 0], draw.uniform(0, 360)) @ place().rotate([1, 0, 0], draw.uniform(-80, 20))
        made["leaf_%04d" % number] = {"type": "rectangle", "material": {"type": "ref", "id": "leaf"}, "to_world": place().translate(
            [reach * math.cos(angle), 0.1 + 2.1 * height, 0.7 * reach * math.sin(angle)]) @ turned @ place().scale(draw.uniform(0.06, 0.13))}
    return made
