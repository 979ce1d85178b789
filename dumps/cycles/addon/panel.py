"""The panel, and where the program `spool` is found."""
import time

import bpy

from . import recording
from .operators import Cancel, Estimate, Record, Resume, View


class Preferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    spool: bpy.props.StringProperty(
        name="spool", subtype="FILE_PATH", default="spool",
        description="The program that packs passes into a recording and checks it: a path, or a name that is looked for on "
                    "the path and where pip puts programs; without it the folder of passes is left")

    def draw(self, context):
        self.layout.prop(self, "spool")


class Panel(bpy.types.Panel):
    bl_idname = "RENDER_PT_spool_recording"
    bl_label = "Sample recording"
    bl_space_type, bl_region_type, bl_context = "PROPERTIES", "WINDOW", "render"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return context.scene.render.engine == "CYCLES"

    def draw(self, context):
        layout, settings = self.layout, context.scene.spool_recording
        layout.use_property_split = True
        layout.use_property_decorate = False
        now = recording.recording
        running = now is not None and now.running()
        choices = layout.column()
        choices.enabled = not running
        for name in ("file", "samples", "reference", "mode", "seed"):
            choices.prop(settings, name)
        choices.column(align=True).prop(settings, "channels")
        if running:
            _draw_progress(layout, now)
            layout.operator(Cancel.bl_idname, icon="CANCEL")
        else:
            row = layout.row(align=True)
            row.operator(Record.bl_idname, icon="REC")
            row.operator(Resume.bl_idname, icon="PLAY")
            row.operator(Estimate.bl_idname, icon="TIME")
            if now is not None:
                layout.label(text=now.message, icon="ERROR" if now.state == "failed" else "INFO")
            if recording.dump():
                layout.operator(View.bl_idname, icon="URL")
            for line in Estimate.lines:
                layout.label(text=line)


def _draw_progress(layout, now):
    done = now.finished()
    text = "%d of %d" % (done, now.total) if now.state == "recording" else now.state
    if 0 < done < now.total:
        text += ", %d s" % (time.monotonic() - now.begin)
    if hasattr(layout, "progress"):        # 4.0
        layout.progress(factor=done / max(1, now.total), text=text)
    else:
        filled = 20 * done // max(1, now.total)
        layout.label(text="%s%s  %s" % ("\u25a0" * filled, "\u25a1" * (20 - filled), text), icon="RENDER_STILL")
