"""Bunnies on bunnies to the fourth degree, in the light of a museum: fine structure.

The rule of growth and the light are those of docs/scenes/generate_instance_fractal.py in mitsuba-renderer/mitsuba-data
(BSD 3-clause), whose folder common is given with --files; there are fewer of
them here.
"""
DEPTH, REACH, SHRINK = 3, 0.0615, 0.4


def spots(centre, size, depth):
    """(centre, size) of a piece and of all that grow on it: eight each, shifted up."""
    yield centre, size
    if depth < DEPTH:
        for x in (1, -1):
            for y in (2, 0):
                for z in (1, -1):
                    yield from spots([c + REACH * size * s for c, s in zip(centre, (x, y, z))], SHRINK * size, depth + 1)


def scene(mi):
    place = mi.ScalarTransform4f
    made = {"type": "scene", "integrator": {"type": "path", "max_depth": 12},
            "sensor": {"type": "perspective", "fov": 28.8, "film": {"type": "hdrfilm", "width": 512, "height": 512},
                       "to_world": place().look_at([-0.5, 0.2, 0.25], [0, 0.08, 0], [0, 1, 0])},
            "museum": {"type": "envmap", "filename": "textures/museum.exr", "scale": 3, "to_world": place().rotate([0, 1, 0], 75)},
            "blue": {"type": "roughplastic", "alpha": 0.1, "diffuse_reflectance": {"type": "rgb", "value": [0.2, 0.25, 0.7]}}}
    for number, (centre, size) in enumerate(spots([0, 0, 0], 1, 0)):
        made["piece_%05d" % number] = {"type": "ply", "filename": "meshes/bunny_lowres.ply", "material": {"type": "ref", "id": "blue"},
                                       "to_world": place().translate(centre) @ place().scale(size)}
    return made
