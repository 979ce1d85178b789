"""Loads a Mitsuba scene and makes one camera sample per lane mean one sample per pixel.

Film size, box filter, independent sampler and integrator are forced before the scene is instantiated:
changing the film later leaves the field of view wrong when the aspect changes.
"""
import hashlib
import importlib.util
import os
import tempfile

import model
from failure import Failure, scene_failure, usage_failure


class Recordable:
    """scene, sensor, integrator, and the integrator of the direct part (None where it cannot tell)."""

    def __init__(self, scene, sensor, integrator, direct, name, digest):
        self.scene, self.sensor, self.integrator, self.direct = scene, sensor, integrator, direct
        self.name, self.digest = name, digest
        self.has_lens = bool(sensor.needs_aperture_sample())
        self.shutter_open = float(sensor.shutter_open())
        self.shutter_time = float(sensor.shutter_open_time())
        self.shapes = [shape.id() for shape in scene.shapes()]
        self.has_volumes = sensor.get_medium() is not None or any(
            shape.interior_medium() is not None or shape.exterior_medium() is not None for shape in scene.shapes())


def load_scene(mi, source, size=None, integrator=None, defines=None):
    """source: an .xml file, a .py file with scene(mi) -> dict, `cornell-box`, or a name of dumps/scenes."""
    config = mi.parser.ParserConfig(mi.variant())
    config.merge_meshes = False  # merged meshes lose their shape index
    config.unused_properties = config.unused_parameters = mi.LogLevel.Debug
    try:
        with tempfile.TemporaryDirectory() as meshes:
            state, name, digest = _parse(mi, config, source, defines or {}, meshes)
            mi.parser.transform_all(config, state)
            if size is None:
                size = _film_size(mi, state)
            direct = _force(mi, state, size, integrator)
            scene = mi.parser.instantiate(config, state)
    except Failure:
        raise
    except Exception as error:  # Mitsuba raises RuntimeError and others for whatever is wrong in a scene
        raise scene_failure("%s: Mitsuba cannot load it (%s)" % (source, _one_line(error)))
    scene = scene[0] if isinstance(scene, (list, tuple)) else scene
    if not scene.sensors():
        raise scene_failure("%s: no sensor: add a camera to the scene" % source)
    integrator = scene.integrator()
    if not isinstance(integrator, mi.SamplingIntegrator):
        raise scene_failure("%s: integrator %s splats into the film and has no samples of a pixel: choose "
                            "another with --integrator path" % (source, type(integrator).__name__))
    return Recordable(scene, scene.sensors()[0], integrator,
                      mi.load_dict(direct) if direct else None, name, digest)


def _parse(mi, config, source, defines, meshes):
    if source == "cornell-box":
        return mi.parser.parse_dict(config, mi.cornell_box()), source, hashlib.sha256(b"cornell-box").hexdigest()
    if source in model.scene_names():
        digest = hashlib.sha256()
        for path in model.scene_sources(source):
            with open(path, "rb") as stream:
                digest.update(stream.read())
        return mi.parser.parse_dict(config, model.build(source, meshes)), source, digest.hexdigest()
    if not os.path.isfile(source):
        raise Failure(3, "%s: no such file: give an .xml scene, a .py scene, cornell-box or a scene of dumps/scenes"
                      % source)
    with open(source, "rb") as stream:
        digest = hashlib.sha256(stream.read()).hexdigest()
    mi.file_resolver().append(os.path.dirname(os.path.abspath(source)))
    if source.endswith(".py"):
        spec = importlib.util.spec_from_file_location("mitsuba_scene", source)
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        if not hasattr(module, "scene"):
            raise usage_failure("%s: has no function scene(mi) that returns a dict" % source)
        return mi.parser.parse_dict(config, module.scene(mi)), os.path.basename(source), digest
    return mi.parser.parse_file(config, source, **defines), os.path.basename(source), digest


def _film_size(mi, state):
    for node in state.nodes:
        if node.type == mi.ObjectType.Film:
            return int(node.props.get("width", 768)), int(node.props.get("height", 576))
    return 256, 256


def _force(mi, state, size, integrator):
    """Edits the parsed scene; returns the dict of the integrator that sees direct light only, or None."""
    kind, direct = mi.ObjectType, None
    for node in state.nodes:
        if node.type == kind.Film:
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
        elif node.type == kind.Integrator:
            if integrator:
                _replace(node, integrator["type"], {k: v for k, v in integrator.items() if k != "type"})
            if node.props.plugin_name() == "path":
                direct = {key: node.props[key] for key in node.props.keys() if key in ("rr_depth", "hide_emitters")}
                direct.update(type="path", max_depth=2)
    return direct


def _replace(node, plugin, properties=None):
    for key in list(node.props.keys()):
        del node.props[key]
    node.props.set_plugin_name(plugin)
    for key, value in (properties or {}).items():
        node.props[key] = value


def _one_line(error):
    return " ".join(str(error).split())[:300]
