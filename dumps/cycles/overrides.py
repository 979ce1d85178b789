"""What a scene asks of the picture and a recording does not do: one line each, before the settings are replaced."""
from dumps.cycles.settings import SAMPLING

# Sampling settings in words; those that are replaced are named in one line.
WORDS = {"use_adaptive_sampling": "adaptive sampling", "sample_clamp_direct": "clamp of direct light",
         "sample_clamp_indirect": "clamp of indirect light", "light_sampling_threshold": "light threshold", "blur_glossy": "filter glossy",
         "pixel_filter_type": "pixel filter", "use_guiding": "path guiding", "auto_scrambling_distance": "scrambling distance",
         "scrambling_distance": "scrambling distance", "time_limit": "time limit", "device": "device"}
PLAIN_COMPOSITOR = {"CompositorNodeRLayers", "CompositorNodeComposite", "CompositorNodeViewer", "CompositorNodeReroute", "NodeFrame",
                    "NodeReroute"}


def overridden(scene, view_layer):
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
