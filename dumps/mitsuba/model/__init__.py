"""The words in which dumps/scenes is written, spoken for Mitsuba: the same script gives the same scene.

Only what `caustic` needs: a scene that uses more is refused by name. Meshes, normals, camera and sky are
Blender's to rounding; glass is a smooth dielectric as there, other surfaces are Mitsuba's `principled`, whose
highlights differ a little from Cycles' node of that name.
"""
import importlib.util
import os
import sys
import types

from failure import usage_failure

SCENES = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..", "scenes"))


def scene_names():
    return sorted(f[:-3] for f in os.listdir(SCENES) if f.endswith(".py") and f[0] != "_")


def scene_sources(name):
    """The files that decide what the scene is."""
    here = os.path.dirname(os.path.abspath(__file__))
    return [os.path.join(SCENES, name + ".py"), os.path.join(SCENES, "model", "shapes.py")] + [
        os.path.join(here, f) for f in sorted(os.listdir(here)) if f.endswith(".py")]


def build(name, folder):
    """Dict of the scene; meshes become files in `folder`."""
    from . import stage
    stage.open_folder(folder)
    for part in ("materials", "shapes", "stage"):       # `from model.shapes import ...` means these
        importlib.import_module(__name__ + "." + part)
    try:
        load("scene_" + name, os.path.join(SCENES, name + ".py")).build()
    except (ImportError, KeyError) as error:
        raise usage_failure("scene '%s' needs more than Mitsuba is taught here (%s): record it with "
                            "dumps/record.sh" % (name, error))
    return stage.scene


def load(name, path):
    spec = importlib.util.spec_from_file_location(name, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def blender_shapes():
    """The outlines that Blender's model uses. Its module asks for Blender only when it makes objects."""
    missing = "bpy" not in sys.modules
    if missing:
        sys.modules["bpy"] = types.ModuleType("bpy")
    try:
        return load("blender_shapes", os.path.join(SCENES, "model", "shapes.py"))
    finally:
        if missing:
            del sys.modules["bpy"]
