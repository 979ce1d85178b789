"""From the chunks of a recording to its files: written, tested, and only then named."""
import os
import sys
from collections import namedtuple

from dumps.mitsuba.output import metadata, write_file
from dumps.recording.failure import usage_failure
from dumps.recording.recordings import group_meta, names

# What a recording is made of. chunks: of all recordings, one after the other; cut: how one of them is cut.
Parts = namedtuple("Parts", "mi recordable tracer layers chunks cut")


def finish(options, parts, numbers, reference):
    """[(file, findings)]; findings are empty where no test was wanted. numbers: counts for the claim on random numbers."""
    chunks, outs, done = parts.chunks, names(options.out, options.recordings), []
    chunks.save_numbers(numbers, [options.reference, options.auto])
    made_of = [parts.recordable.digest, options.seed, options.samples, options.reference, parts.mi.variant(), parts.mi.__version__]
    for number in range(len(outs)):
        path = chunks.whole_name(number)
        group = group_meta(options.out, options.recordings, number, made_of)
        if not chunks.is_whole(number):
            remark = _write(path, options, parts, number, {"random_numbers": numbers, **group}, reference)
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


def _write(path, options, parts, number, meta, reference):
    chunks, cut = parts.chunks, parts.cut
    first = number * len(cut.parts)
    seconds = sum(chunks.seconds(first + index) for index in range(len(cut.parts)))
    meta = {**metadata(options, parts.mi, parts.recordable, parts.tracer, cut, seconds, first), **meta}
    return write_file(path, options, meta, parts.tracer, parts.layers, chunks, cut, reference, first)


def _tested(path):
    from dumps.verify.verify import keep_verification, verify
    found = verify(path)
    keep_verification(path, found)
    return found["findings"]
