"""What a recording will be: how it is cut into chunks, what it needs and what it costs."""
import time

from dumps.mitsuba.channels import LAYERS
from dumps.mitsuba.seeds import SPARE, chunk_seed
from dumps.recording.plan_layers import unread
from dumps.recording.progress import duration
from dumps.recording.progress import size as size_text
from dumps.recording.reference_need import LEAST, reference_hint

TRIAL_SECONDS = 5.0        # of the trace that the estimate comes from
REFERENCE_BYTES = 24       # a pixel: mean and variance of three channels
BAND_ROWS = 16             # of a reference that ends by itself


class Cut:
    """How a recording is cut into chunks of at most `lanes` samples: `step` samples of a band of rows. auto: in low bands, each of
    which can end by itself where its number of samples is a doubling of LEAST."""

    def __init__(self, tracer, samples, lanes, auto=False):
        if auto:
            rows = max(1, min(tracer.height, BAND_ROWS, lanes // tracer.width))
            self.step = 1 << (min(lanes // (tracer.width * rows), LEAST).bit_length() - 1)
        else:
            self.step = max(1, min(lanes // (tracer.width * tracer.height), samples))
            rows = max(1, min(tracer.height, lanes // (tracer.width * self.step)))
        self.bands = [(y, min(y + rows, tracer.height)) for y in range(0, tracer.height, rows)]
        self.parts = [(first, min(self.step, samples - first), band) for first in range(0, samples, self.step)
                      for band in self.bands]  # (first sample, samples, rows); the place is the chunk's number


def seconds_per_sample(tracer, layers, samples, lanes, seed):
    """Wall time of a sample in chunks as they will be: the more samples at once, the cheaper each."""
    count = 1
    while True:
        cut = Cut(tracer, min(count, samples), lanes)
        rows, step = cut.bands[0], cut.step
        tracer.trace(step, chunk_seed(seed, SPARE), layers, rows)       # compiles the kernels
        started = time.monotonic()
        tracer.trace(step, chunk_seed(seed, SPARE), layers, rows)
        passed = time.monotonic() - started
        if step < count or count >= samples or 4 * passed > TRIAL_SECONDS:
            return max(passed, 1e-9) / (tracer.width * (rows[1] - rows[0]) * step)
        count = min(4 * count, samples)


def describe(options, recordable, tracer, layers, dtypes):
    """Needs of the scene and the price of the recording, from short traces."""
    pixels = tracer.width * tracer.height
    per_sample = sum(int(dtypes[name][1]) * len(LAYERS[name][1]) for name in layers)
    pool = pixels * options.samples * seconds_per_sample(tracer, layers, options.samples, options.chunk_lanes, options.seed)
    reference = 0.0
    if options.reference:
        reference = pixels * options.reference * seconds_per_sample(tracer, ["radiance"], options.reference,
                                                                    options.chunk_lanes, options.seed)
    needs = (("depth of field", recordable.has_lens), ("motion blur", recordable.shutter_time > 0),
             ("volumes", recordable.has_volumes))
    print("scene %s, %d shapes, %dx%d, Mitsuba variant %s" % (recordable.name, len(recordable.shapes), tracer.width,
                                                              tracer.height, tracer.mi.variant()))
    print("needs %s" % ", ".join("%s: %s" % (name, "yes" if needed else "no") for name, needed in needs))
    print("channels %s, %d bytes a sample" % (" ".join(layers), per_sample))
    print("rate %.3g million samples a second" % (pixels * options.samples / pool / 1e6))
    print("estimate %s (%.2f minutes), recording at most %s" % (
        duration(pool + reference), (pool + reference) / 60,
        size_text(per_sample * pixels * options.samples + (REFERENCE_BYTES * pixels if options.reference else 0))))
    for line in reference_hint(options.samples, options.reference, pool, reference, auto=options.auto):
        print(line)
    if options.plan:
        print(unread(options.plan, layers) or "the methods of %s read all layers" % options.plan)
