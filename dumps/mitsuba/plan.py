"""What a recording will be: how it is cut into chunks, what it needs and what it costs."""
import time

from channels import LAYERS
from progress import duration, size as size_text

REFERENCE_SEEDS = 1 << 20  # pool: (seed << 21) + chunk, reference: the same + 2^20


class Cut:
    """How a recording is cut into chunks of at most `lanes` samples: `step` samples of a band of rows."""

    def __init__(self, tracer, samples, lanes):
        pixels = tracer.width * tracer.height
        self.step = max(1, min(lanes // pixels, samples))
        rows = max(1, min(tracer.height, lanes // (tracer.width * self.step)))
        self.bands = [(y, min(y + rows, tracer.height)) for y in range(0, tracer.height, rows)]
        self.parts = [(first, min(self.step, samples - first), band) for first in range(0, samples, self.step)
                      for band in self.bands]  # (first sample, samples, rows); the place is the chunk's number


def describe(options, recordable, tracer, layers):
    """Needs of the scene and the price of the recording, from a short trace."""
    pixels = tracer.width * tracer.height
    per_sample = sum(int(LAYERS[name][0][1]) * len(LAYERS[name][1]) for name in layers)
    cut = Cut(tracer, min(4, options.samples), options.chunk_lanes)
    rows, count = cut.bands[0], cut.step
    unused_seed = (options.seed << 21) + REFERENCE_SEEDS - 1
    tracer.trace(count, unused_seed, layers, rows)       # compiles the kernels
    started = time.monotonic()
    tracer.trace(count, unused_seed, layers, rows)
    rate = tracer.width * (rows[1] - rows[0]) * count / max(time.monotonic() - started, 1e-9)
    seconds = pixels * (options.samples + options.reference) / rate
    needs = (("depth of field", recordable.has_lens), ("motion blur", recordable.shutter_time > 0),
             ("volumes", recordable.has_volumes))
    print("scene %s, %d shapes, %dx%d, Mitsuba variant %s" % (recordable.name, len(recordable.shapes), tracer.width,
                                                              tracer.height, tracer.mi.variant()))
    print("needs %s" % ", ".join("%s: %s" % (name, "yes" if needed else "no") for name, needed in needs))
    print("channels %s, %d bytes a sample" % (" ".join(layers), per_sample))
    print("rate %.3g million samples a second" % (rate / 1e6))
    reference_bytes = 24 * pixels if options.reference else 0
    print("estimate %s (%.2f minutes), dump at most %s" % (
        duration(seconds), seconds / 60, size_text(per_sample * pixels * options.samples + reference_bytes)))
