"""Loads a Mitsuba scene and makes one camera sample per lane mean one sample per pixel.

Film size, box filter, independent sampler and integrator are forced before the scene is instantiated:
changing the film later leaves the field of view wrong when the aspect changes. What Mitsuba drops on the
way is named: a medium that lost a property is an error, everything else a remark.
"""
import hashlib
import importlib.util
import os
import re
import sys
import tempfile
from collections import namedtuple

from dumps.mitsuba import old_format, parameters, scene_files
from dumps.mitsuba.losses import listen
from dumps.mitsuba.plugins import (
    depth_unit,
    force,
    refuse_unknown,
    refuse_without_camera,
    refuse_without_radiance,
    substitute,
)
from dumps.recording import failure
from dumps.recording.failure import Failure, scene_failure, usage_failure


def _words():
    """The package `model`: a scene's hash holds its text, in which files import each other and `failure` by bare names."""
    sys.modules["failure"] = failure
    sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
    return importlib.import_module("model")


model = _words()
# size: (width, height) or None: the film's. integrator, max_depth: None: the scene's. definitions: {name: value} of -D.
# substitutes: {plugin the scene names: plugin to use}. allow_losses: record although a medium loses a property.
# folders: where its files may lie, beside its own. digest: what the scene with its files must hash to, or None.
Wishes = namedtuple("Wishes", "size integrator max_depth definitions substitutes allow_losses folders digest",
                    defaults=(None, None, None, {}, {}, False, (), None))


class Recordable:
    """scene, sensor, integrator, the integrator of the direct part (None where there is none), whether lamps are hidden from the camera,
    and what was changed."""

    def __init__(self, scene, integrator, direct, hides_lamps, name, digest, changes):
        self.scene, self.sensor, self.integrator, self.direct, self.hides_lamps = scene, camera(scene), integrator, direct, hides_lamps
        self.name, self.digest, self.changes = name, digest, changes
        self.has_lens = bool(self.sensor.needs_aperture_sample())
        self.depth_unit = depth_unit(self.sensor)
        self.shutter_open = float(self.sensor.shutter_open())
        self.shutter_time = float(self.sensor.shutter_open_time())
        self.shapes = [shape.id() for shape in scene.shapes()]
        self.has_volumes = self.sensor.get_medium() is not None or any(
            shape.interior_medium() is not None or shape.exterior_medium() is not None for shape in scene.shapes())
        if self.has_volumes and integrator.class_name() in ("PathIntegrator", "DirectIntegrator"):
            changes.append("the scene has volumes, which its integrator does not see: --integrator volpath does")


def camera(scene):
    """The first sensor that is no light meter on a shape."""
    return next(sensor for sensor in scene.sensors() if sensor.get_shape() is None)


class Source:
    """A parsed scene. files: those of its XML, if it has any. lost: what rewriting an old one could not keep of its media."""

    def __init__(self, state, name, digest, files=(), changes=(), lost=()):
        self.state, self.name, self.digest, self.files = state, name, digest, list(files)
        self.changes, self.lost = list(changes), list(lost)


def load_scene(mi, source, wishes=Wishes()):
    """source: an .xml file, a .py file with scene(mi) -> dict, `cornell-box`, or a name of dumps/scenes."""
    config = mi.parser.ParserConfig(mi.variant())
    config.merge_meshes = False  # merged meshes lose their shape index
    config.unused_properties = config.unused_parameters = mi.LogLevel.Warn
    try:
        (found, scene, forced), heard = listen(mi, lambda: _instantiate(mi, config, source, wishes))
    except Failure:
        raise
    except Exception as error:  # Mitsuba raises RuntimeError and others for whatever is wrong in a scene
        undefined = re.search(r"undefined parameter: \$(\w+)", str(error))
        if undefined:
            raise usage_failure(parameters.missing_line(source, parameters.undefined(source, undefined[1], wishes.definitions)))
        remedy = ": choose another with --integrator path" if "instantiate integrator plugin" in str(error) else ""
        raise scene_failure("%s: Mitsuba cannot load it (%s)%s" % (source, _one_line(error), remedy))
    if heard.unused:
        raise usage_failure(parameters.unknown_line(source, heard.unused))
    _judge_losses(source, heard.losses, found, wishes.allow_losses)
    found.changes += ["Mitsuba: %s" % text for text in dict.fromkeys(heard.other)]
    integrator = scene.integrator()
    if not isinstance(integrator, mi.SamplingIntegrator):
        raise scene_failure("%s: integrator %s splats into the film and has no samples of a pixel: choose "
                            "another with --integrator path" % (source, integrator.class_name()))
    if isinstance(integrator, getattr(mi, "CppADIntegrator", ())):           # prb and its like: their sample() is another
        raise scene_failure("%s: integrator %s differentiates and traces samples in a way of its own: choose another with "
                            "--integrator path" % (source, type(integrator).__name__))
    return Recordable(scene, integrator, mi.load_dict(forced.direct) if forced.direct else None, forced.hides, found.name, found.digest,
                      found.changes)


