#!/usr/bin/env python3
"""Record every camera sample of a Mitsuba 3 scene into one .spool file.

    python dumps/mitsuba/record.py scene.xml -o scene.spool --size 256 --samples 64 --reference 4096

A run that was stopped goes on where it was when the same command is given again.
"""
import argparse
import os
import signal
import sys
import time

HERE = os.path.dirname(os.path.abspath(__file__))
for folder in (HERE, os.path.join(HERE, "..", "recording"), os.path.join(HERE, "..", "verify"), os.path.join(HERE, "..", "..", "formats", "python")):
    sys.path.insert(0, folder)

import numpy as np  # noqa: E402

from channels import DEFAULT, LAYERS, chosen_layers  # noqa: E402
from chunks import Chunks  # noqa: E402
from failure import Failure, scene_failure, usage_failure  # noqa: E402
from plan import REFERENCE_SEEDS, Cut, describe  # noqa: E402
from progress import Progress, size as size_text  # noqa: E402
from reference import add_chunk, empty_reference, variance_of_mean  # noqa: E402
from scene import load_scene  # noqa: E402
from variant import choose_variant  # noqa: E402

BYTES_PER_LANE = 119       # measured at the peak of the copy to numpy, all layers


def parse(arguments):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", help="an .xml scene, a .py file with scene(mi) -> dict, or cornell-box")
    parser.add_argument("-o", "--out", help="the .spool file to make")
    parser.add_argument("--size", help="WxH or N (default: the film's)")
    parser.add_argument("--samples", type=int, default=64, help="per pixel (64)")
    parser.add_argument("--reference", type=int, default=0, metavar="SPP", help="independent reference (0: none)")
    parser.add_argument("--seed", type=int, default=1, help="0 .. 1023 (1)")
    parser.add_argument("--channels", default=DEFAULT, help="%s; or all (default %s; lens and time where the scene "
                        "has them)" % (", ".join(LAYERS), DEFAULT))
    parser.add_argument("--integrator", help="plugin to use instead of the scene's, for instance path or volpath")
    parser.add_argument("--max-depth", type=int, help="of that integrator")
    parser.add_argument("-D", dest="defines", action="append", default=[], metavar="NAME=VALUE",
                        help="a parameter of the XML scene")
    parser.add_argument("--chunk-lanes", type=int, default=1 << 20, help="samples traced at once (1048576)")
    parser.add_argument("--block", type=int, default=16, help="samples in a block of the file (16)")
    parser.add_argument("--variant", help="Mitsuba variant (default: llvm_ad_rgb, scalar_rgb without LLVM)")
    parser.add_argument("--no-compress", action="store_true")
    parser.add_argument("--no-verify", action="store_true", help="do not test the samples and keep what was found")
    parser.add_argument("--force", action="store_true", help="replace an existing file")
    parser.add_argument("--dry-run", action="store_true", help="say what the scene needs and what it will cost")
    options = parser.parse_args(arguments)
    if not options.out and not options.dry_run:
        raise usage_failure("no output: give -o FILE.spool")
    for name, low, high in (("samples", 1, 65536), ("reference", 0, 1 << 24), ("seed", 0, 1023),
                            ("chunk_lanes", 1, 1 << 28), ("block", 1, 1024)):
        if not low <= getattr(options, name) <= high:
            raise usage_failure("--%s %d is outside %d .. %d" % (name.replace("_", "-"), getattr(options, name), low, high))
    if options.out and os.path.exists(options.out) and not options.force:
        raise usage_failure("%s: exists: choose another name or give --force" % options.out)
    return options


def parse_size(text):
    try:
        values = [int(part) for part in text.lower().split("x")]
        width, height = (values * 2)[:2]
        if len(values) > 2 or min(width, height) < 1 or max(width, height) > 65536:
            raise ValueError
    except ValueError:
        raise usage_failure("--size '%s' is no size: use WxH or N" % text)
    return width, height


