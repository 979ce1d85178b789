"""Records every sample of a Cycles rendering into a folder of passes; `spool pack` makes it a recording.

  blender -b [FILE.blend] -P record.py --python-exit-code 3 -- --scene chess --samples 64 -o FOLDER
  python record.py --blend FILE.blend --samples 64 -o FOLDER               (with the bpy module)

Exit codes: 0 done, 1 the scene cannot be recorded, 2 wrong use, 3 Blender or the system refused.
Run again after an interruption: finished passes are kept, and the samples and the reference are the same
bit for bit (not the recording: its identifier and the measured cost of a sample differ).
"""
import contextlib
import os
import signal
import sys
import time

sys.path.insert(0, os.path.abspath(os.path.join(__file__, "..", "..", "..")))

import bpy

from dumps.cycles import files
from dumps.cycles.batches import batch_plan
from dumps.cycles.camera import ShiftedCamera
from dumps.cycles.depth import prepare_depth
from dumps.cycles.engine import Renderer
from dumps.cycles.estimate import dry_run
from dumps.cycles.options import parse_options, script_arguments
from dumps.cycles.pass_folder import PassFolder
from dumps.cycles.passes import (
    CHANNELS,
    describe_channels,
    describe_layers,
    plan_channels,
    planes_of,
    switch_passes,
)
from dumps.cycles.reference import FIRST, fold, keep_or_drop, record_until_it_suffices
from dumps.cycles.scene import aspect_change, find_needs, load_scene, number_objects, prepare
from dumps.cycles.seeds import film_position, pool_seed, reference_seed
from dumps.cycles.settings import (
    apply_settings,
    longest_sequence,
    mute_animation,
    overridden,
    power_of_two,
    recorded_settings,
    select_samples,
)
from dumps.recording.failure import guarded, io_failure, usage_failure
from dumps.recording.progress import Progress, duration


class Recorder:
    """A scene made ready: renders pass i or batch b as bytes and the log entry that goes with them."""

    def __init__(self, options):
        self.options = options
        self.plan = plan_channels(options.channels, options.mode)
        self.scene, self.identity = load_scene(options.scene, options.blend, options.files)
        changes = files.substitute(options.substitutes)
        files.require(self.identity["name"])
        own_size = prepare(self.scene, options.camera, options.frame, options.size)
        self.view_layer = bpy.context.view_layer
        changes += overridden(self.scene, self.view_layer) + mute_animation(self.scene)
        apply_settings(self.scene, self.view_layer, options.threads)
        self.width, self.height = self.scene.render.resolution_x, self.scene.render.resolution_y
        self.plan, self.mist_depth, mixed = prepare_depth(self.scene, self.plan)
        changes += mixed
        change = aspect_change((self.width, self.height), own_size)
        changes += [change] if change else []
        if changes and not options.scene:
            self.identity["changes"] = changes
        if "object" in self.plan:
            number_objects()
        self.camera = ShiftedCamera(self.scene)
        if options.mode == "shift":
            self.camera.refuse_unusable()
        elif options.mode == "sequence" and options.samples > longest_sequence():
            raise usage_failure("mode sequence: this Cycles (%s) gives at most %d samples one by one" %
                                (bpy.app.version_string, longest_sequence()))
        scratch = options.out or bpy.app.tempdir
        os.makedirs(scratch, exist_ok=True)
        self.renderer = Renderer(self.scene, options.pixels, scratch)
        self.batch_spp, self.batches = (FIRST, options.reference // FIRST) if options.auto else batch_plan(options.reference)

    def recording(self):
        """Everything that must agree between passes of one recording."""
        options = self.options
        found = {
            "renderer": "Cycles", "renderer_version": bpy.app.version_string,
            "scene": self.identity, "camera": self.scene.camera.name,
            "frame": self.scene.frame_current, "view_layer": self.view_layer.name,
            "width": self.width, "height": self.height, "mode": options.mode, "seed": options.seed,
            "channels": describe_channels(self.plan), "layers": describe_layers(self.plan),
            "needs": find_needs(self.scene),
            "mist_depth": self.mist_depth, "settings": recorded_settings(self.scene),
        }
        if options.mode == "sequence":       # its place in the sequence depends on the length
            found["sequence_length"] = options.samples
        return found

    def render_pass(self, index):
        options, entry = self.options, {}
        if options.mode == "sequence":
            seed = pool_seed(options.seed, 0)
            # an aligned block that leaves out index 0, which is shot through the pixel centre
            sample = power_of_two(options.samples) + index
        else:
            seed = pool_seed(options.seed, index)
            sample = 0 if options.mode == "shift" else 1
        if options.mode == "shift":
            x, y = film_position(options.seed, index)
            self.camera.place(x, y)
            entry["film"] = [x, y]
        return self._render(self.plan, seed, sample, 1, entry)

    def render_batch(self, samples, seed):
        """Their mean: an aligned block of a sequence of its own."""
        self.camera.restore()
        return self._render({"radiance": CHANNELS["radiance"]}, seed, samples, samples, {})

    def render_reference(self, batch):
        return self.render_batch(self.batch_spp, reference_seed(self.options.seed, batch))

    def _render(self, plan, seed, first, count, entry):
        switch_passes(self.view_layer, plan)
        select_samples(self.scene, seed, first, count)
        wall, cpu = time.perf_counter(), time.process_time()
        rendered = self.renderer.render()
        entry.update(seed=seed, sample_index=first, samples=count,
                     seconds=round(time.perf_counter() - wall, 6),
                     cpu_seconds=round(time.process_time() - cpu, 6))
        return planes_of(plan, rendered, self.width, self.height, self.mist_depth), entry


def leave(code):
    """Ends Blender at once: 3.4 may crash while it unloads Cycles after all is done, and the code must be ours.

    Its temporary folder goes, where nothing is left in it: Blender itself removes it on its own way out only.
    """
    with contextlib.suppress(OSError):
        os.rmdir(bpy.app.tempdir)
    os._exit(code)


class Stop:
    """A first Ctrl-C or SIGTERM ends the recording after the pass at work, a second one at once."""

    def __init__(self):
        self.wanted = False
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._handle)

    def _handle(self, number, frame):
        if self.wanted:
            leave(3)                       # what is on disk is whole at any moment
        self.wanted = True


