"""How many samples a reference needs: `--reference auto` ends it, or a part of it, when its standard error suffices.

Two things in an error are the reference's own. The squared error has its variance, whose mean is subtracted, so that its share
beside the error of BUDGET samples, BUDGET / n, only has to be small: LEAST samples make it 1 %. relMSE divides by the reference,
and nothing subtracts that noise: the mean of variance / (reference^2 + EPSILON) must fall below DENOMINATOR, from where on ratios
of relMSE are off by 1 % (docs/decisions/0156; three times as much, and there is no verdict).

It is judged at LEAST, 2 LEAST, 4 LEAST ... samples by a mean over many pixels, so that the luck of a pixel hardly decides when
that pixel ends.
"""
from dumps.recording.failure import usage_failure

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
