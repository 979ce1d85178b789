"""Does the reference draw random numbers of its own?

A reference that holds some of the pool's samples judges too kindly, and the difference of the two means shows it
badly: with a share f of the reference's samples taken from the pool, its square is 1 - 2f N / (N + n) of what it should
be (pool n, reference N samples), lost in noise for small f. The numbers themselves are exact: a sample begins with its
place in the pixel, and 2 x 23 random bits seldom fall alike by chance. So a recorder keeps the places of the pool's
samples in some pixels, looks for each in the reference's, and writes the counts into `random_numbers` of the metadata.
"""
from math import gcd

import numpy as np

from dumps.verify.finding import finding

PIXELS = 4096            # looked at, of a larger picture
LARGEST_SHARE = 1e-4     # chance gives 1e-8: 2^20 places of the pool among 2^46


def chosen_pixels(width, height):
    """Indices y * width + x, evenly spread; the step shares no factor with the width, so that they lie in all columns."""
    step = (width * height + PIXELS - 1) // PIXELS
    while gcd(step, width) > 1:
        step += 1
    return np.arange(0, width * height, step)


def marks(film, rows, pixels):
    """Bits of the places of the samples in those of the pixels that lie in rows [first, end); film: [y][x][s][2] float32."""
    width = film.shape[1]
    inside = pixels[(pixels >= rows[0] * width) & (pixels < rows[1] * width)] - rows[0] * width
    chosen = np.ascontiguousarray(film.reshape(-1, *film.shape[2:])[inside], dtype="<f4")
    return chosen.view("<u8").ravel()


def repeated(values):
    """How many of the sorted values stood among them before."""
    return int((values[1:] == values[:-1]).sum())


def found_again(values, known):
    """How many of the values are among the sorted known ones."""
    if not len(known):
        return 0
    at = np.minimum(np.searchsorted(known, values), len(known) - 1)
    return int((known[at] == values).sum())


def shared_number_findings(meta):
    """meta of a recording; `random_numbers`: {pool, pool_repeated, reference, reference_repeated}, counts of samples."""
    told, found = meta.get("random_numbers"), []
    if not isinstance(told, dict):
        return found
    for kind, what in (("pool", "numbers of the pool"), ("reference", "numbers of the reference")):
        count, again = told.get(kind, 0), told.get(kind + "_repeated", 0)
        if count:
            found.append(finding(what, again <= LARGEST_SHARE * count, "%d of %d drawn before" % (again, count), "none",
                                 note="" if again <= LARGEST_SHARE * count else "samples are not independent: two seeds start one "
                                 "sequence" if kind == "pool" else "a share of %.3g of the reference is the pool" % (again / count)))
    return found
