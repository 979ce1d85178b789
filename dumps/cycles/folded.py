"""A reference that is whole as one file: the mean of its batches and the variance of that mean, as the recording will have them.

64 batches take as much of the disk as 64 passes. A folded reference is of one wish: another one begins it anew.
"""
import statistics
import sys

try:
    import numpy
except ImportError:
    numpy = None


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
