"""Edits of a parsed scene before it is instantiated: film, filter, sampler and integrator as a recording needs them."""
from collections import namedtuple

import numpy as np

from dumps.recording.failure import scene_failure, usage_failure

SCALE_TOLERANCE = 5e-4           # below what Mitsuba takes for a scale: a squared length within 1e-3 of 1
AROUND_ANOTHER = "aov", "moment"
DEFAULT_FILM = 768, 576          # what Mitsuba takes where the film has no size
# size: (width, height); direct: dict of the integrator of direct light only, or None; hides: whether the integrator hides lamps;
# changes: lines to print
Forced = namedtuple("Forced", "size direct hides changes")


def substitute(state, substitutes):
    used = set()
    for node in state.nodes:
        plugin = node.props.plugin_name()
        if plugin in substitutes:
            node.props.set_plugin_name(substitutes[plugin])
            used.add(plugin)
    unused = sorted(set(substitutes) - used)
    if unused:
        raise usage_failure("--substitute %s: the scene names no such plugin" % unused[0])
    return ["%s replaced by %s, as asked" % (plugin, substitutes[plugin]) for plugin in sorted(used)]


def refuse_unknown(mi, source, state):
    kinds, manager = mi.ObjectType, mi.PluginManager.instance()
    replaced = (kinds.Scene, kinds.Film, kinds.Sampler, kinds.ReconstructionFilter, kinds.Integrator)
    # In a dict the plugin says what kind of object it is, so there an unknown one is of no kind.
    words = {kinds.Unknown: "plugin"}
    unknown = sorted({(words.get(node.type, node.type.name.lower()), node.props.plugin_name()) for node in state.nodes if node.type not in replaced
                      and manager.plugin_type(node.props.plugin_name()) == kinds.Unknown and not _is_own(mi, node)})
    if unknown:
        raise scene_failure("%s: Mitsuba 3 has no %s: choose what stands for it, --substitute %s=PLUGIN" % (
            source, ", no ".join("%s %s" % pair for pair in unknown), unknown[0][1]))


def _is_own(mi, node):
    """Whether the script of the scene has registered the plugin. Some variants lose of which kind it is: kinds that are forced are set."""
    try:
        made = mi.PluginManager.instance().create_object(mi.Properties(node.props.plugin_name()))
    except Exception as error:  # of a plugin that needs properties, too
        return not str(error).endswith("not found!")
    for kind in ("Integrator", "Sensor", "Film", "Sampler", "Medium"):
        if isinstance(made, getattr(mi, kind)):
            node.type = getattr(mi.ObjectType, kind)
    return True


def refuse_without_camera(mi, source, state):
    if not _cameras(mi, state):
        raise scene_failure("%s: no sensor: add a camera to the scene" % source)
    if _recorded_sensor(mi, state).props.plugin_name() == "batch":
        raise scene_failure("%s: its sensor batch puts the pictures of several cameras into one: give the scene one of them" % source)


def refuse_without_radiance(mi, source, state, wishes):
    """An integrator of features alone: what it gives is no light."""
    alone = [node.props.plugin_name() for node in state.nodes if node.type == mi.ObjectType.Integrator
             and node.props.plugin_name() in AROUND_ANOTHER and not _has_child(state, node, mi.ObjectType.Integrator)]
    if wishes.integrator in AROUND_ANOTHER:
        alone.append(wishes.integrator)
    if alone:
        raise scene_failure("%s: integrator %s has no integrator inside that gives radiance: choose one with --integrator path" % (
            source, alone[0]))


