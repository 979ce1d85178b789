"""The recording under way, at most one: a Blender that records, then the program that packs and checks.

`recording` is None or the Recording that was started last. All calls return at once, `tick` excepted
when it is asked to wait.
"""
import importlib.util
import os
import shutil
import subprocess
import sys
import sysconfig
import time

import bpy

from .settings import channel_list

HERE = os.path.dirname(os.path.realpath(__file__))
recording = None


class Recording:
    """state: `recording`, `packing`, `checking`, then `done`, `cancelled` or `failed`; message: one line."""

    def __init__(self, file, folder, command, pack, total):
        self.file, self.folder, self.pack, self.total = file, folder, pack, total
        self.state, self.message, self.begin = "recording", "", time.monotonic()
        self._start(command)

    def running(self):
        return self.state in ("recording", "packing", "checking")

    def finished(self):
        """Passes and batches that are on disk."""
        try:
            with open(os.path.join(self.folder, "passes.jsonl"), "rb") as stream:
                return min(self.total, stream.read().count(b"\n"))
        except OSError:
            return 0

    def tick(self, wait=False):
        while self.running() and (wait or self.process.poll() is not None):
            self._ended(self.process.wait())
        return self.running()

    def cancel(self):
        if not self.running():
            return
        self.process.terminate()           # the recorder ends after the pass at work
        try:
            self.process.wait(10)
        except subprocess.TimeoutExpired:
            self.process.kill()            # at any moment: what is on disk is whole
            self.process.wait()
        if self.state in ("packing", "checking") and os.path.exists(self.file):
            shutil.rmtree(self.folder, ignore_errors=True)
            self.state, self.message = "done", "recorded, not checked: %s" % self.file
            return
        self.state, self.message = "cancelled", "cancelled with %d of %d: Resume goes on" % (
            self.finished(), self.total)

    def _start(self, command):
        with open(os.path.join(self.folder, "recorder.log"), "wb") as log:
            self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                            stderr=log)

    def _ended(self, code):
        if code != 0:
            self.state, self.message = "failed", self._last_line() or "the recorder ended with %d" % code
        elif self.state == "recording" and self.pack:
            self.state = "packing"
            self._start(self.pack)
        elif self.state == "packing":
            self.state = "checking"        # every checksum of the file that is on the disk now
            self._start([self.pack[0], "check", "-q", self.file])
        elif self.state == "checking":
            shutil.rmtree(self.folder, ignore_errors=True)
            self.state, self.message = "done", "recorded and checked: %s" % self.file
        else:
            self.state = "done"
            self.message = "recorded in %s; spool pack makes it a recording (set the program in the preferences, or install its wheel: docs/python.md)" \
                % self.folder

    def _last_line(self):
        """What the recorder or the packer said it died of."""
        with open(os.path.join(self.folder, "recorder.log"), errors="replace") as stream:
            lines = [line.strip() for line in stream if line.startswith(("record:", "spool")) or
                     self.state == "packing"]
        return lines[-1] if lines else ""


def start(context, resume):
    """Starts a recording of the open scene, or goes on with the one in its folder. Returns an error."""
    global recording
    settings = context.scene.spool_recording
    if recording and recording.tick():
        return "a recording is under way: cancel it first"
    if settings.file.startswith("//") and not bpy.data.filepath:
        return "save the file first, or choose a file that does not begin with //"
    if not os.path.isfile(record_path()):
        return "%s: not found: install the add-on again" % record_path()
    file = bpy.path.abspath(settings.file)
    folder = file + ".passes"
    blend = os.path.join(folder, "scene.blend")
    if resume and not os.path.exists(blend):
        return "%s: no recording to go on with: press Record" % folder
    if not resume and (os.path.exists(blend) or os.path.exists(file)):
        return "%s exists: choose another file%s" % (
            blend if os.path.exists(blend) else file, ", or Resume" if os.path.exists(blend) else "")
    try:
        os.makedirs(folder, exist_ok=True)
        if not resume:
            bpy.ops.wm.save_as_mainfile(filepath=blend, copy=True)
        batches = batches_of(settings.reference)
        recording = Recording(file, folder, command_line(settings, blend, ["-o", folder]),
                              pack_command(context, folder, file), settings.samples + batches)
    except (OSError, RuntimeError) as error:
        return " ".join(str(error).split())
    return ""


def dump():
    """(program, file) of the recording that was made last, None while there is none."""
    if recording is None or recording.state != "done" or not recording.pack or not os.path.exists(recording.file):
        return None
    return recording.pack[0], recording.file


def cancel():
    if recording:
        recording.cancel()


def estimate(context):
    """What the scene needs and what its recording would cost: (lines, error)."""
    settings = context.scene.spool_recording
    blend = os.path.join(bpy.app.tempdir, "estimate.blend")
    bpy.ops.wm.save_as_mainfile(filepath=blend, copy=True)
    done = subprocess.run(command_line(settings, blend, ["--dry-run"]), capture_output=True, text=True)
    os.remove(blend)
    told = [line for line in done.stderr.splitlines() if line.startswith("record:")]
    if done.returncode != 0:
        return [], told[-1] if told else "the recorder ended with %d" % done.returncode
    return [line for line in done.stdout.splitlines()
            if line.split(" ")[0] in ("scene", "needs", "channels", "passes", "estimate")], ""


def record_path():
    """Inside the installed add-on, or beside this folder in the tree."""
    inside = os.path.join(HERE, "recorder", "dumps", "cycles", "record.py")
    return inside if os.path.isfile(inside) else os.path.join(os.path.dirname(HERE), "record.py")


def command_line(settings, blend, more):
    options = ["--mode", settings.mode, "--samples", str(settings.samples), "--reference",
               str(settings.reference), "--seed", str(settings.seed), "--channels", channel_list(settings),
               *more]
    if not bpy.app.binary_path:            # Blender as a module of Python
        return [sys.executable, record_path(), "--blend", blend, *options]
    return [bpy.app.binary_path, "-b", "--factory-startup", blend, "-P", record_path(),
            "--python-exit-code", "3", "--", *options]


def pack_command(context, folder, file):
    """None where the program spool is not found."""
    addon = context.preferences.addons.get(__package__)
    program = find_program(bpy.path.abspath(addon.preferences.spool) if addon else os.environ.get("SPOOL") or "spool")
    return [program, "pack", folder, "-o", file, "--compress", "--max-expansion", "1000000"] if program else None


def find_program(chosen):
    """What the preferences name; a bare name: on the path, then where pip puts the program of the package spool-lab:
    beside Blender's Python, in a virtual environment, for one user. A window manager's path often lacks these."""
    found = shutil.which(chosen)
    if found or os.path.dirname(chosen):
        return found
    scripts = "Scripts" if os.name == "nt" else "bin"
    folders = [os.path.join(sys.prefix, scripts), sysconfig.get_path("scripts", os.name + "_user")]
    if os.environ.get("VIRTUAL_ENV"):
        folders.insert(0, os.path.join(os.environ["VIRTUAL_ENV"], scripts))
    return shutil.which(chosen, path=os.pathsep.join(folders))


def batches_of(reference):
    """As the recorder counts them; loaded by its path, so that Blender's modules see no foreign names."""
    path = os.path.join(os.path.dirname(record_path()), "batches.py")
    spec = importlib.util.spec_from_file_location(__package__ + ".batches", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.batch_plan(reference)[1]