def record(recorder, options, stop):
    folder = PassFolder(options.out, recorder.recording(), options.packed)
    if options.packed:
        return "%s: packed, nothing is rendered" % options.out
    start = time.monotonic()
    there = keep_or_drop(folder, options)
    if not options.auto and not there:
        go_on_with_batches(folder, recorder, options.reference)
        drop_other_batches(folder, recorder)
    batches = range(options.first_batch, options.first_batch + recorder.batches)
    passes = ("pass", recorder.render_pass, range(options.first, options.first + options.samples))
    reference = ("reference", recorder.render_reference, () if options.auto or there else batches)
    kept = {}

    def stopped(done, of, label):
        if stop.wanted:
            raise io_failure("%s: stopped with %d of %s %s: run the same command again to go on" % (options.out, done, of, label))

    for kind, render, wanted in (reference, passes) if options.fold else (passes, reference):
        missing = [i for i in wanted if not folder.has(kind, i)]
        kept[kind] = len(wanted) - len(missing)
        progress = Progress("passes" if kind == "pass" else "reference", len(missing))
        for i in missing:
            stopped(kept[kind] + progress.done, len(wanted), progress.label)
            data, entry = render(i)
            folder.add(kind, i, data, entry)
            progress.step()
        progress.close()
        if kind == "reference" and not there:
            kept[kind] = finish_reference(folder, recorder, options, stopped) if options.auto else kept[kind]
            if options.fold:
                fold(folder, options)
    if there:
        kept["reference"] = recorder.batches = len(there["folded_seeds"])
        recorder.batch_spp = there["samples"] // recorder.batches
    return "%s: %s, %dx%d, %d passes (%d kept), reference %d x %d spp (%d kept), %s%s%s" % (
        options.out, recorder.identity["name"], recorder.width, recorder.height, options.samples,
        kept["pass"], recorder.batches, recorder.batch_spp, kept["reference"],
        duration(time.monotonic() - start), "; pixels by EXR: " + recorder.renderer.why_file if recorder.renderer.why_file else "",
        more_note(folder, (passes,) if options.auto or options.fold else (passes, reference)))


def finish_reference(folder, recorder, options, stopped):
    """One that ends by itself; returns how many batches were there."""
    there = len(folder.entries["reference"])
    print("\n".join(record_until_it_suffices(folder, recorder, options, lambda done: stopped(done, "at most 128", "batches"))),
          file=sys.stderr, flush=True)
    recorder.batch_spp, recorder.batches = folder.entries["reference"][0]["samples"], len(folder.entries["reference"])
    return there


def go_on_with_batches(folder, recorder, reference):
    """A larger reference goes on with batches of the size that is there, where that splits it."""
    sizes = {entry.get("samples") for entry in folder.entries["reference"].values()}
    size = sizes.pop() if len(sizes) == 1 else 0
    if size and reference % size == 0 and reference // size >= recorder.batches:
        recorder.batch_spp, recorder.batches = size, reference // size


def drop_other_batches(folder, recorder):
    """A reference is the mean of equal batches: those that an earlier, larger or smaller wish left are no part of it."""
    batches = folder.entries["reference"]
    other = [i for i, entry in batches.items() if entry.get("samples") != recorder.batch_spp]
    if not recorder.batches or not other:
        return
    told = "%s: the reference is begun anew: a batch now has %d samples, the %d batches there had %s" % (
        folder.path, recorder.batch_spp, len(other), batches[other[0]].get("samples"))
    folder.remove("reference", other)
    print(told, file=sys.stderr, flush=True)


def more_note(folder, jobs):
    """What an earlier command left beside what this one asks for: `spool pack` takes all."""
    more = ["%d %s" % (count, "passes" if kind == "pass" else "batches") for kind, _, wanted in jobs
            for count in [len(set(folder.entries[kind]) - set(wanted))] if count]
    return "; the folder holds %s more, and spool pack takes them too" % " and ".join(more) if more else ""


def silence_blender():
    """Blender prints a line per step on file descriptor 1; returns a stream to what it was."""
    sys.stdout.flush()
    out = os.fdopen(os.dup(1), "w")
    sink = os.open(os.devnull, os.O_WRONLY)
    os.dup2(sink, 1)
    os.close(sink)
    return out


def run():
    options = parse_options(script_arguments())
    out = silence_blender()
    stop = Stop()
    recorder = Recorder(options)
    for change in recorder.identity.get("changes", []):
        print("%s: %s" % (recorder.identity["name"], change), file=sys.stderr, flush=True)
    print(dry_run(recorder, options) if options.dry_run else record(recorder, options, stop), file=out, flush=True)


if __name__ == "__main__":
    code = guarded(run, "record")
    sys.stderr.flush()
    leave(code)
