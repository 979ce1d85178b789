"""Film positions are uniform in the pixel: no pixel-centre trap, no renderer filter in them."""
import numpy as np

from dumps.verify.finding import finding


def film_findings(dump, window, level):
    layer = dump.layers.get("film")
    if layer is None:
        return [finding("film positions", None, "not recorded", "uniform in the pixel")] + index_findings(dump)
    xy = dump.passes("film") if layer.scope == "pass" else dump.read("film", *window).reshape(-1, 2)
    lost = int((~np.isfinite(xy)).any(axis=1).sum())
    if lost:
        return [finding("film inside the pixel", False, "%d of %d are not finite" % (lost, len(xy)), "0 .. 1")]
    found = [finding("film inside the pixel", bool(xy.min() >= 0 and xy.max() < 1),
                     "%.4f .. %.4f" % (xy.min(), xy.max()), "0 .. 1")]
    spread = float(xy.std(axis=0).min())
    found.append(finding("no pixel-centre trap", bool(spread > 0.05), "spread %.4f" % spread, "0.2887"))
    for axis, name in enumerate("xy"):
        p = kolmogorov(np.sort(xy[:, axis].astype(np.float64)))
        found.append(finding("film %s uniform" % name, bool(p > level), "spread %.4f" % xy[:, axis].std(), "0.2887", p))
    return found


def index_findings(dump):
    """Without film positions, what the renderer was asked for: Cycles shoots index 0 through the centre."""
    first = dump.meta.get("sample_index")
    if dump.meta.get("renderer") != "Cycles" or first is None:
        return []
    return [finding("no pixel-centre trap", bool(np.min(first) > 0), "first sample index %d" % np.min(first),
                    "above 0, which is the pixel's centre")]


def kolmogorov(ordered):
    """p-value of the two-sided Kolmogorov-Smirnov test against the uniform distribution (asymptotic series)."""
    n = len(ordered)
    steps = np.arange(n)
    d = max((ordered - steps / n).max(), ((steps + 1) / n - ordered).max())
    t = d * (np.sqrt(n) + 0.12 + 0.11 / np.sqrt(n))
    k = np.arange(1, 101)
    return float(np.clip(2 * ((-1.0) ** (k - 1) * np.exp(-2 * (k * t) ** 2)).sum(), 0, 1)) if t > 0.2 else 1.0