def force(mi, state, wishes):
    kind, changes = mi.ObjectType, []
    film, recorded = _film_size(mi, state), _children(state, _recorded_sensor(mi, state), kind.Film)
    size = wishes.size or film or DEFAULT_FILM
    if film and abs(size[0] * film[1] - size[1] * film[0]) > max(film):
        changes.append("%dx%d has another aspect than the film's %dx%d: the picture shows more or less of the scene" % (*size, *film))
    integrators = [node for node in state.nodes if node.type == kind.Integrator]
    sensors = len(_cameras(mi, state))
    if sensors > 1:
        changes.append("the scene has %d sensors: only the first is recorded" % sensors)
    for node in state.nodes:
        if node.type == kind.Film:
            changes += _crop(node) if node in recorded else []
            for key in [key for key in node.props.keys() if key != "rfilter"]:
                del node.props[key]
            node.props.set_plugin_name("hdrfilm")
            node.props["width"], node.props["height"] = size
            if "rfilter" not in node.props:
                node.props["rfilter"] = mi.load_dict({"type": "box"})
        elif node.type == kind.ReconstructionFilter:
            _replace(node, "box")
        elif node.type == kind.Sampler:
            _replace(node, "independent")
        elif node.type == kind.Sensor:
            changes += _rigid(mi, node)
            if not _has_child(state, node, kind.Film):
                node.props["film"] = mi.load_dict({"type": "hdrfilm", "width": size[0], "height": size[1], "rfilter": {"type": "box"}})
    if integrators:
        direct = _force_integrator(mi, integrators, wishes)
        return Forced(size, direct, any(node.props.get("hide_emitters", False) for node in integrators), changes)
    chosen = wishes.integrator or ("volpath" if any(node.type == kind.Medium for node in state.nodes) else "path")
    if not wishes.integrator:
        changes.append("the scene has no integrator: %s is used" % chosen)
    depth = {} if wishes.max_depth is None else {"max_depth": wishes.max_depth}
    state.root.props["integrator"] = mi.load_dict({"type": chosen, **depth})
    return Forced(size, _direct_of(depth) if chosen == "path" else None, False, changes)


def _film_size(mi, state):
    for node in _children(state, _recorded_sensor(mi, state), mi.ObjectType.Film):
        return int(node.props.get("width", DEFAULT_FILM[0])), int(node.props.get("height", DEFAULT_FILM[1]))
    return None


def _crop(node):
    """A line when the film shows a part of its picture."""
    width, height = (node.props.get(name, size) for name, size in zip(("width", "height"), DEFAULT_FILM))
    part = node.props.get("crop_width", width), node.props.get("crop_height", height)
    return [] if part == (width, height) else ["the film's crop window of %dx%d is not kept: the whole picture of %dx%d is recorded" % (
        *part, width, height)]


def _force_integrator(mi, nodes, wishes):
    direct = None
    for node in nodes:
        if wishes.integrator:
            _replace(node, wishes.integrator)
        if wishes.max_depth is not None:
            node.props["max_depth"] = wishes.max_depth
        if node.props.plugin_name() == "path":
            direct = _direct_of({key: node.props[key] for key in node.props.keys() if key in ("max_depth", "rr_depth", "hide_emitters")})
    return direct


def _direct_of(path):
    """Of a path integrator: no longer than its own paths."""
    return {**path, "type": "path", "max_depth": path["max_depth"] if path.get("max_depth", -1) in (0, 1) else 2}


def _rigid(mi, node):
    """A camera whose matrix scales is refused by Mitsuba 3: its rotation is kept (polar decomposition). The scale of an
    orthographic camera is the width of its picture."""
    if node.props.plugin_name() == "orthographic" or "to_world" not in node.props or not hasattr(node.props["to_world"], "matrix"):
        return []
    matrix = np.array(node.props["to_world"].matrix, np.float64).reshape(4, 4)
    factors = np.linalg.svd(matrix[:3, :3], compute_uv=False)
    if np.abs(factors - 1).max() < SCALE_TOLERANCE:
        return []
    left, _, right = np.linalg.svd(matrix[:3, :3])
    matrix[:3, :3] = left @ right
    node.props["to_world"] = mi.ScalarTransform4f(matrix.tolist())
    return ["the camera's matrix scales by %.3g to %.3g: only its rotation is used" % (factors.min(), factors.max())]


def depth_unit(sensor):
    """Length in the world of a step of 1 along the camera's z: 1, but for an orthographic camera that scales."""
    length = float(np.linalg.norm(np.array(sensor.world_transform().matrix, np.float64).reshape(4, 4)[:3, 2]))
    return length if abs(length - 1) > SCALE_TOLERANCE else 1.0


def _has_child(state, node, kind):
    return bool(_children(state, node, kind))


def _children(state, node, kind):
    """Nodes of this kind that hang on the node. Nothing but references is read: what is read, Mitsuba takes for known."""
    values = [node.props[key] for key in node.props.keys() if node.props.type(key).name == "ResolvedReference"]
    return [state.nodes[value.index()] for value in values if state.nodes[value.index()].type == kind]


def _cameras(mi, state):
    """Sensors of the scene itself, as Mitsuba counts them: not the light meters that hang on shapes."""
    return _children(state, state.root, mi.ObjectType.Sensor)


def _recorded_sensor(mi, state):
    return _cameras(mi, state)[0]


def _replace(node, plugin):
    for key in list(node.props.keys()):
        del node.props[key]
    node.props.set_plugin_name(plugin)
