"""The layers that measure distance: how far they may reach, in which type, and what they mix.

Cycles writes the mist pass for every sample index, the depth pass for index 0 alone: `depth` is a distance by mist, whose end is the reach,
or the depth pass.
"""
import bpy

from dumps.cycles.passes import LARGEST_HALF, MIST_DEPTH
from dumps.cycles.scene import lets_a_part_through
from dumps.recording.failure import io_failure

ROUNDING = 1e-5          # of single-precision matrices, that two evaluations of one scene may differ by
DISTANCES = ("depth", "depth_ns")


def prepare_depth(scene, plan):
    """(plan, reach of the mist or 0 without, lines on what the layer mixes)"""
    if not any(name in plan for name in DISTANCES):
        return plan, 0.0, []
    reach = scene_reach(scene)
    if reach > LARGEST_HALF:               # what 16 bits cannot hold would be found out when all is rendered
        plan = {name: channel._replace(dtype="f32") if name in DISTANCES else channel for name, channel in plan.items()}
    if "depth" not in plan or plan["depth"].sources != MIST_DEPTH.sources:
        return plan, 0.0, []
    reach = _set_mist(scene, reach)
    if not lets_a_part_through(scene):
        return plan, reach, []
    # The pass sums 1 - distance / reach over what a ray meets, each times its share of the light: the rest counts as the reach.
    note = "mixed with its reach, %.6g, where a surface or a volume lets only a part of the light through" % reach
    plan = {**plan, "depth": plan["depth"]._replace(note="%s; %s" % (plan["depth"].note, note))}
    return plan, reach, ["the layer depth is %s (--mode shift takes one surface)" % note]


def _set_mist(scene, reach):
    """Returns the reach as Blender holds it, in single precision."""
    world = scene.world
    if world is None:
        world = scene.world = bpy.data.worlds.new("record")
        world.use_nodes = False
        world.color = (0.0, 0.0, 0.0)
    mist = world.mist_settings
    mist.use_mist, mist.start, mist.falloff = False, 0.0, "LINEAR"
    mist.depth = reach
    return mist.depth


def scene_reach(scene):
    """A length in scene units that no camera ray's first hit exceeds: twice the distance from the
    camera to the farthest corner of any object's box (moving objects move within that factor).
    As the viewport shows the scene, unless more of it is rendered: recordings that were begun so go on."""
    shown, rendered = _farthest(bpy.context.evaluated_depsgraph_get(), scene.camera), _farthest_rendered(scene)
    return 2.0 * (rendered if rendered > shown * (1 + ROUNDING) else shown)


def _farthest_rendered(scene):
    found = []

    class Measure(bpy.types.RenderEngine):
        """Only a renderer is given the scene as it is rendered: objects and modifiers that the viewport hides belong to it."""
        bl_idname, bl_label = "SPOOL_MEASURE", "Measure"

        def render(self, depsgraph):
            try:
                found.append(_farthest(depsgraph, depsgraph.scene_eval.camera))
            except Exception as error:     # must not leave the engine's call: Blender would go on
                found.append(error)

    bpy.utils.register_class(Measure)
    engine, scene.render.engine = scene.render.engine, Measure.bl_idname
    try:
        bpy.ops.render.render()
    except RuntimeError as error:
        raise io_failure("Blender could not evaluate the scene: %s" % " ".join(str(error).split()))
    finally:
        scene.render.engine = engine
        bpy.utils.unregister_class(Measure)
    if not found or isinstance(found[0], Exception):
        raise io_failure("Blender could not measure how far the scene reaches%s: leave out the channel depth" %
                         (" (%s)" % found[0] if found else ""))
    return found[0]


def _farthest(depsgraph, camera):
    eye = camera.matrix_world.translation
    farthest = 1.0
    for instance in depsgraph.object_instances:
        if instance.object.type in ("CAMERA", "LIGHT", "EMPTY", "ARMATURE"):
            continue
        matrix = instance.matrix_world
        for corner in instance.object.bound_box:
            point = [sum(matrix[r][k] * corner[k] for k in range(3)) + matrix[r][3] for r in range(3)]
            farthest = max(farthest, sum((p - e) ** 2 for p, e in zip(point, eye)) ** 0.5)
    return farthest
