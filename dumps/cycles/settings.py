"""Render settings under which one sample is one sample: independent, unclamped, unfiltered.

Every default of Cycles that would share, clamp, filter or reorder samples is replaced here; what the
scene itself decides (bounces, caustics, exposure) is left alone and written down.
"""
import bpy

from dumps.recording.failure import io_failure, scene_failure

# Cycles' own. (property, value); those a version does not have are skipped and not recorded.
SAMPLING = (
    ("use_adaptive_sampling", False),      # would stop pixels on its own
    ("use_denoising", False),
    ("sample_clamp_direct", 0.0),
    ("sample_clamp_indirect", 0.0),        # clamps to 10 by default
    ("light_sampling_threshold", 0.0),     # roulette on light samples by default
    ("blur_glossy", 0.0),                  # 1 by default: roughens caustics, biased
    ("pixel_filter_type", "BOX"),          # one pixel wide whatever filter_width says
    ("use_guiding", False),                # learns from earlier samples
    ("auto_scrambling_distance", False),
    ("scrambling_distance", 1.0),          # less than 1 correlates neighbouring pixels
    ("use_animated_seed", False),
    ("time_limit", 0.0),
    ("use_auto_tile", False),              # one result for the whole frame
    ("device", "CPU"),
)
RENDER = (
    ("use_persistent_data", True),         # keeps the scene between passes: 5 times as fast
    ("use_compositing", False),
    ("use_sequencer", False),
    ("use_freestyle", False),
    ("use_border", False),
    ("use_multiview", False),
    ("film_transparent", False),
    ("resolution_percentage", 100),
    ("dither_intensity", 0.0),
    ("use_placeholder", False),
    ("use_overwrite", True),
)
# The scene's own decisions, recorded so that two recordings of different physics do not mix.
SCENE_CYCLES = ("max_bounces", "diffuse_bounces", "glossy_bounces", "transmission_bounces",
                "volume_bounces", "transparent_max_bounces", "min_light_bounces",
                "min_transparent_bounces", "caustics_reflective", "caustics_refractive",
                "use_light_tree", "use_fast_gi", "film_exposure", "feature_set", "shading_system")
SCENE_RENDER = ("use_motion_blur", "motion_blur_shutter", "pixel_aspect_x", "pixel_aspect_y",
                "use_simplify")


def apply_settings(scene, view_layer, threads):
    render, cycles = scene.render, scene.cycles
    render.engine = "CYCLES"
    for owner, table in ((cycles, SAMPLING), (render, RENDER)):
        for name, value in table:
            if hasattr(owner, name):
                setattr(owner, name, value)
    set_pattern(cycles)
    for layer in scene.view_layers:
        layer.use = layer.name == view_layer.name
        layer.samples = 0                  # 0: no override of the scene's count
    if threads:
        render.threads_mode, render.threads = "FIXED", threads
    refuse_other_colours()


def set_pattern(cycles):
    """Independent pixels need the tabulated or the scrambled Sobol sequence. Blue noise, the default
    of later versions, correlates neighbouring pixels on purpose."""
    for pattern in ("TABULATED_SOBOL", "SOBOL"):
        try:
            cycles.sampling_pattern = pattern
            return
        except TypeError:                  # not in this version; the list itself cannot be asked
            continue
    raise io_failure("this Cycles (%s) knows neither TABULATED_SOBOL nor SOBOL" %
                     bpy.app.version_string)


def refuse_other_colours():
    space = getattr(getattr(bpy.data, "colorspace", None), "working_space", "Linear Rec.709")
    if space != "Linear Rec.709":
        raise scene_failure("working colour space is '%s': a dump holds linear Rec.709, change it in "
                            "the scene" % space)


def select_samples(scene, seed, first, count):
    """The next render takes the samples [first, first + count) of the sequence of `seed`."""
    cycles = scene.cycles
    cycles.seed = seed
    if hasattr(cycles, "use_sample_subset"):           # 4.4: `samples` is the whole sequence
        cycles.samples = max(2, power_of_two(first + count))
        cycles.use_sample_subset = True
        cycles.sample_offset, cycles.sample_subset_length = first, count
    else:
        cycles.samples, cycles.sample_offset = count, first
    scene.update_tag()    # with persistent data a changed seed does not reach the engine by itself


def power_of_two(count):
    return 1 << max(0, count - 1).bit_length()


def longest_sequence():
    """Samples of one sequence that can be asked for one by one: the tables of 3.5 to 4.3 have 256
    entries when a render has few samples, and half of them are used (indices N to 2N - 1)."""
    return 128 if (3, 5, 0) <= bpy.app.version < (4, 4, 0) else 1 << 15


def recorded_settings(scene):
    """What goes into the manifest; only names that are listed above are read (walking all properties
    of Cycles is known to crash at exit)."""
    render, cycles = scene.render, scene.cycles
    found = {"cycles." + name: getattr(cycles, name)
             for name, _ in SAMPLING if hasattr(cycles, name)}
    found["cycles.sampling_pattern"] = cycles.sampling_pattern
    found.update({"cycles." + n: getattr(cycles, n) for n in SCENE_CYCLES if hasattr(cycles, n)})
    found.update({"render." + n: getattr(render, n) for n, _ in RENDER if hasattr(render, n)})
    found.update({"render." + n: getattr(render, n) for n in SCENE_RENDER if hasattr(render, n)})
    return found
