"""Takes a picture of the add-on's panel while it records, and of its answer when the recording is cancelled.

    xvfb-run -a -s "-screen 0 900x700x24" blender --factory-startup --window-geometry 0 0 900 700 \
        -P tests/recorder/panel_picture.py -- spool_recorder.zip FOLDER

Needs xvfb and libgl1-mesa-dri where there is no screen. Set BLENDER_USER_SCRIPTS to keep the add-on out of your
own Blender. Not a test: somebody has to look at the pictures.
"""
import os
import sys

import bpy

ARCHIVE, FOLDER = (os.path.abspath(p) for p in sys.argv[sys.argv.index("--") + 1:])


def steps():
    """Each yield is a pause in seconds, so that Blender draws."""
    window = bpy.context.window_manager.windows[0]
    area = max(window.screen.areas, key=lambda a: a.width * a.height)
    area.type = "PROPERTIES"
    yield 0.5
    area.spaces.active.context = "RENDER"
    view = {"window": window, "area": area}

    def act(operator, *mode, **options):
        with bpy.context.temp_override(**view):
            operator(*mode, **options)

    act(bpy.ops.render.spool_estimate)
    yield 1.0
    act(bpy.ops.screen.screenshot, filepath=os.path.join(FOLDER, "panel_ready.png"))
    act(bpy.ops.render.spool_record, "INVOKE_DEFAULT")
    yield 15.0
    act(bpy.ops.screen.screenshot, filepath=os.path.join(FOLDER, "panel_recording.png"))
    act(bpy.ops.render.spool_cancel)
    yield 1.0
    act(bpy.ops.screen.screenshot, filepath=os.path.join(FOLDER, "panel_cancelled.png"))
    bpy.ops.wm.quit_blender()


def main():
    bpy.context.preferences.view.show_splash = False
    bpy.ops.preferences.addon_install(filepath=ARCHIVE)
    bpy.ops.preferences.addon_enable(module="spool_recorder")
    panel = sys.modules["spool_recorder"].Panel
    bpy.utils.unregister_class(panel)
    panel.bl_options = set()               # open
    for other in list(bpy.types.Panel.__subclasses__()):
        if getattr(other, "bl_context", "") == "render" and other is not panel:
            try:
                bpy.utils.unregister_class(other)
            except RuntimeError:           # a base class
                continue
    bpy.utils.register_class(panel)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x = scene.render.resolution_y = 256
    settings = scene.spool_recording
    settings.file, settings.samples, settings.reference = os.path.join(FOLDER, "cube.spool"), 256, 1024
    os.makedirs(FOLDER, exist_ok=True)
    script = steps()
    bpy.app.timers.register(lambda: next(script, None), first_interval=3.0)


main()
