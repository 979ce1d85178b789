"""docs/coverage.md, from docs/results/coverage: scenes.csv, a line each, and rows.csv, what each scene's rows came to."""
import csv
import math

from tools.report.whole_file import write_whole
from tools.study.plans import ROOT
from tools.study.tables import as_csv, markdown

PAGE, KEPT = ROOT / "docs/coverage.md", ROOT / "docs/results/coverage"

TEXT = """# How often the 95 % intervals hold the truth

Written by `tools/dev.sh bench coverage`. Each scene was made 10 times (two samplers: 60 times): every sample drawn with replacement from a recording,
whose mean is the exact reference; scene S anew. Each was evaluated
by default options, 8 replicates, 4, 8, 16 of 64 samples: `uniform`, `mitchell`, `adaptive_wavelet`, `greedy_error`, `nl_means`,
`multiscale` with `box`; `uniform` and `multiscale`, the two samplers, with `directional`.{more} A row is the mean of MSE, relMSE or energy, or a ratio of MSE or relMSE to `uniform` + `box`, of one method at one budget.
Its interval should hold the mean of the other recordings in 95 %: {held} of all do. Below 90 % lie {below} rows of {rows}; were every row at 95 %, chance alone would put
{expected:.0f} there, as {fewest} to {most} intervals are few. Rows of 256 samples have the wider ratios of before [0155](decisions.md#0155-the-spread-between-recordings-is-measured-on-halves-of-the-recording). Rows are *withheld* where most of their recordings have no verdict
because few pixels carry the error ([decision 156](decisions.md#0156-what-a-verdict-may-stand-on)); "without halves" are the same results with the
spread between recordings assumed and not measured, nothing withheld.

{table}

Single rows: [rows.csv](results/coverage/rows.csv).

*Itself*: `spool compare` of two recordings of one scene, every method and budget with itself, a family for MSE and one for relMSE: in how many something is
claimed; 5 % may.

## What forbids more

- The oracle `neyman` is left out: its halves share what decides.
- Light that few samples carry: a recording without them has too low an interval. Three recordings (`--recordings`, `group`) show it.
  Of the rows below 90 % {both} miss to both sides.
- The relMSE of `multiscale` without a filter: bright pixels take samples from all others, so that replicates are more alike than the samples
  they share; its least row of more than 10 intervals holds the truth in {least} %.
- Where samples have a tail of infinite variance, the expectation of the squared error does not exist, and no interval can hold it
  [BahadurSavage56].
- Where one cell of the image carries an error, the interval is 3 to 15 times too wide.
- Few pixels: wider today (0155).
- Bias makes errors alike by the share of samples in common, not by its square: with a constant bias as large as the normal noise, intervals of MSE hold
  97, 91, 90 % with 4, 16, 32 of 64 samples.
"""
SCENES = ("scene", "side", "samples", "recordings", "measured", "rows", "held", "below", "withheld", "least", "below_without", "least_without",
          "itself_mse", "itself_relmse", "itself_mse_without", "itself_relmse_without")
ROWS = ("scene", "quantity", "method", "spp", "intervals", "held", "too_low", "share", "share_without")
MORE = """ *Filter in the loop*: `denoised_variance`, `filtered_halves`, `cross_halves` with `box`. Names in `_256` and `cornell_box_picture`: 256 x 256 pixels of 256
samples, the two samplers; *other samplers*: all the others, of 256 samples (pictures of 256 x 256 pixels: made {fewest} times); `paper`: that preset."""
ENOUGH = 0.9


def read(name):
    path = KEPT / f"{name}.csv"
    if not path.exists():
        return []
    with open(path, encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


def share(found):
    intervals, held, _ = found
    return held / intervals if intervals else None


def keep(scene, measured, now, before):
    """`now`, `before`: {(quantity, method, spp): (intervals, those that hold the truth, those below it)}."""
    shares, without = ([s for found in side.values() if (s := share(found)) is not None] for side in (now, before))
    line = {"scene": scene, **measured, "rows": len(now), "held": sum(s >= ENOUGH for s in shares), "below": sum(s < ENOUGH for s in shares),
            "withheld": len(now) - len(shares), "least": f"{min(shares):.3f}", "below_without": sum(s < ENOUGH for s in without),
            "least_without": f"{min(without):.3f}"}
    rows = [{"scene": scene, "quantity": row[0], "method": row[1], "spp": f"{row[2]:g}", "intervals": found[0], "held": found[1], "too_low": found[2],
             "share": "" if share(found) is None else f"{share(found):.3f}",
             "share_without": "" if share(before[row]) is None else f"{share(before[row]):.3f}"} for row, found in now.items()]
    KEPT.mkdir(parents=True, exist_ok=True)
    for name, columns, more in (("scenes", SCENES, [line]), ("rows", ROWS, rows)):
        lines = [*(kept for kept in read(name) if kept["scene"] != scene), *more]
        write_whole(KEPT / f"{name}.csv", as_csv(columns, [[kept[c] for c in columns] for kept in lines]))


def by_chance(count):
    """Chance that fewer than 90 % of `count` intervals hold where each does with 95 %."""
    return sum(math.comb(count, k) * 0.95 ** k * 0.05 ** (count - k) for k in range(math.ceil(ENOUGH * count)))


def percent(text):
    return f"{100 * float(text):.0f}"


def claimed(scene, end):
    """Of a method compared with itself."""
    return f"{int(scene['itself_mse' + end]) + int(scene['itself_relmse' + end])}/{int(scene['recordings']) // 2 * 2}"


def write(order):
    """`order`: of the scenes."""
    scenes = sorted(read("scenes"), key=lambda line: list(order).index(line["scene"]))
    table = [[s["scene"], s["rows"], s["below"], s["withheld"], percent(s["least"]), claimed(s, ""),
              s["below_without"], percent(s["least_without"]), claimed(s, "_without")] for s in scenes]
    rows = [row for row in read("rows") if row["intervals"] and row["share"]]
    counted = [[int(row[c]) for c in ("intervals", "held", "too_low")] for row in rows]
    made = [int(s["recordings"]) for s in scenes]
    low = [found for found in counted if share(found) < ENOUGH]
    write_whole(PAGE, TEXT.format(
        below=len(low), both=sum(0 < too_low < intervals - held for intervals, held, too_low in low), rows=len(counted),
        held=f"{100 * sum(found[1] for found in counted) / sum(found[0] for found in counted):.1f} %", expected=sum(by_chance(found[0]) for found in counted),
        least=percent(min(row["share"] for row in rows if "relmse" in row["quantity"] and row["method"] == "multiscale + box" and int(row["intervals"]) > 10)),
        fewest=min(made), most=max(made), more=MORE.format(fewest=min(made)) if any("paper" in s["scene"] or s["side"] != "64" for s in scenes) else "",
        table=markdown(["scene", "rows", "below 90 %", "withheld", "least, %", "itself", "without halves: below", "least, %", "itself"], table)))
