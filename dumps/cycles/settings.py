"""Render settings under which one sample is one sample: independent, unclamped, unfiltered.

Every default of Cycles that would share, clamp, filter or reorder samples is replaced here; what the
scene itself decides (bounces, caustics, exposure) is left alone and written down.
"""
import bpy

from dumps.cycles.animation import mute
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
# Set beside the tables above, here and by the recorder.
CYCLES_TOO = ("seed", "samples", "sample_offset", "use_sample_subset", "sample_subset_length", "sampling_pattern")
RENDER_TOO = ("engine", "resolution_x", "resolution_y", "threads_mode", "threads", "filepath", "use_file_extension")
# Sampling settings in words; those that are replaced are named in one line.
WORDS = {"use_adaptive_sampling": "adaptive sampling", "sample_clamp_direct": "clamp of direct light",
         "sample_clamp_indirect": "clamp of indirect light", "light_sampling_threshold": "light threshold", "blur_glossy": "filter glossy",
         "pixel_filter_type": "pixel filter", "use_guiding": "path guiding", "auto_scrambling_distance": "scrambling distance",
         "scrambling_distance": "scrambling distance", "time_limit": "time limit", "device": "device"}
PLAIN_COMPOSITOR = {"CompositorNodeRLayers", "CompositorNodeComposite", "CompositorNodeViewer", "CompositorNodeReroute", "NodeFrame",
                    "NodeReroute"}


def overridden(scene, view_layer):
    """What a scene asks of the picture and a recording does not do: one line each, before the settings are replaced."""
    render, cycles, lines = scene.render, scene.cycles, []
    made_for_cycles = render.engine == "CYCLES"
    if not made_for_cycles:
        lines.append("the scene is made for %s: Cycles renders it, and it may look otherwise" % render.engine)
    if render.use_border:
        lines.append("the render border %.3g..%.3g x %.3g..%.3g%s is not kept: the whole picture is recorded" % (
            render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y,
            " and its crop" if render.use_crop_to_border else ""))
    if render.use_multiview:
        lines.append("stereo is left out: one view is recorded, of the camera itself")
    others = [layer.name for layer in scene.view_layers if layer.use and layer.name != view_layer.name]
    if others:
        lines.append("only the view layer %s is recorded, not %s" % (view_layer.name, ", ".join(others)))
    if view_layer.material_override:
        lines.append("the view layer's material %s stands for all others, as in the scene" % view_layer.material_override.name)
    if view_layer.samples:
        lines.append("the view layer's own %d samples are not used" % view_layer.samples)
    if render.film_transparent:
        lines.append("the transparent film is not kept: the background is recorded")
    if render.use_compositing and scene.use_nodes and _composes(scene):
        lines.append("the compositor is left out")
    if render.use_sequencer and scene.sequence_editor and len(scene.sequence_editor.sequences_all):
        lines.append("the video sequence is left out")
    if render.use_freestyle:
        lines.append("Freestyle lines are left out")
    if cycles.use_denoising and made_for_cycles:
        lines.append("the denoiser is left out")
    replaced = [WORDS[name] for name, value in SAMPLING if name in WORDS and getattr(cycles, name, value) != value]
    if replaced and made_for_cycles:
        lines.append("replaced, so that samples are independent and unclamped: %s" % ", ".join(dict.fromkeys(replaced)))
    return lines


def _composes(scene):
    tree = getattr(scene, "node_tree", None) or getattr(scene, "compositing_node_group", None)
    return bool(tree) and any(node.bl_idname not in PLAIN_COMPOSITOR for node in tree.nodes)


def mute_animation(scene):
    """A curve or driver of a setting would put its own value in the place of the recorder's in every pass. Returns lines that say so."""
    set_here = {"cycles." + name for name in [*dict(SAMPLING), *CYCLES_TOO]} | {"render." + name for name in [*dict(RENDER), *RENDER_TOO]}
    # switches of passes and counts of the view layers; how a picture is written is the recorder's too
    muted = mute(scene, lambda path: path in set_here or path.startswith("render.image_settings.") or
                 path.startswith("view_layers[") and path.rpartition(".")[2].startswith(("use", "samples", "denoising_store")))
    if scene.world:
        muted += mute(scene.world, lambda path: path.startswith("mist_settings."))
    for item in bpy.data.objects:
        muted += mute(item, lambda path: path == "pass_index")
    return ["animated or driven, and set by the recorder instead: %s" % ", ".join(sorted(set(muted)))] if muted else []


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
        raise scene_failure("working colour space is '%s': a recording holds linear Rec.709, change it in "
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
