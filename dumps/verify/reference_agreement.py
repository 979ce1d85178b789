"""Pool and reference agree within their errors, and do not share samples.

Judged by sums over the image: squared differences against what the variances predict. A pixel's own quotient
would be spoiled by skewed samples, whose variance is underestimated exactly where their mean is low; both
sums are unbiased. Weights 1 / (brightness^2 + 0.01) keep bright pixels from deciding alone. The brightness is the
mean of pool and reference by their precision, the one mean whose error is uncorrelated with their difference.
"""
import numpy as np

from dumps.verify.finding import finding
from dumps.verify.independence import two_sided

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
BLOCK, RESAMPLES, SEED = 8, 400, 1987


def reference_findings(dump, radiance, level):
    if "reference" not in dump.layers:
        return [finding("reference", None, "not recorded", "independent samples of the same scene")]
    reference = dump.pixel("reference").astype(np.float64)
    if not np.isfinite(reference).all():
        return [finding("reference finite", False, "%d values are not" % (~np.isfinite(reference)).sum(), "all")]
    count = radiance.shape[2]
    if "reference_variance" not in dump.layers or count < 8:
        return [finding("reference agrees", None, "no variance, or fewer than 8 samples", "both")]
    variance = dump.pixel("reference_variance").astype(np.float64)
    if not np.isfinite(variance).all():
        return [finding("reference variance finite", False, "%d values are not" % (~np.isfinite(variance)).sum(), "all")]
    samples = radiance.astype(np.float64)
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
    error = max(bootstrap_error(measured, predicted), 1e-9)
    p = two_sided((ratio - 1) / error)
    if dump.sample_order != "exchangeable" and ratio < 1:
        found = [finding("reference error", None, "%.3f of the predicted one" % ratio, "any below 1", p,
                         "the prediction is for independent samples, a sequence may do better")]
    else:
        found = [finding("reference error", bool(p > level), "%.3f of the predicted one" % ratio, "1", p,
                         visible_share(error, level, count, dump.meta) if p > level else
                         "less: shared samples; more: another scene, filter or camera")]
    z = float((difference @ LUMINANCE).sum() / np.sqrt((expected @ LUMINANCE ** 2).sum()))
    shared = dump.layers.get("film") is not None and dump.layers["film"].scope == "pass"
    p = two_sided(z)
    found.append(finding("reference energy", None if shared else bool(p > level), "%.2f standard errors" % z, "0", p,
                         "pixels share film positions: their errors are not independent" if shared else ""))
    return found


def visible_share(error, level, count, meta):
    """The smallest share of the pool's samples in the reference that this quotient would show (shared_numbers.py)."""
    samples = (meta.get("reference") or {}).get("samples")
    if not samples:
        return ""
    deviations = next(z / 100 for z in range(100, 1000) if two_sided(z / 100) < level)
    share = deviations * error * (samples + count) / (2 * samples)
    return "shared samples would show from %.2g of the reference on" % share if share < 1 else "too noisy to show shared samples"


def blocks(image):
    """Sums over BLOCK x BLOCK pixels and all channels; ragged blocks at the right and bottom count too."""
    rows = np.add.reduceat(image.sum(axis=2), np.arange(0, image.shape[0], BLOCK), axis=0)
    return np.add.reduceat(rows, np.arange(0, image.shape[1], BLOCK), axis=1).ravel()


def bootstrap_error(measured, predicted):
    """Standard error of the quotient of sums, from resampled blocks."""
    pick = np.random.default_rng(SEED).integers(0, len(measured), (RESAMPLES, len(measured)))
    below = predicted[pick].sum(axis=1)
    return float((measured[pick].sum(axis=1)[below > 0] / below[below > 0]).std(ddof=1))
