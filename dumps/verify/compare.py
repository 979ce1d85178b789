#!/usr/bin/env python3
"""Compare two recordings of one scene, for instance by two renderers.

    python3 dumps/verify/compare.py cycles.spool mitsuba.spool

Do they show the same picture? That is asked of the references, with their variances. How noisy is a sample, and
what does it cost? Exit codes: 0 printed, 1 they are not two recordings of one picture size, 3 not readable.
"""
import argparse
import json
import os
import sys

sys.path.insert(0, os.path.abspath(os.path.join(__file__, "..", "..", "..")))
sys.path.insert(1, os.path.join(sys.path[0], "formats", "python"))

from dumps.recording.failure import guarded, module_failure, scene_failure

try:
    import numpy as np

    import spool
    from dumps.verify.reference_agreement import LUMINANCE, luminance_variance
except ImportError as error:
    if __name__ != "__main__":
        raise
    print("compare: %s" % module_failure(error, "reads a recording", "dumps/verify/compare.py"), file=sys.stderr)
    sys.exit(3)

BLOCK = 8                # pixels along a side, of a smaller picture its own; pixels that are clearly different are few and lie together


def compare(first, second):
    """{figure: value}; where two are given, of the first and of the second recording."""
    with spool.open(first) as a, spool.open(second) as b:
        if (a.width, a.height) != (b.width, b.height):
            raise scene_failure("%s has %dx%d pixels, %s has %dx%d: record both at one size" % (
                first, a.width, a.height, second, b.width, b.height))
        for name, dump in ((first, a), (second, b)):
            if "reference_variance" not in dump.layers:
                raise scene_failure("%s: no reference with its variance: record one (--reference 4096)" % name)
        pictures = [dump.pixel("reference").astype(float) @ LUMINANCE for dump in (a, b)]
        errors = [luminance_variance(dump.pixel("reference_variance").astype(float)) for dump in (a, b)]
        samples = [np.nan_to_num(dump.read("radiance").astype(float)) @ LUMINANCE for dump in (a, b)]
        out = agreement(pictures, errors)
        noise = [float(s.var(axis=2, ddof=1).mean()) for s in samples]
        costs = [dump.meta.get("cost_per_sample") for dump in (a, b)]
        out.update(samples_mean=[float(s.mean()) for s in samples], sample_variance=noise,
                   largest_sample=[float(s.max()) for s in samples],
                   dark_samples=[float((s <= 0).mean()) for s in samples], cost_per_sample=costs)
        if all(costs):
            out["variance_times_cost"] = [n * c for n, c in zip(noise, costs)]
        out["features"] = {name: feature_difference(a, b, name) for name in ("albedo", "normal")
                           if name in a.layers and name in b.layers}
        return out


def agreement(pictures, errors):
    one, two = pictures
    variance = errors[0] + errors[1]
    ratio = two.sum() / one.sum()
    deviation = np.sqrt((errors[1].sum() / two.sum() ** 2) + errors[0].sum() / one.sum() ** 2) * ratio
    side = min(BLOCK, *one.shape)
    blocks = [block_means(p, side) for p in (one, two, variance)]
    sigma = np.sqrt(blocks[2]) / side                      # of a mean of independent pixels
    relative = np.abs(blocks[1] - blocks[0]) / np.maximum(blocks[0], 1e-9)
    return {"mean": [float(one.mean()), float(two.mean())], "energy_ratio": float(ratio),
            "energy_ratio_error": float(deviation), "blocks": int(relative.size), "block_side": side,
            "block_difference_median": float(np.median(relative)),
            "block_difference_90_percent": float(np.quantile(relative, 0.9)),
            "blocks_within_3_sigma_or_2_percent": float(
                ((np.abs(blocks[1] - blocks[0]) < 3 * sigma) | (relative < 0.02)).mean())}


def block_means(image, side):
    height, width = (n // side * side for n in image.shape)
    return image[:height, :width].reshape(height // side, side, width // side, side).mean(axis=(1, 3))


def feature_difference(a, b, name):
    """Mean distance between the pixels' mean features, in units of their spread over the picture."""
    one, two = (dump.read(name).astype(float).mean(axis=2) for dump in (a, b))
    return float(np.abs(one - two).mean() / max(one.std(), 1e-9))


def told(names, found):
    pair = ["%-28s %-22s %-22s %s" % ("", os.path.basename(names[0]), os.path.basename(names[1]), "second / first")]
    for key in ("mean", "samples_mean", "sample_variance", "largest_sample", "dark_samples", "cost_per_sample",
                "variance_times_cost"):
        if key in found and None not in found[key]:
            one, two = found[key]
            pair.append("%-28s %-22.4g %-22.4g %s" % (key.replace("_", " "), one, two,
                                                      "%.4g" % (two / one) if one else ""))
    return pair + [
        "energy of the references     second is %.4f of the first, +- %.4f" % (found["energy_ratio"],
                                                                              found["energy_ratio_error"]),
        "blocks of %dx%d pixels         differ by %.2f %% (median), %.2f %% (nine tenths); %.1f %% of %d within "
        "3 standard errors or 2 %%" % (found["block_side"], found["block_side"], 100 * found["block_difference_median"],
                                      100 * found["block_difference_90_percent"],
                                      100 * found["blocks_within_3_sigma_or_2_percent"], found["blocks"]),
    ] + ["%-28s means differ by %.4f of their spread" % (name, value) for name, value in found["features"].items()]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("first")
    parser.add_argument("second")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    found = compare(options.first, options.second)
    print(json.dumps(found, indent=1) if options.json else "\n".join(told((options.first, options.second), found)))


if __name__ == "__main__":
    sys.exit(guarded(main))
