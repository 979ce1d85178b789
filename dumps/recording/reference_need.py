"""How many samples a reference needs: `--reference auto` ends it, or a part of it, when its standard error suffices.

Two things in an error are the reference's own. The squared error has its variance, whose mean is subtracted, so that its share
beside the error of BUDGET samples, BUDGET / n, only has to be small: LEAST samples make it 1 %. relMSE divides by the reference,
and nothing subtracts that noise: the mean of variance / (reference^2 + EPSILON) must fall below DENOMINATOR, from where on ratios
of relMSE are off by 1 % (docs/decisions/0156; three times as much, and there is no verdict).

It is judged at LEAST, 2 LEAST, 4 LEAST ... samples by a mean over many pixels, so that the luck of a pixel hardly decides when
that pixel ends.
"""
from dumps.recording.failure import usage_failure
from dumps.recording.progress import duration

BUDGET, LEAST, MOST, EPSILON, DENOMINATOR = 4, 512, 16384, 0.01, 0.003


def parse_reference(text):
    """'4096', 'auto' or 'auto:65536' -> (largest number of samples, whether it ends by itself)"""
    kind, colon, most = text.partition(":")
    auto = kind == "auto"
    number = most if colon and auto else str(MOST) if auto else text
    if not (number.isascii() and number.isdigit()) or int(number) > 1 << 24:
        raise usage_failure("--reference %s: give a number of samples up to %d, auto or auto:MOST" % (text, 1 << 24))
    if auto and int(number) < LEAST:
        raise usage_failure("--reference %s: auto takes %d samples at least" % (text, LEAST))
    if auto:                                    # where it is judged: a doubling of LEAST
        number = LEAST << ((int(number) // LEAST).bit_length() - 1)
    return int(number), auto


def judged_at(samples):
    """Whether a reference that has this many samples is looked at."""
    return samples >= LEAST and samples % LEAST == 0 and samples // LEAST & samples // LEAST - 1 == 0


def denominator_noise(mean, variance):
    """mean, variance of the mean: arrays of one shape, a number for each pixel and channel."""
    return float((variance / (mean * mean + EPSILON)).mean())


def outcome(told, limit):
    """Lines on what became of it. told: what the metadata of the recording contain about its reference."""
    least, most, noise = told["samples_least"], told["samples_most"], told["denominator_noise"]
    span = "%d" % most if least == most else "%d to %d, %d in the mean," % (least, most, told["samples"])
    lines = ["reference: %s samples a pixel; the noise of relMSE's denominator is %.2g (aim %g)" % (span, noise, DENOMINATOR)]
    if most >= limit and noise > DENOMINATOR:
        lines.append("it ended at the most that was allowed: --reference auto:%d goes on" % (4 * limit))
    return lines


def reference_hint(samples, reference, pool_seconds, reference_seconds, smaller=None, auto=False):
    """Lines on what the reference costs, and a smaller one would save and cost: its own variance stands in every squared error, and
    beside the mean of the whole pool, the best that can be judged, it has a share of samples / reference. smaller: about a quarter,
    where a recorder cannot make every number (default: a quarter)."""
    if not reference:
        return ["no reference: methods can only be judged against the pool itself (--reference 4096)"]
    if auto:
        return ["the reference takes at most %s (%d samples) and ends where it suffices" % (duration(reference_seconds), reference)]
    lines = ["the reference takes %s; its own noise adds %.3g %% to the squared error of a mean of all %d samples" % (
        duration(reference_seconds), 100 * samples / reference, samples)]
    smaller = reference // 4 if smaller is None else smaller
    if smaller >= samples and reference_seconds > pool_seconds:
        lines.append("--reference %d would save %s and add %.3g %%" % (
            smaller, duration(reference_seconds * (1 - smaller / reference)), 100 * samples / smaller))
    return lines
