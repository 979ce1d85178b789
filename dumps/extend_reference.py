#!/usr/bin/env python3
"""A finished recording takes the reference of another recording of the same scene into its own: nothing is rendered again.

    dumps/record.sh chess --seed 2 --samples 1 --reference 12288 --no-verify -o more.spool      (or dumps/mitsuba/record.py)
    python3 dumps/extend_reference.py chess.spool more.spool

Both references are means of their own samples; the mean of the two by their numbers of samples has the variance
w^2 v + (1 - w)^2 v'. Exit codes: 0 done, 1 not the same scene, 2 wrong use, 3 the system refused, 4 damage.
"""
import os
import sys

sys.path.insert(0, os.path.abspath(os.path.join(__file__, "..", "..")))
sys.path.insert(1, os.path.join(sys.path[0], "formats", "python"))

from dumps.recording.command_line import Parser
from dumps.recording.failure import guarded, module_failure, scene_failure

try:
    import spool
    from dumps.recording.reference_need import denominator_noise
    from dumps.recording.rewritten import rewrite
    from dumps.verify.verify import keep_verification, verify
except ImportError as error:
    print("extend_reference: %s" % module_failure(error, "reads a recording", "dumps/extend_reference.py"), file=sys.stderr)
    sys.exit(3)

SAME = ("scene.sha256", "renderer", "renderer_version", "camera", "frame", "settings", "shutter")


def told(meta, name):
    for key in name.split("."):
        meta = meta.get(key) if isinstance(meta, dict) else None
    return meta


def said(meta, name):
    """As `told`; settings without those that are off, which older recorders did not name."""
    found = told(meta, name)
    return {key: value for key, value in found.items() if value} if isinstance(found, dict) else found


def taken(meta):
    """Seeds of its samples: of each batch with Cycles, of the recordings with Mitsuba."""
    return told(meta, "reference.seeds") or [told(meta, "seeds.user")]


def refuse_other(path, dump, more_path, more):
    for which, one in ((path, dump), (more_path, more)):
        if not {"reference", "reference_variance"} <= set(one.layers) or not told(one.meta, "reference.samples"):
            raise scene_failure("%s: holds no reference with its variance and number of samples: record one with --reference" % which)
    if (dump.width, dump.height) != (more.width, more.height):
        raise scene_failure("%s: is %dx%d, %s is %dx%d: record it with that --size" % (
            more_path, more.width, more.height, path, dump.width, dump.height))
    for name in SAME:
        if said(dump.meta, name) != said(more.meta, name):
            raise scene_failure("%s: %s differs from that of %s: record the same scene in the same way" % (more_path, name, path))
    if told(dump.meta, "scene.sha256") is None:
        raise scene_failure("%s: does not name the scene it is of (scene.sha256): only recordings of dumps/ are extended" % path)
    shared = [seed for seed in taken(more.meta) if seed in taken(dump.meta)]
    if shared:
        raise scene_failure("%s: its reference has samples of seed %s, as that of %s: record it with another --seed" % (
            more_path, shared[0], path))


def extend(path, more_path):
    with spool.open(path) as dump, spool.open(more_path) as more:
        refuse_other(path, dump, more_path, more)
        counts = [one.meta["reference"]["samples"] for one in (dump, more)]
        share = counts[0] / sum(counts)
        mean, variance = (power_mean(dump.pixel(layer), more.pixel(layer), share, power)
                          for layer, power in (("reference", 1), ("reference_variance", 2)))
        reference = {**dump.meta["reference"], "samples": sum(counts), "seeds": taken(dump.meta) + taken(more.meta),
                     "denominator_noise": denominator_noise(mean, variance)}
        for key in ("samples_least", "samples_most", "seconds", "nonfinite"):
            if key in reference and key in more.meta["reference"]:
                reference[key] += more.meta["reference"][key]
    out = path + ".extended"
    rewrite(path, out, {"reference": reference}, {"reference": mean.astype("<f4"), "reference_variance": variance.astype("<f4")}, level=3)
    try:
        found = verify(out)
        keep_verification(out, found, path, force=True)
    finally:
        if os.path.exists(out):
            os.remove(out)
    return reference, found


def power_mean(one, other, share, power):
    return share ** power * one.astype(float) + (1 - share) ** power * other.astype(float)


def main():
    parser = Parser(description=__doc__.split("\n")[0])
    parser.add_argument("dump")
    parser.add_argument("more", help="a recording of the same scene with another seed")
    options = parser.parse_args()
    reference, found = extend(options.dump, options.more)
    print("%s: a reference of %d samples, noise of relMSE's denominator %.2g" % (
        options.dump, reference["samples"], reference["denominator_noise"]))
    return 0 if found["holds"] else 1


if __name__ == "__main__":
    sys.exit(guarded(main, "extend_reference"))
