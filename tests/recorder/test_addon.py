"""The add-on: registers, offers its panel, records the open scene by its button, and goes away again."""
import subprocess

from conftest import ROOT, Folder

SCRIPT = """
import sys, bpy
sys.path.insert(0, %(addons)r)
import addon
addon.register()
s = bpy.context.scene
assert not addon.Panel.poll(bpy.context)
s.render.engine = 'CYCLES'
assert addon.Panel.poll(bpy.context)
s.render.resolution_x, s.render.resolution_y, s.render.resolution_percentage = 16, 12, 100
r = s.spool_recording
r.samples, r.reference, r.mode, r.channels, r.folder = 3, 4, 'shift', 'radiance,depth', %(folder)r
def expect_refusal(text):
    try:
        bpy.ops.render.spool_record()
    except RuntimeError as error:
        assert text in str(error), error
    else:
        raise SystemExit('not refused')
r.resume = True
expect_refusal('no recording to continue')
r.resume = False
assert bpy.ops.render.spool_record() == {'FINISHED'}
expect_refusal('holds a recording')
r.resume = True
assert bpy.ops.render.spool_record() == {'FINISHED'}
r.channels = 'radiance,heat'
expect_refusal('heat')
r.folder = '//passes'
expect_refusal('save the file first')
addon.unregister()
assert not hasattr(s, 'spool_recording')
"""


def test_the_button_records_the_open_scene(tmp_path):
    folder = tmp_path / "passes"
    script = SCRIPT % {"addons": str(ROOT / "dumps" / "cycles"), "folder": str(folder)}
    done = subprocess.run(["blender", "-b", "--factory-startup", "--python-exit-code", "3", "--python-expr", script],
                          capture_output=True, text=True, timeout=280)
    assert done.returncode == 0, done.stdout + done.stderr
    recorded = Folder(folder)
    assert recorded.names == ["radiance.R", "radiance.G", "radiance.B", "depth.Z"]
    assert sum(e["kind"] == "pass" for e in recorded.entries) == 3
    assert sum(e["kind"] == "reference" for e in recorded.entries) == 4
