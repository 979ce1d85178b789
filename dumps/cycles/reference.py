"""The reference of a folder: one that ends by itself (`--reference auto`, reference_need.py), and one that is whole as one file.

The first has 64 to 128 batches of one size. It begins with batches of 8 samples. When there are 128, neighbours become one batch, the mean of
two, and the next ones are rendered of that size: the folder does not grow with the reference. A batch that begins with sample s has the seed of
number s / 8.

A folded one is the mean of its batches and the variance of that mean, as the recording will have them: 64 batches take as much of the disk as 64
passes. It is of one wish: another one begins it anew.
"""
import statistics
import sys

try:
    import numpy
except ImportError:
    numpy = None

from dumps.cycles.seeds import reference_seed
from dumps.recording.failure import usage_failure
from dumps.recording.progress import Progress
from dumps.recording.reference_need import DENOMINATOR, LEAST, denominator_noise, judged_at, outcome

FIRST, LARGEST, BATCHES = LEAST // 64, 128, 128


def record_until_it_suffices(folder, recorder, options, stopped):
    """Renders batches until their mean is good enough or options.reference is reached. stopped(done): called before each.
    Returns lines on what became of it."""
    if not numpy:
        raise usage_failure("--reference auto: Blender's Python has no numpy: give a number of samples")
    entries = folder.entries["reference"]
    foreign = [entry["samples"] for entry in entries.values() if entry["samples"] < FIRST or entry["samples"] & entry["samples"] - 1]
    if foreign or sorted(entries) != list(range(len(entries))):
        raise usage_failure("%s: the reference there has batches of another wish: give the number of samples it was begun with" % folder.path)
    size = next(iter(entries.values()))["samples"] if entries else FIRST
    progress = Progress("reference", options.reference // size)
    while True:
        done = len(entries) * size
        judged = _judged(folder, done, size) if judged_at(done) else None
        if done >= options.reference or judged and judged["denominator_noise"] <= DENOMINATOR:
            progress.close()
            return outcome(judged, options.reference)
        if len(entries) == BATCHES and size < LARGEST:
            _join(folder, size)
            size *= 2
            progress = Progress("reference", options.reference // size)
            progress.done = len(entries)
        stopped(len(entries))
        data, entry = recorder.render_batch(size, reference_seed(options.seed, done // FIRST))
        folder.add("reference", len(entries), data, entry)
        progress.step()


def _judged(folder, samples, size):
    return {"samples": samples, "samples_least": samples, "samples_most": samples,
            "denominator_noise": denominator_noise(*mean_and_variance(folder, range(samples // size)))}


def _join(folder, size):
    """Pairs of neighbours become one batch each."""
    entries = folder.entries["reference"]
    joined = []
    for index in range(len(entries) // 2):
        pair = entries[2 * index], entries[2 * index + 1]
        image = (batch_image(folder, 2 * index) + batch_image(folder, 2 * index + 1)) / 2
        more = {key: pair[0][key] + pair[1][key] for key in ("seconds", "cpu_seconds")}
        joined.append((image.astype("<f4").tobytes(), {"seed": pair[0]["seed"], "sample_index": 2 * size, "samples": 2 * size, **more}))
    folder.replace("reference", joined, "reference_of_%d_%%05d.f32" % (2 * size))


def wish_of(options):
    return [options.reference, options.auto, options.first_batch]


def keep_or_drop(folder, options):
    """The line of the reference if it is folded and of this wish, else None; one of another wish goes."""
    line = folder.entries["reference"].get(0, {})
    if "folded_seeds" not in line:
        return None
    if line["wish"] == wish_of(options):
        return line
    print("%s: the reference there is of another --reference: it begins anew" % folder.path, file=sys.stderr, flush=True)
    folder.remove("reference", [0])
    return None


def batch_image(folder, index):
    return numpy.frombuffer(folder.batch(index), "<f4").astype(numpy.float64)


def mean_and_variance(folder, indices):
    """Of batches, and of that mean: Welford's recurrence in double, in this order, as in formats/pass_folder.cpp: the same bits."""
    mean, squares = 0.0, 0.0
    for count, index in enumerate(indices, 1):
        image = batch_image(folder, index)
        delta = image - mean
        mean = mean + delta / count
        squares = squares + delta * (image - mean)
    return mean, squares / (count - 1) / count


def fold(folder, options):
    """Without numpy the batches stay."""
    batches = folder.entries["reference"]
    if not numpy or len(batches) < 2 or options.first_batch:
        return
    lines = [batches[index] for index in sorted(batches)]
    samples = lines[0]["samples"]
    entry = {"seed": lines[0]["seed"], "folded_seeds": [line["seed"] for line in lines], "sample_index": lines[0]["sample_index"],
             "samples": samples * len(lines), "wish": wish_of(options), "seconds": sum(line["seconds"] for line in lines),
             "cpu_seconds": len(lines) * statistics.median(line["cpu_seconds"] for line in lines)}
    data = numpy.concatenate(mean_and_variance(folder, sorted(batches))).astype("<f4")
    folder.replace("reference", [(data.tobytes(), entry)], "reference_folded_%d.f32")
