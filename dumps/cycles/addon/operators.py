"""What the buttons do. Without a window (`blender -b`) Record and Resume return when the recording is
done, unless `wait` is off; with one they return at once and a timer looks after it."""
import bpy

from . import recording, viewing


class _Start:
    bl_options = {"REGISTER"}
    wait: bpy.props.BoolProperty(default=True, options={"SKIP_SAVE", "HIDDEN"},
                                 description="Return when the recording is done")

    def execute(self, context):
        error = recording.start(context, self.resume)
        if error:
            self.report({"ERROR"}, error)
            return {"CANCELLED"}
        if not self.wait:
            return {"FINISHED"}
        now = recording.recording
        now.tick(wait=True)
        self.report({"INFO" if now.state == "done" else "ERROR"}, now.message)
        return {"FINISHED"} if now.state == "done" else {"CANCELLED"}

    def invoke(self, context, event):
        self.wait = False
        state = self.execute(context)
        if "FINISHED" in state and not bpy.app.timers.is_registered(_look):
            bpy.app.timers.register(_look, first_interval=0.5)
        return state


class Record(_Start, bpy.types.Operator):
    bl_idname = "render.spool_record"
    bl_label = "Record"
    bl_description = "Record every sample of this scene as it is now, in the background"
    resume = False


class Resume(_Start, bpy.types.Operator):
    bl_idname = "render.spool_resume"
    bl_label = "Resume"
    bl_description = "Go on with the recording in this file, with the scene as it was when it began"
    resume = True


class Cancel(bpy.types.Operator):
    bl_idname = "render.spool_cancel"
    bl_label = "Cancel"
    bl_description = "Stop the recording; Resume goes on where it stopped"

    @classmethod
    def poll(cls, context):
        return recording.recording is not None and recording.recording.running()

    def execute(self, context):
        recording.cancel()
        self.report({"INFO"}, recording.recording.message)
        return {"FINISHED"}


class Estimate(bpy.types.Operator):
    bl_idname = "render.spool_estimate"
    bl_label = "Estimate"
    bl_description = "Say what the scene needs, and how many bytes and minutes the recording would take"
    lines = []

    def execute(self, context):
        Estimate.lines, error = recording.estimate(context)
        if error:
            self.report({"ERROR"}, error)
            return {"CANCELLED"}
        self.report({"INFO"}, "; ".join(Estimate.lines))
        return {"FINISHED"}


class View(bpy.types.Operator):
    bl_idname = "render.spool_view"
    bl_label = "Open in the browser"
    bl_description = "Look at what was recorded: any budget, any pixel and its samples, on a page of this machine"

    @classmethod
    def poll(cls, context):
        return recording.dump() is not None

    def execute(self, context):
        error = viewing.open_page(*recording.dump())
        if error:
            self.report({"ERROR"}, error)
            return {"CANCELLED"}
        return {"FINISHED"}


def _look():
    """Timer: draws the panels again; None ends it."""
    running = recording.recording is not None and recording.recording.tick()
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "PROPERTIES":
                area.tag_redraw()
    return 0.5 if running else None
