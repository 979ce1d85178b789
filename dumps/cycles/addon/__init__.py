"""A panel in the render properties that records the open scene: choose, press Record, see how far it is,
cancel, resume.

The recording runs in a Blender of its own, on a copy of the scene as it is now, so that one can go on
working. `addon_zip.py` next to this folder makes the file that Blender installs; linked into Blender's
add-on folder as `spool_recorder`, this folder works as it stands.
"""
import bpy

from .operators import Cancel, Estimate, Record, Resume, View
from .panel import Panel, Preferences
from .settings import Settings

bl_info = {
    "name": "Spool recorder", "blender": (3, 4, 0), "category": "Render", "version": (0, 3, 0),
    "description": "Record every sample of a Cycles rendering",
    "location": "Properties > Render > Sample recording",
}

CLASSES = (Preferences, Settings, Record, Resume, Cancel, Estimate, View, Panel)


def register():
    for kind in CLASSES:
        bpy.utils.register_class(kind)
    bpy.types.Scene.spool_recording = bpy.props.PointerProperty(type=Settings)


def unregister():
    from . import recording, viewing
    recording.cancel()                     # what was recorded stays, Resume goes on
    viewing.close()
    del bpy.types.Scene.spool_recording
    for kind in reversed(CLASSES):
        bpy.utils.unregister_class(kind)
