"""A panel in the render properties that records the open scene with the recorder next door.

The recording runs in a Blender of its own, on a copy of the scene as it is now, so that one can go on
working. To install, link this folder into Blender's add-on folder as `spool_recorder`, or install it
as a zip file and set the path of record.py in the preferences.
"""
import os
import subprocess
import time

import bpy

bl_info = {
    "name": "Spool recorder", "blender": (3, 4, 0), "category": "Render", "version": (0, 1, 0),
    "description": "Record every sample of a Cycles rendering",
    "location": "Properties > Render > Sample recording",
}

HERE = os.path.dirname(os.path.realpath(__file__))


class Preferences(bpy.types.AddonPreferences):
    bl_idname = __name__

    record: bpy.props.StringProperty(
        name="record.py", subtype="FILE_PATH", default=os.path.join(os.path.dirname(HERE), "record.py"))

    def draw(self, context):
        self.layout.prop(self, "record")


class Settings(bpy.types.PropertyGroup):
    folder: bpy.props.StringProperty(name="Folder", subtype="DIR_PATH", default="//recording.passes",
                                     description="Folder of the passes; an interrupted recording is continued")
    resume: bpy.props.BoolProperty(name="Continue", default=False,
                                   description="Continue the recording in this folder, with the scene as it was when "
                                               "that recording began")
    samples: bpy.props.IntProperty(name="Samples", default=64, min=1, max=65536)
    reference: bpy.props.IntProperty(name="Reference", default=4096, min=0, max=2**24,
                                     description="Samples per pixel of an independent reference; 0: none")
    seed: bpy.props.IntProperty(name="Seed", default=1, min=0)
    mode: bpy.props.EnumProperty(name="Mode", default="iid", items=(
        ("iid", "Independent", "A new seed for each sample"),
        ("shift", "Known position", "A new seed for each sample; all pixels share one known film position"),
        ("sequence", "Sequence", "Consecutive samples of one low-discrepancy sequence")))
    channels: bpy.props.StringProperty(name="Channels", default="radiance,albedo,normal,depth")


def record_path(context):
    addon = context.preferences.addons.get(__name__)
    return addon.preferences.record if addon else os.path.join(os.path.dirname(HERE), "record.py")


def command_line(context, blend):
    settings = context.scene.spool_recording
    return [bpy.app.binary_path, "-b", "--factory-startup", blend, "-P", record_path(context),
            "--python-exit-code", "3", "--", "--mode", settings.mode, "--samples", str(settings.samples),
            "--reference", str(settings.reference), "--seed", str(settings.seed),
            "--channels", settings.channels, "-o", bpy.path.abspath(settings.folder)]


def count_finished(folder):
    try:
        with open(os.path.join(folder, "passes.jsonl"), "rb") as stream:
            return stream.read().count(b"\n")
    except OSError:
        return 0


class Record(bpy.types.Operator):
    bl_idname = "render.spool_record"
    bl_label = "Record samples"
    bl_description = "Record every sample of this scene; Escape stops, and the next run continues"

    def start(self, context):
        settings = context.scene.spool_recording
        if settings.folder.startswith("//") and not bpy.data.filepath:
            return "save the file first, or choose a folder that does not begin with //"
        if not os.path.isfile(record_path(context)):
            return "%s: not found: set it in the preferences of the add-on" % record_path(context)
        self.folder = bpy.path.abspath(settings.folder)
        self.blend = os.path.join(self.folder, "scene.blend")
        if os.path.exists(self.blend) != settings.resume:
            return "%s: %s" % (self.folder, "no recording to continue" if settings.resume else
                               "holds a recording: choose another folder, or Continue")
        if not settings.resume:
            os.makedirs(self.folder, exist_ok=True)
            bpy.ops.wm.save_as_mainfile(filepath=self.blend, copy=True)
        self.process = subprocess.Popen(command_line(context, self.blend), stdout=subprocess.DEVNULL,
                                        stderr=subprocess.PIPE, text=True)
        return ""

    def finish(self):
        lines = [line for line in self.process.stderr.read().splitlines() if line.startswith("record:")]
        if self.process.wait() == 0:
            self.report({"INFO"}, "recorded in %s" % self.folder)
            return {"FINISHED"}
        self.report({"ERROR"}, lines[-1] if lines else "the recorder ended with %d" % self.process.returncode)
        return {"CANCELLED"}

    def execute(self, context):
        error = self.start(context)
        if error:
            self.report({"ERROR"}, error)
            return {"CANCELLED"}
        return self.finish()

    def invoke(self, context, event):
        error = self.start(context)
        if error:
            self.report({"ERROR"}, error)
            return {"CANCELLED"}
        manager = context.window_manager
        self.timer, self.begin = manager.event_timer_add(0.5, window=context.window), time.monotonic()
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC":
            self.process.terminate()
        elif event.type == "TIMER":
            context.workspace.status_text_set("Recording: %d passes and batches, %d s; Escape stops" % (
                count_finished(self.folder), time.monotonic() - self.begin))
        if self.process.poll() is None:
            return {"PASS_THROUGH"}
        context.window_manager.event_timer_remove(self.timer)
        context.workspace.status_text_set(None)
        return self.finish()


class Panel(bpy.types.Panel):
    bl_idname = "RENDER_PT_spool_recording"
    bl_label = "Sample recording"
    bl_space_type, bl_region_type, bl_context = "PROPERTIES", "WINDOW", "render"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return context.scene.render.engine == "CYCLES"

    def draw(self, context):
        self.layout.use_property_split = True
        for name in ("folder", "resume", "samples", "reference", "mode", "seed", "channels"):
            self.layout.prop(context.scene.spool_recording, name)
        self.layout.operator(Record.bl_idname, icon="RENDER_STILL")


CLASSES = (Preferences, Settings, Record, Panel)


def register():
    for kind in CLASSES:
        bpy.utils.register_class(kind)
    bpy.types.Scene.spool_recording = bpy.props.PointerProperty(type=Settings)


def unregister():
    del bpy.types.Scene.spool_recording
    for kind in reversed(CLASSES):
        bpy.utils.unregister_class(kind)
