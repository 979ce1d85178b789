"""Pool and reference agree within their errors, and do not share samples.

Judged by sums over the image: squared differences against what the variances predict. A pixel's own quotient
would be spoiled by skewed samples, whose variance is underestimated exactly where their mean is low; both
sums are unbiased. Weights 1 / (brightness^2 + 0.01) keep bright pixels from deciding alone. The brightness is the
mean of pool and reference by their precision, the one mean whose error is uncorrelated with their difference.
"""
from math import inf, sqrt

import numpy as np

from dumps.verify.finding import finding
from dumps.verify.independence import of_few, two_sided
from spool.save import is_mean_of, other_picture

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
BLOCK, RESAMPLES, SEED = 8, 400, 1987


def reference_findings(dump, radiance, level):
    if "reference" not in dump.layers:
        return [finding("reference", None, "not recorded", "independent samples of the same scene")]
    reference = dump.pixel("reference").astype(np.float64)
    if not np.isfinite(reference).all():
        return [finding("reference finite", False, "%d values are not" % (~np.isfinite(reference)).sum(), "all")]
    count = radiance.shape[2]
    samples = radiance.astype(np.float64)
    if is_mean_of(samples, reference):
        return [finding("reference error", False, "the reference is the mean of these samples", "one of other samples")]
    if "reference_variance" not in dump.layers and (found := other_picture(samples, reference)):
        return [finding("reference agrees", False, found, "the same picture")]
    if "reference_variance" not in dump.layers or count < 8:
        return [finding("reference agrees", None, "no variance, or fewer than 8 samples", "both")]
    variance = dump.pixel("reference_variance").astype(np.float64)
    if not np.isfinite(variance).all():
        return [finding("reference variance finite", False, "%d values are not" % (~np.isfinite(variance)).sum(), "all")]
    expected = samples.var(axis=2, ddof=1) / count + variance
    difference = samples.mean(axis=2) - reference
    # One share for the picture: a pixel's own variances follow its noise and would bring the correlation back.
    share = variance.sum() / max(expected.sum(), np.finfo(float).tiny)
    weight = 1 / (((reference + share * difference) @ LUMINANCE) ** 2 + 0.01)[..., None]
    measured, predicted = blocks(weight * difference ** 2), blocks(weight * expected)
    if predicted.sum() == 0:
        return [finding("reference agrees", bool(np.abs(difference).max() < 1e-4), "largest difference %.3g" %
                        np.abs(difference).max(), "0")]
    ratio = measured.sum() / predicted.sum()
    if len(measured) < 2:
        error, p = inf, 1.0
    else:
        error = max(bootstrap_error(measured, predicted), 1e-9)
        p = of_few((ratio - 1) / error, len(measured) - 1)
    if dump.sample_order != "exchangeable" and ratio < 1:
        found = [finding("reference error", None, "%.3f of the predicted one" % ratio, "any below 1", p,
                         "the prediction is for independent samples, a sequence may do better")]
    else:
        found = [finding("reference error", bool(p > level), "%.3f of the predicted one" % ratio, "1", p,
                         visible_share(error, level, count, len(measured) - 1, dump.meta) if p > level else
                         "less: shared samples; more: another scene, filter or camera")]
    grey = (samples @ LUMINANCE).var(axis=2, ddof=1) / count + luminance_variance(variance)
    z = float((difference @ LUMINANCE).sum() / np.sqrt(grey.sum()))
    shared = dump.layers.get("film") is not None and dump.layers["film"].scope == "pass"
    p = two_sided(z)
    found.append(finding("reference energy", None if shared else bool(p > level), "%.2f standard errors" % z, "0", p,
                         "pixels share film positions: their errors are not independent" if shared else ""))
    return found


def luminance_variance(variance):
    """The most that the variances of the channels allow. Light is often grey: its channels go up and down together."""
    return (np.sqrt(variance) @ LUMINANCE) ** 2


def visible_share(error, level, count, freedom, meta):
    """The smallest share of the pool's samples in the reference that this quotient would show (shared_numbers.py)."""
    samples = (meta.get("reference") or {}).get("samples")
    if not samples:
        return ""
    deviations = next((z / 100 for z in range(100, 10000) if freedom and of_few(z / 100, freedom) < level), inf)
    share = deviations * error * (samples + count) / (2 * samples)
    return "shared samples would show from %.2g of the reference on" % share if share < 1 else "too noisy to show shared samples"


def blocks(image):
    """Sums over BLOCK x BLOCK pixels and all channels; ragged blocks at the right and bottom count too."""
    rows = np.add.reduceat(image.sum(axis=2), np.arange(0, image.shape[0], BLOCK), axis=0)
    return np.add.reduceat(rows, np.arange(0, image.shape[1], BLOCK), axis=1).ravel()


def bootstrap_error(measured, predicted):
    """Standard error of the quotient of sums, from resampled blocks, at least two."""
    pick = np.random.default_rng(SEED).integers(0, len(measured), (RESAMPLES, len(measured)))
    below = predicted[pick].sum(axis=1)
    return float((measured[pick].sum(axis=1)[below > 0] / below[below > 0]).std(ddof=1)) * sqrt(len(measured) / (len(measured) - 1))
