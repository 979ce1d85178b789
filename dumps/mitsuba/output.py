"""From the chunks of a recording to its files: layers, their types and meanings, all that says how it came about; tested, and only then named."""
import os
import sys
from collections import namedtuple

import numpy as np

import spool
from dumps.mitsuba.channels import LAYERS, MEANINGS
from dumps.mitsuba.reference import pixels_of, told_of
from dumps.mitsuba.seeds import chunk_seed
from dumps.recording.failure import usage_failure
from dumps.recording.progress import Progress
from dumps.recording.recordings import group_meta, names

# What a recording is made of. chunks: of all recordings, one after the other; cut: how one of them is cut.
Parts = namedtuple("Parts", "mi recordable tracer layers chunks cut")
LARGEST_HALF, SMALLEST_HALF = 65504.0, 2.0 ** -14    # with 11 bits of precision
HALF_ROUNDING = 2.0 ** -11


def stored(name, array):
    """As a chunk keeps it: what every file has in 16 bits in 16 bits."""
    return array.astype("<f2") if LAYERS[name][0] == "f2" else array


def half_ranges(layers, chunks, indices):
    """(why 16 bits do not hold the light, or nothing; whether they hold the depth with their full precision)"""
    fits = "depth" not in layers or all(
        np.all((depth == 0) | ((depth >= SMALLEST_HALF) & (depth <= LARGEST_HALF)))
        for depth in (chunks.layers(index, ["depth"])["depth"] for index in indices))
    return light_too_wide(chunks.light(index, [name for name in ("radiance", "direct") if name in layers]) for index in indices), fits


def light_too_wide(arrays):
    """Why 16 bits do not hold this light, or nothing. Below SMALLEST_HALF they lose bits, and all of them below 6e-8: as much of the
    light as their rounding takes anyway may lie there, which the dark ends of paths need, a dark scene does not."""
    largest = total = small = 0.0
    for array in arrays:
        size = np.abs(np.where(np.isfinite(array), array, 0), dtype=np.float64)
        largest, total, small = max(largest, float(size.max())), total + float(size.sum()), small + float(size[size < SMALLEST_HALF].sum())
    if largest > LARGEST_HALF:
        return "a sample exceeds %g" % LARGEST_HALF
    return "%.3g of the light is darker than %.2g" % (small / total, SMALLEST_HALF) if small > HALF_ROUNDING * total else ""


def layer_types(layers, half, too_wide="", depth_fits=False):
    """{layer: dtype}. half: radiance and places on the lens in 16 bits, unless the light is too wide for them; depth by its range."""
    narrow = {"radiance": "f2", "direct": "f2", "lens": "f2"} if half and not too_wide else {}
    if half and depth_fits:
        narrow["depth"] = "f2"
    return {name: narrow.get(name, LAYERS[name][0]) for name in layers}


def metadata(options, parts, seconds, first_chunk):
    mi, recordable, tracer, cut = parts.mi, parts.recordable, parts.tracer, parts.cut
    return {"renderer": {"name": "Mitsuba", "version": mi.__version__, "variant": mi.variant()},
            "scene": {"name": recordable.name, "sha256": recordable.digest, "shapes": recordable.shapes[:4096],
                      "changes": recordable.changes},
            "mode": "iid", "independent": True,
            "settings": {"integrator": recordable.integrator.class_name(), "integrator_option": options.integrator,
                         "max_depth": options.max_depth, "defines": options.defines, "substitute": options.substitute,
                         "sampler": "independent", "filter": "box"},
            "seeds": {"user": options.seed, "pool_first": chunk_seed(options.seed, first_chunk), "chunk_samples": cut.step,
                      "chunk_rows": cut.bands[0][1], "reference_first": chunk_seed(options.seed, 0, reference=True)},
            "cost_note": "CPU seconds of all threads",
            "cost_per_sample": seconds / (tracer.width * tracer.height * samples_of(options)),
            "shutter": [recordable.shutter_open, recordable.shutter_open + recordable.shutter_time]}


def samples_of(options):
    """In one of the recordings."""
    return options.samples // options.recordings


def write_file(path, options, parts, number, meta, reference):
    """path: in the folder of the chunks. meta: beside that of metadata(); reference: the state of reference.py, or None."""
    tracer, layers, chunks, cut = parts.tracer, parts.layers, parts.chunks, parts.cut
    first_chunk = number * len(cut.parts)
    own = range(first_chunk, first_chunk + len(cut.parts))
    ranges = half_ranges(layers, chunks, own) if options.half else ("", False)
    types = layer_types(layers, options.half, *ranges)
    file_layers = {name: (types[name], LAYERS[name][1]) for name in layers}
    meta = {**metadata(options, parts, sum(map(chunks.seconds, own)), first_chunk), **meta, "channels": {name: MEANINGS[name] for name in layers}}
    if reference is not None:
        file_layers["reference"] = file_layers["reference_variance"] = ("f4", "RGB", "pixel")
        meta["reference"] = told_of(reference)
    # the writer holds a block of every pixel
    block = max(1, min(options.block, samples_of(options), 16 * options.chunk_lanes // (tracer.width * tracer.height)))
    with spool.Writer(path, tracer.width, tracer.height, samples_of(options), file_layers, tile_size=64,
                      block_spp=block, sample_order="exchangeable", meta=meta,
                      compress=not options.no_compress, force=True) as writer:
        bands = len(cut.bands)
        steps = range(0, len(cut.parts), bands)
        progress = Progress("chunks written", len(steps))
        for index in steps:
            taken = range(first_chunk + index, first_chunk + index + bands)
            loaded = [chunks.layers(chunk, layers) for chunk in taken]
            arrays = {name: np.concatenate([part[name] for part in loaded]) for name in layers}
            chunks.forget(taken)
            if "shape" in arrays:
                arrays["shape"] = arrays["shape"].astype("<u4")
            writer.write_passes(cut.parts[index][0], arrays)
            progress.step()
        progress.close()
        if reference is not None:
            for name, values in zip(("reference", "reference_variance"), pixels_of(reference)):
                writer.write_pixel(name, values)
    return "--half: %s: the radiance is kept in 32 bits" % ranges[0] if ranges[0] else None


def finish(options, parts, numbers, marks, reference):
    """[(file, findings)]; findings are empty where no test was wanted. numbers: counts for the claim on random numbers; marks: those of the
    pool, kept beside them."""
    chunks, outs, done = parts.chunks, names(options.out, options.recordings), []
    chunks.save_numbers(numbers, [options.reference, options.auto], marks)
    made_of = [parts.recordable.digest, options.seed, options.samples, options.reference, parts.mi.variant(), parts.mi.__version__]
    for number in range(len(outs)):
        path = chunks.whole_name(number)
        group = group_meta(options.out, options.recordings, number, made_of)
        if not chunks.is_whole(number):
            remark = write_file(path, options, parts, number, {"random_numbers": numbers, **group}, reference)
            if remark and number == 0:
                print(remark, file=sys.stderr)
        done.append((path, [] if options.no_verify else _tested(path)))
    there = [out for out in outs if os.path.lexists(out)]
    if there and not options.force and not chunks.is_named():
        raise usage_failure("%s: appeared during the recording: move it away and run the same command again" % there[0])
    chunks.mark_named()
    for out, (path, _) in zip(outs, done):
        os.replace(path, out)
    chunks.remove()
    return [(out, findings) for out, (_, findings) in zip(outs, done)]


def _tested(path):
    from dumps.verify.verify import keep_verification, verify
    found = verify(path)
    keep_verification(path, found)
    return found["findings"]
