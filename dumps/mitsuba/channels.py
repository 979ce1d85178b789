"""Layers of a Mitsuba recording: what they are called in the file, their type, and what uses them."""

from dumps.recording.failure import scene_failure, usage_failure

# layer: (dtype in the file, components, always available)
LAYERS = {
    "radiance": ("f4", "RGB"),
    "direct": ("f4", "RGB"),
    "albedo": ("f2", "RGB"),
    "normal": ("f2", "XYZ"),
    "depth": ("f4", "Z"),
    "position": ("f4", "XYZ"),
    "film": ("f4", "XY"),
    "lens": ("f4", "UV"),
    "time": ("f4", "T"),
    "shape": ("u4", "I"),
}
FEATURES = ("albedo", "normal", "depth", "position", "shape")
NEEDED = "needed"  # lens and time, where the scene has them
DEFAULT = "radiance,albedo,normal,depth,film," + NEEDED
NOT_THERE = {"lens": "the camera has no aperture", "time": "the shutter is open for no time",
             "direct": "only the path integrator can tell the direct part"}
MEANINGS = {
    "radiance": {"meaning": "linear Rec.709, unclamped"},
    "direct": {"meaning": "the part of the same path that met at most one surface; the rest is radiance - direct"},
    "albedo": {"meaning": "reflectance of the first hit; 1 where its material mirrors or refracts and has no diffuse part or a black "
                          "one, 0 where nothing is hit"},
    "normal": {"space": "world", "meaning": "shading normal of the first hit; 0 where nothing is hit"},
    "depth": {"meaning": "camera z, 0 = miss"},
    "position": {"space": "world", "meaning": "first hit"},
    "shape": {"meaning": "1 + index in scene.shapes, 0 = miss"},
    "film": {"meaning": "place in the pixel, [0, 1), y down"},
    "lens": {"meaning": "place on the unit disk; times the radius: on the lens"},
    "time": {"meaning": "[0, 1) of the open shutter"},
}


def material_flags(mi, scene):
    """[1 + number of shapes] int: the lobes of the material of each shape. [0]: a miss, and what has no material of its own
    (instances), counts as diffuse, so that its albedo stays as it is."""
    materials = [shape.bsdf() for shape in scene.shapes()]
    return [int(mi.BSDFFlags.Diffuse)] + [int(mi.BSDFFlags.Diffuse if material is None else material.flags()) for material in materials]


def no_diffuse_answer(mi, flags, black):
    """Whether a hit has no albedo of its own; flags: of its material; black: Mitsuba's albedo is 0. Numbers or arrays of Dr.Jit.

    A material that only mirrors or refracts (metal, glass, smooth or rough) answers 0, or for rough metal an estimate up to 24;
    one that blends such a lobe with an unknown or a black diffuse one answers 0. Denoisers expect 1 there (documentation of
    Open Image Denoise, albedo of metals and of glass). What is diffuse and nothing else may be black.
    """
    diffuse, mirrors = int(mi.BSDFFlags.Diffuse), int(mi.BSDFFlags.Glossy) | int(mi.BSDFFlags.Delta)
    return (flags & diffuse == 0) | (black & (flags & mirrors != 0))


def past_lamps(dr, scene, ray):
    """The ray from behind the lamps that it meets first: where an integrator hides lamps, light and features are of what stands there."""
    while True:
        hit = scene.ray_intersect(ray)
        lamp = hit.is_valid() & (hit.emitter(scene) != None)  # noqa: E711
        if not dr.any(lamp):
            return ray
        ray = type(ray)(ray)
        ray.o = dr.select(lamp, hit.spawn_ray(ray.d).o, ray.o)


def has_instances(scene):
    return any(shape.class_name() == "Instance" for shape in scene.shapes())


def chosen_layers(wanted, recordable):
    """Names in file order. `needed` adds lens and time where the scene has them; `all` takes everything that is there."""
    named = [name for name in wanted.split(",") if name]
    unknown = [name for name in named if name not in (*LAYERS, NEEDED, "all")]
    if unknown:
        raise usage_failure("unknown channel '%s': choose from %s" % (unknown[0], ", ".join(LAYERS)))
    available = dict(lens=recordable.has_lens, time=recordable.shutter_time > 0, direct=recordable.direct is not None)
    missing = [name for name in named if not available.get(name, True)]
    if missing and "all" not in named:
        raise scene_failure("%s: %s: leave out `%s`%s" % (recordable.name, NOT_THERE[missing[0]], missing[0],
                                                          " or give --integrator path" if missing[0] == "direct" else ""))
    names = LAYERS if "all" in named else [*named, *(("lens", "time") if NEEDED in named else ())]
    return ["radiance"] + [name for name in LAYERS
                           if name != "radiance" and name in names and available.get(name, True)]
