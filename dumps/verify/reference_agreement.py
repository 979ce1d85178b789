"""Pool and reference agree within their errors, and do not share samples.

The variance of a single sample is taken from the reference (its variance of the mean times its samples): a
pool's own variance is smallest just where its mean happens to be low, which spoils the quotient.
"""
from math import erfc, sqrt

import numpy as np

from finding import finding

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def reference_findings(dump, radiance, level):
    if "reference" not in dump.layers:
        return [finding("reference", None, "not recorded", "independent samples of the same scene")]
    reference = dump.pixel("reference").astype(np.float64)
    if not np.isfinite(reference).all():
        return [finding("reference finite", False, "%d values are not" % (~np.isfinite(reference)).sum(), "all")]
    samples = dump.meta.get("reference", {}).get("samples")
    if "reference_variance" not in dump.layers or not samples:
        return [finding("reference agrees", None, "no variance or no sample count recorded", "both")]
    variance = dump.pixel("reference_variance").astype(np.float64)
    count = radiance.shape[2]
    single = variance * samples
    expected = single / count + variance
    difference = radiance.astype(np.float64).mean(axis=2) - reference
    lit = expected > 1e-12 * (reference ** 2 + 1e-12)
    if not lit.any():
        return [finding("reference agrees", bool(np.abs(difference).max() < 1e-4), "largest difference %.3g" %
                        np.abs(difference).max(), "0")]
    ratio = difference[lit] ** 2 / expected[lit]
    kept = np.sort(ratio)[:len(ratio) - len(ratio) // 100]
    trimmed = float(kept.mean())
    # A squared normal value without its largest 1 % has mean 0.915; heavy tails lower it, never raise it much.
    found = [finding("reference chi-square", bool(0.5 < trimmed < 1.25), "%.3f of the variance (largest 1 %% left out)"
                     % trimmed, "0.6 .. 1.0", note="below 0.5: shared samples; above 1.25: another scene or filter")]
    z = float((difference @ LUMINANCE).sum() / np.sqrt((expected @ LUMINANCE ** 2).sum()))
    p = erfc(abs(z) / sqrt(2))
    shared = dump.meta.get("mode") == "shift"
    found.append(finding("reference energy", None if shared else bool(p > level), "%.2f standard errors" % z, "0", p,
                         "pixels share film positions: their errors are not independent" if shared else ""))
    return found
