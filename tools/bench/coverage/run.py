"""Writes docs/coverage.md, how often 95 % intervals hold the truth: tools/dev.sh bench coverage [TRIALS]."""
import json
import math
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
PAGE = ROOT / "docs" / "coverage.md"
sys.path.insert(0, str(ROOT / "tools" / "report"))
from intervals import mean_interval, paired_difference, paired_ratio  # noqa: E402

TEXT = """# How often the 95 % intervals hold the truth

Written by `tools/dev.sh bench coverage`. Every trial samples, filters and judges five replicates (twenty where the
first column says so) of an analytic scene by its exact reference: scene S with 32 x 32 pixels where only the order is drawn anew, noise in 64 x 64 pixels elsewhere. The truth is exact for unfiltered
fixed counts and is else the mean over all trials. Of {trials} trials, an interval that is right covers in 95 % +- {noise:.1f}
(one standard deviation of the count); wanted are 93 to 97 %.

{table}

Several things vary in what the laboratory measures, and each interval speaks of its own:

- **Intervals over replicates** (the table of `spool evaluate`, the report's figures, ratios and claims) speak of one
  recording: how much does the error vary with the order of its samples? Of another recording of the same scene they
  say too little once a replicate takes a good part of the recorded samples, as replicates then share them.
- **Intervals from pixel blocks and replicates** (`statistics.json`, `spool compare`: paired differences, slopes, samples
  needed) count the samples recorded and the picture too: blocks are drawn as if the picture were one of many of its
  kind. Where blocks of the picture are alike or drawn anew, they are right. On one fixed picture with parts
  unlike each other they are wider than that picture alone asks for.
- **Fireflies** skew the errors of a few replicates. Student's own interval of five such values covered 91 %, of twenty 92.4 to 94.2 %;
  the intervals over replicates allow for the skewness of their values ([decision 62](decisions/0062-intervals-and-skewness.md)), at the price of
  width: half as much again with five replicates, a tenth with twenty. Where a firefly is met by one replicate in few, five values
  look more skewed than they are and the interval may cover a little more than it says. No interval
  of a mean can promise its coverage for every tail [BahadurSavage56].
- All speak of a metric's expectation, debiased by the variance of the reference where the metric is.

Noise of one block in one replicate is in the spread of the blocks and in the spread of the replicates; it is counted once
(`lib/inference/method_series.h`). Few blocks and few replicates are allowed for by Student's distribution.
"""


def rows_of_report(drawn, pairs):
    """The report's own intervals, in Python, on the same trials."""
    a = sum(sum(p[0]) for p in pairs) / sum(len(p[0]) for p in pairs)
    b = sum(sum(p[1]) for p in pairs) / sum(len(p[1]) for p in pairs)
    names = "multiscale + directional"
    other = "uniform + gaussian"
    for interval, of, truth, make in (
            ("report: mean", f"MSE of {names}", a, lambda p: mean_interval(p[0])),
            ("report: paired difference", f"{names} less {other}", a - b, lambda p: paired_difference(list(zip(*p)))),
            ("report: ratio", f"{names} / {other}", a / b, lambda p: paired_ratio(list(zip(*p))))):
        # A ratio to what cannot be told from 0 has no interval, and claims nothing.
        found = [i for i in map(make, pairs) if math.isfinite(i.high - i.low)]
        yield {"drawn": drawn, "interval": interval, "of": of, "truth": truth, "trials": len(found),
               "covered": sum(i.low <= truth <= i.high for i in found),
               "width": sum(i.high - i.low for i in found) / len(found)}


def main():
    program = Path(sys.argv[1]) / "tools" / "bench" / "coverage" / "bench_coverage"
    found = json.loads(subprocess.run([program, *sys.argv[2:]], check=True, capture_output=True, text=True).stdout)
    rows = [*found["rows"], *(row for drawn, pairs in found["pairs"].items() for row in rows_of_report(drawn, pairs))]
    order = list(dict.fromkeys(r["drawn"] for r in rows))
    rows.sort(key=lambda r: order.index(r["drawn"]))
    lines = ["| drawn anew | interval | of | truth | mean width | covers |", "|---|---|---|---|---|---|"]
    for r in rows:
        share = 100 * r["covered"] / r["trials"]
        mark = "" if 93 <= share <= 97 else " (outside)"
        lines.append(f"| {r['drawn']} | {r['interval']} | {r['of']} | {r['truth']:.4g} | {r['width']:.2g} "
                     f"| {r['covered']} of {r['trials']}: {share:.1f} %{mark} |")
    trials = rows[0]["trials"]
    PAGE.write_text(TEXT.format(trials=trials, noise=100 * math.sqrt(0.95 * 0.05 / trials), table="\n".join(lines)),
                    encoding="utf-8")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
