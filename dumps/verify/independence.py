"""Are the samples of a pixel exchangeable, and is s^2/n the variance of their mean?

Statistics are taken on x / (1 + x) of the luminance, so that fireflies do not decide, after each pixel was
brought to mean 0 and variance 1. Their mean and spread under the claim come from permuting the sample indices,
one permutation for all pixels: that keeps whatever pixels share (a film position, in shifted recordings). The
p-value is the normal one for that mean and spread; a count of permutations could not resolve the small
significance of one test among many.
"""
import hashlib
from functools import partial
from math import erfc, log1p, sqrt

import numpy as np

from dumps.verify.finding import finding

PERMUTATIONS = 400
WINDOW = 1024            # samples whose order is permuted together, and rows of a Gram matrix
SEED = 20090807
LEAST_BITS = 64          # of evidence that two equal images are no chance; 65536 samples make 2^31 pairs


def residuals(radiance):
    """([y][x][s] tone-mapped luminance, mean 0 and variance 1 per pixel, 0 where a pixel is constant; [y][x] where it is not)"""
    value = np.maximum(radiance.astype(np.float64) @ np.array([0.2126, 0.7152, 0.0722]), 0)
    value = value / (1 + value)
    value = value - value.mean(axis=2, keepdims=True)
    sigma = np.sqrt((value ** 2).sum(axis=2, keepdims=True) / (value.shape[2] - 1))
    return np.where(sigma > 1e-6, value / np.maximum(sigma, 1e-6), 0), sigma[..., 0] > 1e-6


# Both statistics are sums over entries of the Gram matrix of the samples, which a permutation only reorders: a permutation costs the
# entries it looks at, not a pass over all pixels.


def group_variance(gram, pixels, order, size):
    """size * variance of the means of `size` consecutive samples of `order`, over pixels: 1 for independent samples."""
    groups = order[:len(order) // size * size].reshape(-1, size)
    squares = gram[groups[:, :, None], groups[:, None, :]].sum()      # of the sums of the groups, over pixels
    total = gram[np.ix_(groups.ravel(), groups.ravel())].sum() if groups.size < len(gram) else gram.sum()
    return float((squares - total / len(groups)) / (len(groups) - 1) / size / pixels)


def lag_correlation(gram, pixels, order, lag):
    return float(gram[order[:-lag], order[lag:]].mean() / pixels)


def permutation_test(grams, pixels, statistic, seed):
    """(value, mean under the claim, two-sided p-value); means over windows of samples, each with its Gram matrix."""
    rng, value, null = np.random.default_rng(seed), 0.0, np.zeros(PERMUTATIONS)
    for gram in grams:
        value += statistic(gram, pixels, np.arange(len(gram))) / len(grams)
        null += [statistic(gram, pixels, rng.permutation(len(gram))) / len(grams) for _ in range(PERMUTATIONS)]
    center = float(null.mean())
    return value, center, two_sided((value - center) / max(float(null.std(ddof=1)), 1e-12))


def two_sided(z):
    return erfc(abs(z) / sqrt(2))


def of_few(t, freedom):
    """Two-sided p-value of Student's t, by Wallace's normal approximation of 1959."""
    return two_sided((8 * freedom + 1) / (8 * freedom + 3) * sqrt(freedom * log1p(t * t / freedom)))


def repeated_images(radiance):
    """[(first, again)] of sample indices whose whole images are equal, at any lag."""
    first_of, pairs = {}, []
    for s in range(radiance.shape[2]):
        image = hashlib.blake2b(np.ascontiguousarray(radiance[:, :, s]).tobytes(), digest_size=16).digest()
        if image in first_of:
            pairs.append((first_of[image], s))
        first_of.setdefault(image, s)
    return pairs


def chance_bits(radiance):
    """-log2 of the chance that two independent images are equal: per pixel from how often neighbours in the sequence are."""
    count = radiance.shape[2]
    equal = (radiance[:, :, 1:] == radiance[:, :, :-1]).all(axis=3).sum(axis=2)
    return float(-np.log2((equal + 1) / count).sum())


def repetition_finding(radiance, claimed):
    """Independent samples repeat a whole image only where few pixels are noisy; then equality proves nothing."""
    pairs = [(a, b) for a, b in repeated_images(radiance) if (radiance[:, :, a] != radiance[:1, :1, a]).any()]   # not of one colour
    evident = bool(pairs) and chance_bits(radiance) >= LEAST_BITS
    note = "" if not evident else "image %d is image %d%s: a seed started again" % (
        pairs[0][1], pairs[0][0], "" if claimed else "; the header claims renderer order only")
    return finding("images differ", not evident if claimed else None if evident else True,
                   "%d of %d are repeated" % (len(pairs), radiance.shape[2]), "none", note=note)


def independence_findings(radiance, claimed, level):
    """level: significance of each test after correction. claimed: what the header says (exchangeable)."""
    count = radiance.shape[2]
    if count < 8:
        return [finding("independence", None, "%d samples" % count, "at least 8")]
    e, noisy = residuals(radiance)
    e = e[noisy]
    if not len(e):
        return [finding("independence", None, "every pixel is constant", "noise to look at")]
    if len(e) > 4096:  # enough for correlations of 1e-3
        e = e[np.random.default_rng(SEED).choice(len(e), 4096, replace=False)]
    grams = [part.T @ part for part in np.array_split(e, -(-count // WINDOW), axis=1)]
    tests = [("variance of %d-means" % size, partial(group_variance, size=size)) for size in (4, 16) if count // size >= 4]
    tests += [("correlation at lag %d" % lag, partial(lag_correlation, lag=lag)) for lag in (1, 2, 4)]
    found = []
    for index, (name, statistic) in enumerate(tests):
        value, center, p = permutation_test(grams, len(e), statistic, SEED + index)
        holds = p > level if claimed else None
        note = "" if claimed else "the header claims renderer order only"
        found.append(finding(name, holds, "%.4f" % value, "%.4f" % center, p, note))
    return found


def neighbour_finding(radiance, shared_film, level):
    """Correlation of horizontally neighbouring pixels within a sample index; error from its spread over indices."""
    height, width, count, _ = radiance.shape
    if width < 2 or count < 8:
        return finding("neighbour correlation", None, "%dx%d, %d samples" % (width, height, count), "more of them")
    e, noisy = residuals(radiance)
    both = noisy[:, 1:] & noisy[:, :-1]
    if not both.any():
        return finding("neighbour correlation", None, "no noisy neighbours", "noise to look at")
    products = (e[:, 1:] * e[:, :-1])[both].mean(axis=0)  # [s]
    mean, error = products.mean(), products.std(ddof=1) / np.sqrt(count)
    p = of_few(mean / max(error, 1e-12), count - 1)
    if shared_film:
        return finding("neighbour correlation", None, "%.4f" % mean, "any", p,
                       "all pixels of a sample share their film position")
    return finding("neighbour correlation", bool(p > level), "%.4f" % mean, "0", p)