def _instantiate(mi, config, source, wishes):
    """(Source, scene, what was forced)"""
    with tempfile.TemporaryDirectory() as meshes:
        found = _parse(mi, config, source, wishes, meshes)
        mi.parser.transform_all(config, found.state)
        found.changes += substitute(found.state, wishes.substitutes)
        if found.files:
            refuse_unknown(mi, source, found.state)
        refuse_without_camera(mi, source, found.state)
        if found.files:
            named = scene_files.named_files(mi, found.state)
            scene_files.require(source, named)
            found.digest = scene_files.digest(found.files + [path for _, path in named])
        if wishes.digest not in (None, found.digest):
            raise scene_failure("%s: another scene than the expected one: SHA-256 of its files is %s" % (source, found.digest))
        forced = force(mi, found.state, wishes)
        found.changes += forced.changes
        refuse_without_radiance(mi, source, found.state, wishes)
        scene = mi.parser.instantiate(config, found.state)
    scene = scene[0] if isinstance(scene, (list, tuple)) else scene
    size = tuple(int(v) for v in camera(scene).film().crop_size())
    if size != forced.size:
        raise scene_failure("%s: its film is %dx%d, not %dx%d: give the scene a <film>" % (source, *size, *forced.size))
    return found, scene, forced


def _parse(mi, config, source, wishes, meshes):
    if wishes.definitions and not source.endswith(".xml"):
        raise usage_failure("-D %s: only an .xml scene has parameters" % next(iter(wishes.definitions)))
    if source == "cornell-box":
        return Source(mi.parser.parse_dict(config, mi.cornell_box()), source, hashlib.sha256(b"cornell-box").hexdigest())
    if source in model.scene_names():
        state = mi.parser.parse_dict(config, model.build(source, meshes))
        return Source(state, source, scene_files.digest(model.scene_sources(source)))
    if not os.path.isfile(source):
        raise Failure(3, "%s: no such file: give an .xml scene, a .py scene, cornell-box or a scene of dumps/scenes"
                      % source)
    path = os.path.abspath(source)
    name = os.path.join(os.path.basename(os.path.dirname(path)), os.path.basename(path))  # most are called scene.xml
    for folder in (os.path.dirname(path), *map(os.path.abspath, wishes.folders)):
        mi.file_resolver().append(folder)
    if source.endswith(".py"):
        return Source(mi.parser.parse_dict(config, _python_scene(mi, source)), name, None, [path])
    if not old_format.is_old(path):
        state = mi.parser.parse_file(config, source, **wishes.definitions)
        return Source(state, name, None, map(str, state.files))
    new = old_format.rewrite(path, bool(wishes.integrator))
    state = mi.parser.parse_string(config, new.text, **wishes.definitions)
    return Source(state, name, None, new.files, new.changes, new.lost)


def _python_scene(mi, source):
    spec = importlib.util.spec_from_file_location("mitsuba_scene", source)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    if not hasattr(module, "scene"):
        raise usage_failure("%s: has no function scene(mi) that returns a dict" % source)
    found = module.scene(mi)
    _refuse_made(mi, source, found)
    return found


def _refuse_made(mi, source, description):
    """What a recording must change before it is made: it would be left out, and another be put in its place."""
    for key, value in description.items() if isinstance(description, dict) else ():
        if isinstance(value, (mi.Sensor, mi.Film, mi.Integrator)):
            raise scene_failure("%s: %s is an object of Mitsuba already: give its dict in its place" % (source, key))
        _refuse_made(mi, source, value)


def _judge_losses(source, losses, found, allowed):
    media = found.lost + [str(loss) for loss in losses if loss.of_a_medium]
    if media and not allowed:
        raise scene_failure("%s: a medium would be recorded as something else (%s): mend the scene, or give --allow-losses" %
                            (source, "; ".join(media)))
    found.changes += ["lost: %s" % text for text in dict.fromkeys(media + [str(loss) for loss in losses if not loss.of_a_medium])]


def _one_line(error):
    return " ".join(str(error).split())[:300]