def open_tracer(options):
    """(mi, recordable, tracer factory, note)"""
    try:
        variant, note = choose_variant(options.variant)
        import mitsuba as mi
        mi.set_variant(variant)
    except ImportError as error:
        raise Failure(3, "Mitsuba does not start (%s): pip install -r dumps/mitsuba/requirements.txt, and apt-get "
                         "install libatomic1 libllvm19" % error)
    if not (variant.startswith(("llvm_", "cuda_")) or variant == "scalar_rgb") or "mono" in variant:
        raise usage_failure("--variant %s: use llvm_ad_rgb, cuda_ad_rgb, their spectral forms, or scalar_rgb" % variant)
    mi.set_log_level(mi.LogLevel.Error)
    integrator = None
    if options.integrator:
        integrator = {"type": options.integrator}
        if options.max_depth:
            integrator["max_depth"] = options.max_depth
    defines = dict(text.partition("=")[::2] for text in options.defines)
    recordable = load_scene(mi, options.scene, parse_size(options.size) if options.size else None, integrator, defines)

    def tracer():
        if variant == "scalar_rgb":
            from scalar_loop import ScalarLoop
            return ScalarLoop(mi, recordable, options.samples)
        import drjit as dr
        from wavefront import Wavefront
        return Wavefront(mi, dr, recordable, options.samples)
    return mi, recordable, tracer(), note


def plan_of(options, mi, recordable, tracer, layers, cut):
    return {"scene": recordable.name, "scene_sha256": recordable.digest, "width": tracer.width, "height": tracer.height,
            "samples": options.samples, "seed": options.seed, "layers": layers, "chunk_samples": cut.step, "chunk_rows": cut.bands[0][1],
            "integrator": type(recordable.integrator).__name__, "integrator_option": options.integrator,
            "max_depth": options.max_depth, "defines": options.defines, "variant": mi.variant(), "mitsuba": mi.__version__}


def record_pool(options, tracer, layers, chunks, cut):
    """Traces the chunks that are not there yet; each keeps the CPU time of all threads that it took."""
    missing = [index for index in range(len(cut.parts)) if not chunks.has(index)]
    if missing:  # compiles the kernels, which is no cost of a sample
        tracer.trace(1, (options.seed << 21) + REFERENCE_SEEDS - 1, layers, cut.bands[0])
    progress = Progress("pool", len(missing))
    for index in missing:
        _, count, rows = cut.parts[index]
        started = time.process_time()
        arrays = tracer.trace(count, (options.seed << 21) + index, layers, rows)
        chunks.save(index, arrays, time.process_time() - started)
        progress.step()
    progress.close()


def record_reference(options, tracer, chunks, cut):
    state = chunks.load_reference() or empty_reference(tracer.height, tracer.width)
    progress = Progress("reference", len(cut.parts) - int(state["chunks"]))
    while int(state["chunks"]) < len(cut.parts):
        index = int(state["chunks"])
        _, count, rows = cut.parts[index]
        started = time.process_time()
        arrays = tracer.trace(count, (options.seed << 21) + REFERENCE_SEEDS + index, ["radiance"], rows)
        state = add_chunk(state, arrays["radiance"], time.process_time() - started, rows)
        if index % 8 == 7 or index + 1 == len(cut.parts):
            chunks.save_reference(state)
        progress.step()
    progress.close()
    return state


