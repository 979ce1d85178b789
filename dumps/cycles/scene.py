"""The scene to record: from a .blend file or built by a script of dumps/scenes; its needs and hash."""
import hashlib
import importlib.util
import inspect
import os
import sys

import bpy

from dumps.recording.failure import Failure, io_failure, scene_failure, usage_failure

MOST_OBJECTS = 32767     # largest pass_index
SCENES = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "scenes")


def scene_names():
    """Empty where the recorder stands alone, as in the add-on."""
    if not os.path.isdir(SCENES):
        return []
    return sorted(f[:-3] for f in os.listdir(SCENES) if f.endswith(".py") and f[0] != "_")


def load_scene(name, blend, folders=()):
    """name: of dumps/scenes, or a .py file with build() or build(find) -> scene, where find(file) is its path, beside the script or in
    one of `folders`.
    Returns (scene, identity for the manifest: name and sha256)."""
    if name and blend:
        raise usage_failure("--scene and --blend are two scenes: give one")
    if name:
        return _build_file(os.path.abspath(name), folders) if name.endswith(".py") else _build(name)
    if blend:
        _open(blend)
    if not bpy.data.filepath:
        raise usage_failure("no scene: give --blend FILE or --scene NAME (%s)" %
                            (", ".join(scene_names()) or "none here"))
    with open(bpy.data.filepath, "rb") as stream:
        digest = hashlib.sha256(stream.read()).hexdigest()
    return bpy.context.scene, {"name": os.path.basename(bpy.data.filepath), "sha256": digest}


def _build(name):
    if name not in scene_names():
        raise usage_failure("scene '%s' is unknown: use %s, or a .py file" % (name, ", ".join(scene_names())))
    source = os.path.join(SCENES, name + ".py")
    return _module(source).build(), {"name": name, "sha256": _digest([source])}


def _build_file(source, folders):
    if not os.path.isfile(source):
        raise Failure(3, "%s: no such file" % source)
    used = []

    def find(name):
        for folder in (os.path.dirname(source), *folders):
            path = os.path.join(folder, name)
            if os.path.isfile(path):
                used.append(path)
                return path
        raise usage_failure("%s: its file '%s' is not there: give the folder with --files" % (source, name))

    module = _module(source)
    if not hasattr(module, "build"):
        raise usage_failure("%s: has no function build(find) that returns a scene" % source)
    try:
        scene = module.build(find) if inspect.signature(module.build).parameters else module.build()
    except (Failure, KeyboardInterrupt):
        raise
    except (Exception, SystemExit) as error:  # of a user's script
        raise scene_failure("%s: build() failed: %s: %s" % (source, type(error).__name__, error))
    if not isinstance(scene, bpy.types.Scene):
        raise scene_failure("%s: build() returned no scene" % source)
    return scene, {"name": os.path.basename(source), "sha256": _digest([source, *used])}


def _module(source):
    """Of a script, which finds the package `model` of dumps/scenes."""
    if SCENES not in sys.path:
        sys.path.insert(0, SCENES)
    spec = importlib.util.spec_from_file_location("cycles_scene", source)
    module = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except (Exception, SystemExit) as error:
        raise scene_failure("%s: cannot be loaded: %s: %s" % (source, type(error).__name__, error))
    return module


def _digest(sources):
    """Of a script, its files, and the package `model`."""
    model = os.path.join(SCENES, "model")
    digest = hashlib.sha256()
    for source in [sources[0], *(os.path.join(model, f) for f in sorted(os.listdir(model)) if f.endswith(".py")), *sources[1:]]:
        with open(source, "rb") as stream:
            digest.update(stream.read())
    return digest.hexdigest()


def _open(blend):
    try:
        with open(blend, "rb") as stream:
            stream.read(1)
    except OSError as error:
        raise io_failure("%s: %s" % (blend, error.strerror))
    try:
        bpy.ops.wm.open_mainfile(filepath=os.path.abspath(blend), load_ui=False)
    except RuntimeError as error:
        raise Failure(1, "%s: Blender cannot load it: %s" % (blend, " ".join(str(error).split())))


