#!/usr/bin/env python3
"""Record every camera sample of a Mitsuba scene into one .spool file.

    python dumps/mitsuba/record.py scene.xml -o scene.spool --size 256 --samples 64 --reference 4096

Scenes of Mitsuba 0.5 and 0.6 are rewritten for Mitsuba 3; what was changed is printed and kept in the file.
A run that was stopped goes on where it was when the same command is given again.
"""
import os
import signal
import sys
import time

sys.path.insert(0, os.path.abspath(os.path.join(__file__, "..", "..", "..")))
sys.path.insert(1, os.path.join(sys.path[0], "formats", "python"))

import numpy as np

from dumps.mitsuba.channels import chosen_layers
from dumps.mitsuba.chunks import FORMAT, Chunks
from dumps.mitsuba.options import parse
from dumps.mitsuba.output import Parts, finish, layer_types, samples_of, stored
from dumps.mitsuba.plan import Cut, describe
from dumps.mitsuba.reference import add_chunk, begun_or_empty, is_left_out, judged, left_out, told_of
from dumps.mitsuba.scene import Wishes, load_scene
from dumps.mitsuba.seeds import CHUNK_LIMIT, SPARE, chunk_seed
from dumps.mitsuba.variant import choose_variant
from dumps.recording.failure import guarded, io_failure, scene_failure, usage_failure
from dumps.recording.progress import Progress
from dumps.recording.progress import size as size_text
from dumps.recording.recordings import names, next_step
from dumps.recording.reference_need import outcome, reference_hint
from dumps.verify import shared_numbers
from dumps.verify.finding import line, summary

BYTES_PER_LANE = 119       # measured at the peak of the copy to numpy, all layers
LONG_REFERENCE = 300       # seconds from which on its price is printed before it begins
RANDOM_NUMBERS = 2         # how seeds become samples; recordings begun with another number cannot go on


def open_tracer(options):
    """(mi, recordable, tracer, lines to print)"""
    try:
        variant, note = choose_variant(options.variant)
        import mitsuba as mi
        usable = [name for name in mi.variants() if name.startswith(("llvm_", "cuda_")) and "mono" not in name or name == "scalar_rgb"]
        if variant not in usable:
            raise usage_failure("--variant %s: use one of %s" % (variant, ", ".join(usable)))
        mi.set_variant(variant)
    except ImportError as error:
        raise io_failure("Mitsuba does not start (%s): pip install -r dumps/mitsuba/requirements.txt, and apt-get "
                         "install libatomic1 libllvm19" % error)
    mi.set_log_level(mi.LogLevel.Error)
    recordable = load_scene(mi, options.scene, Wishes(options.size, options.integrator, options.max_depth,
                                                      options.definitions, options.substitutes, options.allow_losses, options.files,
                                                      options.scene_sha256))
    notes = ([note] if note else []) + ["%s: %s" % (options.scene, change) for change in recordable.changes]
    if variant == "scalar_rgb":
        from dumps.mitsuba.scalar_loop import ScalarLoop
        return mi, recordable, ScalarLoop(mi, recordable, samples_of(options)), notes
    import drjit as dr

    from dumps.mitsuba.wavefront import Wavefront
    return mi, recordable, Wavefront(mi, dr, recordable, samples_of(options)), notes


def plan_of(options, mi, recordable, tracer, layers, cut):
    several = {} if options.recordings == 1 else {"recordings": options.recordings}
    return {**several, "scene": recordable.name, "scene_sha256": recordable.digest, "width": tracer.width, "height": tracer.height,
            "samples": options.samples, "seed": options.seed, "layers": layers, "chunk_samples": cut.step, "chunk_rows": cut.bands[0][1],
            "integrator": recordable.integrator.class_name(), "integrator_option": options.integrator,
            "max_depth": options.max_depth, "defines": options.defines, "substitute": options.substitute,
            "variant": mi.variant(), "mitsuba": mi.__version__, "random_numbers": RANDOM_NUMBERS, "chunks": FORMAT}