def write_file(options, mi, recordable, tracer, layers, chunks, cut, reference):
    import spool
    file_layers = {name: LAYERS[name] for name in layers}
    if reference is not None:
        file_layers["reference"] = ("f4", "RGB", "pixel")
        file_layers["reference_variance"] = ("f4", "RGB", "pixel")
    seconds = sum(chunks.load(index)[1] for index in range(len(cut.parts)))
    meta = {"renderer": {"name": "Mitsuba", "version": mi.__version__, "variant": mi.variant()},
            "scene": {"name": recordable.name, "sha256": recordable.digest, "shapes": recordable.shapes[:4096]},
            "mode": "iid", "independent": True,
            "settings": {"integrator": type(recordable.integrator).__name__, "integrator_option": options.integrator,
                         "max_depth": options.max_depth, "defines": options.defines, "sampler": "independent",
                         "filter": "box"},
            "seeds": {"user": options.seed, "pool_first": options.seed << 21, "chunk_samples": cut.step,
                      "chunk_rows": cut.bands[0][1], "reference_first": (options.seed << 21) + REFERENCE_SEEDS},
            "cost_note": "CPU seconds of all threads",
            "cost_per_sample": seconds / (tracer.width * tracer.height * options.samples),
            "channels": {"normal": {"space": "world"}, "depth": {"meaning": "camera z, 0 = miss"},
                         "shape": {"meaning": "1 + index in scene.shapes, 0 = miss"},
                         "lens": {"meaning": "place on the unit disk; times the radius: on the lens"},
                         "time": {"meaning": "[0, 1) of the open shutter"}},
            "shutter": [recordable.shutter_open, recordable.shutter_open + recordable.shutter_time]}
    if reference is not None:
        meta["reference"] = {"samples": options.reference, "independent": True,
                             "nonfinite": int(reference["nonfinite"]),
                             "seconds": float(reference["seconds"])}
    # the writer holds a block of every pixel
    block = max(1, min(options.block, options.samples, 16 * options.chunk_lanes // (tracer.width * tracer.height)))
    with spool.Writer(options.out, tracer.width, tracer.height, options.samples, file_layers, tile_size=64,
                      block_spp=block, sample_order="exchangeable", meta=meta,
                      compress=not options.no_compress, force=options.force) as writer:
        bands = len(cut.bands)
        for index in range(0, len(cut.parts), bands):
            loaded = [chunks.load(index + band)[0] for band in range(bands)]
            arrays = {name: np.concatenate([part[name] for part in loaded]) for name in layers}
            if "shape" in arrays:
                arrays["shape"] = arrays["shape"].astype("<u4")
            writer.write_passes(cut.parts[index][0], arrays)
        if reference is not None:
            writer.write_pixel("reference", reference["mean"].astype("<f4"))
            writer.write_pixel("reference_variance", variance_of_mean(reference).astype("<f4"))


def run(arguments):
    options = parse(arguments)
    mi, recordable, tracer, note = open_tracer(options)
    if note:
        print(note, file=sys.stderr)
    layers = chosen_layers(options.channels, recordable)
    if options.dry_run:
        describe(options, recordable, tracer, layers)
        return
    cut = Cut(tracer, options.samples, options.chunk_lanes)
    if tracer.width > options.chunk_lanes or len(cut.parts) >= REFERENCE_SEEDS - 1:
        raise usage_failure("--chunk-lanes %d is too small for %dx%d pixels: raise it (about %d bytes each)" %
                            (options.chunk_lanes, tracer.width, tracer.height, BYTES_PER_LANE))
    chunks = Chunks(options.out + ".recording", plan_of(options, mi, recordable, tracer, layers, cut))
    record_pool(options, tracer, layers, chunks, cut)
    reference = record_reference(options, tracer, chunks, Cut(tracer, options.reference, options.chunk_lanes)) \
        if options.reference else None
    write_file(options, mi, recordable, tracer, layers, chunks, cut, reference)
    chunks.remove()
    failing = [] if options.no_verify else keep_verification(options.out)
    print("%s: %dx%d, %d samples a pixel, %s" % (options.out, tracer.width, tracer.height, options.samples,
                                                 size_text(os.path.getsize(options.out))))
    if failing:
        raise scene_failure("%s: whole, but its samples are not what they should be: %s" % (options.out, failing[0]))


def keep_verification(path):
    """Tests the samples, keeps the findings in the file; the claims that fail, as lines."""
    from finding import line
    from verify import verify, write_verification
    found = verify(path)
    write_verification(path, found)
    return [line(entry) for entry in found["findings"] if entry["holds"] is False]


def main():
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        run(sys.argv[1:])
    except Failure as failure:
        print(failure, file=sys.stderr)
        return failure.code
    except KeyboardInterrupt:
        print("stopped: run the same command again to go on", file=sys.stderr)
        return 3
    except Exception as error:
        code = getattr(error, "code", None)  # SpoolError carries the exit code of the program
        if not isinstance(code, int):
            raise
        print(error, file=sys.stderr)
        return code
    return 0


if __name__ == "__main__":
    sys.exit(main())
