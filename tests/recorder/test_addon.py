"""The add-on as one installs it: the zip file into a Blender of its own, then its operators without a window."""
import os
import subprocess
import sys
import zipfile

import pytest
from conftest import ROOT, Folder

SPOOL = os.environ.get("SPOOL", str(ROOT / "build" / "release" / "spool"))
START = """
import os, sys, time, bpy
%(install)s
import importlib
name = next(m for m in bpy.context.preferences.addons.keys() if m.endswith('spool_recorder'))
addon = sys.modules[name]
recording = sys.modules[name + '.recording']
s = bpy.context.scene
assert not addon.Panel.poll(bpy.context)
s.render.engine = 'CYCLES'
assert addon.Panel.poll(bpy.context)
s.render.resolution_x, s.render.resolution_y, s.render.resolution_percentage = 16, 12, 100
r = s.spool_recording
r.samples, r.reference, r.mode, r.channels = 3, 4, 'shift', {'depth'}
tmp = %(tmp)r
def spool(path):
    bpy.context.preferences.addons[name].preferences.spool = path
def refused(operator, text, **options):
    try:
        state = operator(**options)
    except RuntimeError as error:
        assert text in str(error), error
    else:
        raise SystemExit('not refused: %%s' %% state)
"""
INSTALL = """
bpy.ops.preferences.addon_install(filepath=%r)
bpy.ops.preferences.addon_enable(module='spool_recorder')
"""
EXTENSION = """
bpy.ops.extensions.package_install_files(filepath=%r, repo='user_default', enable_on_install=True)
"""


@pytest.fixture(scope="module")
def archive(tmp_path_factory):
    path = tmp_path_factory.mktemp("addon") / "spool_recorder.zip"
    subprocess.run([sys.executable, ROOT / "dumps" / "cycles" / "addon_zip.py", "-o", path], check=True)
    return path


def run(archive, tmp_path, script):
    """BLENDER may name a Python that has the module bpy."""
    blender = os.environ.get("BLENDER", "blender")
    module = "python" in os.path.basename(blender)
    text = START % {"install": (EXTENSION if module else INSTALL) % str(archive), "tmp": str(tmp_path)} + script
    command = [blender, "-c", text] if module else \
        [blender, "-b", "--factory-startup", "--python-exit-code", "3", "--python-expr", text]
    (tmp_path / "user").mkdir()
    done = subprocess.run(command, capture_output=True, text=True, timeout=280, env={
        **os.environ, "BLENDER_USER_RESOURCES": str(tmp_path / "user"), "BLENDER_USER_SCRIPTS": str(tmp_path / "user")})
    assert done.returncode == 0, done.stdout + done.stderr
    assert "THE END" in done.stdout, done.stdout + done.stderr


def test_the_zip_file_holds_the_recorder_and_is_the_same_twice(archive, tmp_path):
    names = zipfile.ZipFile(archive).namelist()
    assert {"spool_recorder/__init__.py", "spool_recorder/blender_manifest.toml",
            "spool_recorder/recorder/dumps/cycles/record.py", "spool_recorder/recorder/dumps/recording/failure.py",
            "spool_recorder/LICENSE", "spool_recorder/spool_recorder.spdx.json"} <= set(names)
    again = tmp_path / "again.zip"
    subprocess.run([sys.executable, ROOT / "dumps" / "cycles" / "addon_zip.py", "-o", again], check=True)
    assert again.read_bytes() == archive.read_bytes()