def prepare(scene, camera, frame, size):
    """Frame, camera and resolution by the options; refuses what cannot be rendered. Returns the scene's own resolution."""
    found = scene.objects.get(camera) if camera else None
    if camera and (found is None or found.type != "CAMERA"):
        cameras = sorted(o.name for o in scene.objects if o.type == "CAMERA")
        raise usage_failure("camera '%s' is not in the scene (%s)" %
                            (camera, ", ".join(cameras) or "it has none"))
    # Cameras bound to markers of the timeline: the frame chooses among them, and nothing else does from then on.
    bound = [marker for marker in scene.timeline_markers if marker.camera]
    if frame is not None or bound:
        scene.frame_set(scene.frame_current if frame is None else frame)
    chosen = found if camera else scene.camera
    for marker in bound:
        marker.camera = None               # some versions then look for another one, so the choice comes last
    scene.camera = chosen
    if scene.camera is None:
        raise scene_failure("scene '%s' has no camera: set one in the file or give --camera NAME" %
                            scene.name)
    if scene.camera.type != "CAMERA":
        raise scene_failure("scene '%s' looks through '%s', which is no camera" %
                            (scene.name, scene.camera.name))
    render = scene.render
    percent = render.resolution_percentage
    own = max(1, render.resolution_x * percent // 100), max(1, render.resolution_y * percent // 100)
    render.resolution_x, render.resolution_y = size or own
    return own


def aspect_change(size, own):
    """A line to print where the picture has another aspect than the file's own, or None. The scenes of dumps/scenes have no size of
    their own."""
    if abs(size[0] * own[1] - size[1] * own[0]) <= max(own):
        return None
    return "%dx%d has another aspect than the scene's %dx%d: the picture shows more or less of it" % (*size, *own)


def number_objects():
    """All of the file: what a collection shows as an instance is no object of the scene."""
    items = sorted(bpy.data.objects, key=lambda o: (o.name, o.library.filepath if o.library else ""))
    if len(items) > MOST_OBJECTS:
        raise scene_failure("the file has %d objects, and Blender numbers %d: leave out the channel object" % (len(items), MOST_OBJECTS))
    for i, item in enumerate(items):
        item.pass_index = i + 1


def find_needs(scene):
    """What the scene makes a sample depend on: {'depth_of_field': ..., ...}, true or false."""
    camera = scene.camera.data
    return {
        "depth_of_field": bool(camera.dof.use_dof and _aperture(camera) > 0),
        "motion_blur": bool(scene.render.use_motion_blur and scene.render.motion_blur_shutter > 0),
        "volumes": _has_volumes(scene),
    }


def _aperture(camera):
    """Radius of the lens; 0 where the f-number is infinite."""
    stop = camera.dof.aperture_fstop
    return camera.lens / (2000.0 * stop) if stop > 0 else 1.0


def _material_trees():
    return [m.node_tree for m in bpy.data.materials if m.use_nodes and m.users]


def _has_volumes(scene):
    trees = _material_trees()
    if scene.world and scene.world.use_nodes:
        trees.append(scene.world.node_tree)
    linked = any(link.to_node.bl_idname.startswith("ShaderNodeOutput") and
                 link.to_socket.name == "Volume" for tree in trees for link in tree.links)
    return linked or any(o.type == "VOLUME" for o in scene.objects)


def lets_a_part_through(scene):
    """Whether a camera ray may reach a surface with less than all its light, or pass it with the rest."""
    return _has_volumes(scene) or any(_is_transparent(node) for tree in _material_trees() for node in _nodes(tree))


def _nodes(tree, seen=()):
    """Those of its groups too."""
    for node in tree.nodes:
        yield node
        inner = getattr(node, "node_tree", None)
        if inner and inner not in seen:
            yield from _nodes(inner, (*seen, inner))


def _is_transparent(node):
    alpha = node.inputs.get("Alpha") if node.bl_idname == "ShaderNodeBsdfPrincipled" else None
    return node.bl_idname in ("ShaderNodeBsdfTransparent", "ShaderNodeHoldout") or bool(alpha and (alpha.is_linked or alpha.default_value < 1))