def record_pool(options, tracer, layers, chunks, cut):
    """Traces the chunks that are not there yet, nor in a file that is whole; each keeps the CPU time of all threads that it took.
    Returns the wall time of all, as if none had been there."""
    total = options.recordings * len(cut.parts)
    missing = [index for index in range(total) if not chunks.has(index) and not chunks.is_whole(index // len(cut.parts))]
    if missing:  # compiles the kernels, which is no cost of a sample
        tracer.trace(1, chunk_seed(options.seed, SPARE), layers, cut.bands[0])
    pixels = shared_numbers.chosen_pixels(tracer.width, tracer.height)
    progress, begun = Progress("pool", len(missing)), time.monotonic()
    for index in missing:
        _, count, rows = cut.parts[index % len(cut.parts)]
        started = time.process_time()
        arrays = tracer.trace(count, chunk_seed(options.seed, index), [*dict.fromkeys([*layers, "film"])], rows)
        seconds = time.process_time() - started
        marks = shared_numbers.marks(arrays["film"], rows, pixels)
        chunks.save(index, marks, {name: stored(name, arrays[name]) for name in layers}, seconds)
        progress.step()
    progress.close()
    return (time.monotonic() - begun) * total / len(missing) if missing else 0.0


def record_reference(options, tracer, chunks, cut, pool_marks):
    """pool_marks: sorted, of shared_numbers."""
    state, useless = begun_or_empty(chunks.load_reference(), options.reference, cut.parts, tracer.height, tracer.width)
    if useless:
        print("%s: the reference there holds more than --reference %d, or is cut by other --chunk-lanes: it begins anew, the pool is kept" % (
            chunks.folder, options.reference), file=sys.stderr)
    pixels = shared_numbers.chosen_pixels(tracer.width, tracer.height)
    progress = Progress("reference", len(cut.parts) - int(state["chunks"]))
    while int(state["chunks"]) < len(cut.parts):
        index = int(state["chunks"])
        _, count, rows = cut.parts[index]
        state = judged(state, cut.parts[index]) if options.auto else state
        if is_left_out(state):
            state = left_out(state, cut.parts[index])
            progress.step()
            continue
        started = time.process_time()
        arrays = tracer.trace(count, chunk_seed(options.seed, index, reference=True), ["radiance", "film"], rows)
        marks = shared_numbers.marks(arrays["film"], rows, pixels)
        kept = {"cut": state["cut"], "looked_at": state["looked_at"] + len(marks),
                "repeated": state["repeated"] + shared_numbers.found_again(marks, pool_marks)}
        state = {**add_chunk(state, arrays["radiance"], time.process_time() - started, rows), **kept}
        if index % 8 == 7 or index + 1 == len(cut.parts):
            chunks.save_reference(state)
        progress.step()
    progress.close()
    if options.auto:
        told = told_of(state)
        print("\n".join(outcome(told, options.reference)), file=sys.stderr)
    return state


def record(options, mi, recordable, tracer, layers):
    """[(file, findings of verification)]"""
    cut = Cut(tracer, samples_of(options), options.chunk_lanes)
    total = options.recordings * len(cut.parts)
    reference_cut = Cut(tracer, max(options.reference, 1), options.chunk_lanes, options.auto)
    if tracer.width > options.chunk_lanes or max(total, len(reference_cut.parts)) >= CHUNK_LIMIT - 1:
        raise usage_failure("--chunk-lanes %d is too small for %dx%d pixels: raise it (about %d bytes each)" %
                            (options.chunk_lanes, tracer.width, tracer.height, BYTES_PER_LANE))
    chunks = Chunks(options.out + ".recording", plan_of(options, mi, recordable, tracer, layers, cut))
    numbers, reference = chunks.load_numbers([options.reference, options.auto], cut, layers, options.recordings), None
    wall = record_pool(options, tracer, layers, chunks, cut)
    if wall * options.reference / options.samples > LONG_REFERENCE:
        print("\n".join(reference_hint(options.samples, options.reference, wall, wall * options.reference / options.samples,
                                       auto=options.auto)), flush=True)
    marks = np.empty(0, "<u8")
    if numbers is None:
        marks = chunks.pool_marks(total)
        numbers = {"pool": len(marks), "pool_repeated": shared_numbers.repeated(marks)}
    if options.reference:
        reference = record_reference(options, tracer, chunks, reference_cut, marks)
        numbers.update(reference=int(reference["looked_at"]), reference_repeated=int(reference["repeated"]))
    return finish(options, Parts(mi, recordable, tracer, layers, chunks, cut), numbers, marks, reference)


def run(arguments):
    options = parse(arguments, __doc__)
    mi, recordable, tracer, notes = open_tracer(options)
    for note in notes:
        print(note, file=sys.stderr)
    layers = chosen_layers(options.channels, recordable)
    try:
        if options.dry_run:
            describe(options, recordable, tracer, layers, layer_types(layers, options.half))
            return
        recorded = record(options, mi, recordable, tracer, layers)
    except RuntimeError as error:  # of Mitsuba: what a plugin cannot do shows when a ray meets it
        raise io_failure("%s: Mitsuba cannot render it (%s)" % (options.scene, " ".join(str(error).split())[:300]))
    failing = []
    for path, findings in recorded:
        print("%s: %dx%d, %d samples a pixel, %s" % (path, tracer.width, tracer.height, samples_of(options),
                                                     size_text(os.path.getsize(path))))
        failing += ["%s: whole, but its samples are not what they should be: %s" % (path, line(entry)) for entry in findings
                    if entry["holds"] is False]
        for entry in findings:
            if entry["name"] == "picture":
                print("%s: %s" % (path, line(entry)))
        print("%s: %s" % (path, summary(findings) if findings else "not verified: dumps/verify/verify.py FILE --write does it"))
    if failing:
        raise scene_failure(failing[0])
    print(next_step(names(options.out, options.recordings)))


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    sys.exit(guarded(lambda: run(sys.argv[1:]), resumable=True))