def test_the_buttons_record_and_pack_and_refuse(archive, tmp_path):
    run(archive, tmp_path, """
r.file = '//scene.spool'
refused(bpy.ops.render.spool_record, 'save the file first')
r.file = os.path.join(tmp, 'scene.spool')
refused(bpy.ops.render.spool_resume, 'no recording to go on with')
assert not bpy.ops.render.spool_cancel.poll()
r.mode, r.channels = 'iid', {'position'}
refused(bpy.ops.render.spool_record, "channel 'position'")
assert recording.recording.state == 'failed'
import shutil; shutil.rmtree(r.file + '.passes')
r.mode, r.channels = 'shift', {'depth'}
assert bpy.ops.render.spool_estimate() == {'FINISHED'}
assert any('depth of field: no' in line for line in addon.Estimate.lines), addon.Estimate.lines
assert any(line.startswith('estimate') for line in addon.Estimate.lines)
camera, s.camera = s.camera, None
refused(bpy.ops.render.spool_record, 'no camera')
shutil.rmtree(r.file + '.passes')
s.camera = camera
spool(%r)
assert bpy.ops.render.spool_record() == {'FINISHED'}
assert os.path.exists(r.file) and not os.path.exists(r.file + '.passes')
assert recording.recording.message == 'recorded and checked: ' + r.file, recording.recording.message

# The page: served, and reached through a file that only its owner reads.
import re, stat, urllib.request, webbrowser
asked = []
webbrowser.open = lambda url: asked.append(url) or True
assert bpy.ops.render.spool_view.poll() and bpy.ops.render.spool_view() == {'FINISHED'}
path = asked[0].removeprefix('file://')
assert stat.S_IMODE(os.stat(path).st_mode) == 0o600
url = re.search('url=(.*?)"', open(path).read()).group(1).replace('&amp;', '&')
assert url.startswith('http://127.0.0.1:') and b'<html' in urllib.request.urlopen(url).read()
first = sys.modules[name + '.viewing'].server
assert bpy.ops.render.spool_view() == {'FINISHED'} and first.poll() is not None
server = sys.modules[name + '.viewing'].server
spool('/no/such/program')
kept = recording.recording.file
recording.recording.file = os.path.join(tmp, 'gone.spool')
assert not bpy.ops.render.spool_view.poll()
recording.recording.file = tmp                       # a folder that holds no results
refused(bpy.ops.render.spool_view, 'spool: ')
recording.recording.file = kept
assert bpy.ops.render.spool_view() == {'FINISHED'}
server = sys.modules[name + '.viewing'].server

refused(bpy.ops.render.spool_record, 'exists: choose another file')
bpy.ops.preferences.addon_disable(module=name)
assert not hasattr(s, 'spool_recording') and server.poll() is not None
print('THE END')
""" % SPOOL)
    told = subprocess.run([SPOOL, "info", tmp_path / "scene.spool", "--all"], capture_output=True, text=True).stdout
    assert "16 x 12" in told and "3 per pixel" in told and "depth (Z)" in told


def test_a_file_that_is_not_whole_is_not_called_recorded_and_pip_s_program_is_found(archive, tmp_path):
    scripts = tmp_path / "environment/bin"
    scripts.mkdir(parents=True)
    program = scripts / "spool-of-pip"
    program.write_text(f"""#!/bin/sh
{SPOOL} "$@" || exit $?
if [ "$1" = pack ]; then printf x | dd of={tmp_path}/bad.spool bs=1 seek=2000 conv=notrunc 2>/dev/null; fi
""")
    program.chmod(0o755)
    run(archive, tmp_path, """
os.environ['VIRTUAL_ENV'] = os.path.join(tmp, 'environment')
assert recording.find_program('spool-of-pip') == os.path.join(tmp, 'environment', 'bin', 'spool-of-pip')
assert recording.find_program('/no/such/program') is None
spool('spool-of-pip')
r.file = os.path.join(tmp, 'bad.spool')
refused(bpy.ops.render.spool_record, 'bad.spool')
assert recording.recording.state == 'failed', recording.recording.message
assert os.path.isdir(r.file + '.passes')
print('THE END')
""")


def test_a_cancelled_recording_goes_on_and_gives_the_same_bits(archive, tmp_path):
    run(archive, tmp_path, """
spool('/no/such/program')
r.file, r.samples = os.path.join(tmp, 'cut'), 300
assert bpy.ops.render.spool_record(wait=False) == {'FINISHED'}
refused(bpy.ops.render.spool_record, 'under way')
now = recording.recording
while now.finished() < 3 and now.tick():
    time.sleep(0.01)
assert bpy.ops.render.spool_cancel.poll() and bpy.ops.render.spool_cancel() == {'FINISHED'}
assert now.state == 'cancelled' and 3 <= now.finished() < 304, (now.state, now.message)
refused(bpy.ops.render.spool_record, 'or Resume')
assert bpy.ops.render.spool_resume() == {'FINISHED'}
assert recording.recording.finished() == 304 and 'spool pack' in recording.recording.message
r.file = os.path.join(tmp, 'whole')
assert bpy.ops.render.spool_record() == {'FINISHED'}
print('THE END')
""")
    cut, whole = Folder(tmp_path / "cut.passes"), Folder(tmp_path / "whole.passes")
    assert len(cut.files()) == 304 and cut.files() == whole.files()
