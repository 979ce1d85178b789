"""Writes docs/coverage.md, how often 95 % intervals hold the truth: tools/dev.sh bench coverage [TRIALS]."""
import json
import math
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
PAGE = ROOT / "docs" / "coverage.md"

TEXT = """# How often the 95 % intervals hold the truth

Written by `tools/dev.sh bench coverage`. Every trial makes another recording of the scene, 64 samples a pixel, and evaluates it
as `spool evaluate` does: by default 8 replicates on one ring of samples, intervals of logarithms, widened where replicates share
samples ([decision 70](decisions/0070-what-an-interval-is-about.md)). Pictures are {side} x {side} pixels; recordings of the tree serve as
distributions whose samples are drawn with replacement. The truth is the mean over all trials. Of {trials} trials, an
interval that is right covers in 95 % +- {noise:.1f} (one standard deviation of the count); wanted are 93 to 97 %.

{summary}

{table}

"Real spread" is the standard deviation of the estimate over recordings, relative to the standard error that the interval is
made of: 1 where the error is right, above 1 where it is too small.

## As it was done before

Five replicates that each shuffle the same samples, arithmetic means, Student's interval as if they were independent: about the
order of the samples, read as if it were about the scene. At 16 samples of 64. "shuffled, widened" are the same replicates
judged as they are today (`order = "shuffled"`): by logarithms, with what 16/64 and more of common samples make alike allowed for.

{before}

## Verdicts

Of all pairs of the three methods, decided together at 5 % (Holm): how many are told apart, and how many of these the wrong
way round. False verdicts: a method compared with itself on another recording, at 5 % each.

{verdicts}

## What forbids more

{limits}
"""

LIMITS = """- Where samples have a tail of infinite variance, the logarithm of an error of eight replicates still has a mean and the interval
  is about that mean. The expectation of the squared error itself does not exist there, and no interval can hold it
  [BahadurSavage56].
- Replicates that share samples are alike by how heavy the tail of the samples is
  ([decision 86](decisions/0086-rare-events-share-as-a-whole.md)). Where an adaptive sampler takes the samples of the next
  replicates, its ratio to `uniform` varies less among recordings than independent replicates would: there intervals cover more than
  they say.
- In the scene with fireflies a picture of 256 pixels at 4 samples holds one firefly or none, so its error has two values and
  eight replicates seldom show both: 79 % is what Student's interval gives of such a distribution. Larger pictures hold many.
- The truth is a mean over the trials: it has 1 / sqrt(trials) of the spread of one."""


def cover(row):
    share = 100 * row["covered"] / row["trials"]
    return f"{share:.1f} %" + ("" if 93 <= share <= 97 else " (outside)")


def rows_of(world, before):
    return [r for r in world["rows"] if (r["interval"].startswith(("before", "shuffled"))) == before]


def summary(worlds):
    """What the table says, in two sentences: scenes whose tails allow an interval, and the others."""
    heavy = [w for w in worlds if "fireflies" in w["world"] or "tail" in w["world"]]
    shares = {id(w): [100 * r["covered"] / r["trials"] for r in rows_of(w, False)] for w in worlds}
    usual = [c for w in worlds if w not in heavy for c in shares[id(w)]]
    inside = sum(93 <= c <= 97 for c in usual)
    lines = [f"Of the {len(usual)} rows of {', '.join(w['world'].split(',')[0] for w in worlds if w not in heavy)}, {inside} are inside; "
             f"the least is {min(usual):.1f} %, the most {max(usual):.1f} %."]
    lines += [f"{w['world'][0].upper()}{w['world'][1:]}: {min(shares[id(w)]):.0f} to {max(shares[id(w)]):.0f} %." for w in heavy]
    return "\n".join(lines) + " What forbids more there stands below."


def coverage_table(worlds, before):
    lines = ["| scene | interval | of | spp | covers | real spread |", "|---|---|---|---|---|---|"]
    for world in worlds:
        for r in rows_of(world, before):
            lines.append(f"| {world['world']} | {r['interval'].removeprefix('before: ')} | {r['of']} | {r['spp']:g} | {cover(r)} "
                         f"| {r['spread_over_error']:.2f} |")
    return "\n".join(lines)


def verdict_table(worlds):
    lines = ["| scene | spp | pairs told apart | of these the wrong way round | false verdicts |", "|---|---|---|---|---|"]
    for world in worlds:
        for r in world["verdicts"]:
            lines.append(f"| {world['world']} | {r['spp']:g} | {r['decided']} of {r['pairs']} ({100 * r['decided'] / r['pairs']:.0f} %) "
                         f"| {r['wrong']} | {r['false']} of {r['nulls']} ({100 * r['false'] / r['nulls']:.1f} %) |")
    return "\n".join(lines)


def main():
    program = Path(sys.argv[1]) / "tools" / "bench" / "coverage" / "bench_coverage"
    found = json.loads(subprocess.run([program, *sys.argv[2:]], check=True, capture_output=True, text=True).stdout)
    worlds, trials = found["worlds"], found["worlds"][0]["rows"][0]["trials"]
    PAGE.write_text(TEXT.format(trials=trials, side=found["side"], noise=100 * math.sqrt(0.95 * 0.05 / trials),
                                summary=summary(worlds), table=coverage_table(worlds, False), before=coverage_table(worlds, True),
                                verdicts=verdict_table(worlds), limits=LIMITS), encoding="utf-8")
    print(coverage_table(worlds, False), coverage_table(worlds, True), verdict_table(worlds), sep="\n\n")


if __name__ == "__main__":
    main()
