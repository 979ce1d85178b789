"""Errors of methods before and after a change: tools/dev.sh bench errors --before PROGRAM [--recordings ...].

One plan, run by another build of the program and by this one: same recordings, seeds and replicates, so that rows pair. Of relMSE and
relMSE without its worst 0.1 % of pixels the geometric mean over recordings of the mean over replicates, after over before, with
the standard error over replicates of its logarithm; energy is a mean. A method that is changed by an option stands in --then as NOW=THEN:
the program of before runs THEN. Recordings: dumps/tiny, and those of full size that are there. Prints a table.
"""
import argparse
import csv
import math
import os
import shutil
import statistics
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
SAMPLERS = ["uniform", "multiscale", "nl_means", "cross_bilateral"]
FILTERS = ["box", "directional", "nl_means", "cross_bilateral"]


def quoted(names):
    return "[" + ", ".join(f'"{name}"' for name in names) + "]"


def evaluate(program, recordings, samplers, filters, options, folder):
    plan = folder.with_suffix(".toml")
    plan.write_text(f'title = "errors"\nrecordings = {quoted(recordings)}\nspp = [{options.spp}]\nreplicates = {options.replicates}\n'
                    f'samplers = {quoted(samplers)}\nfilters = {quoted(filters)}\npictures = false\n', encoding="utf-8")
    shutil.rmtree(folder, ignore_errors=True)
    done = subprocess.run([program, "evaluate", plan, "-q", "-o", folder], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    if not (folder / "results.csv").exists():
        sys.exit(f"errors: {program}: {done.stderr}")
    with open(folder / "results.csv", newline="", encoding="utf-8") as stream:
        return [row for row in csv.DictReader(stream) if not row["error"]]


def keyed(rows, names):
    """{(sampler, filter, spp): {dump: {replicate: row}}}, samplers by the names that they have now."""
    found = {}
    for row in rows:
        key = (names.get(row["sampler"], row["sampler"]), row["filter"], int(row["spp"]))
        found.setdefault(key, {}).setdefault(row["dump"], {})[row["replicate"]] = row
    return found


def ratio(before, after, column):
    """Geometric mean over recordings, and its standard error over replicates, both of after over before."""
    logs = []
    for dump in before.keys() & after.keys():
        both = before[dump].keys() & after[dump].keys()
        pairs = [(float(before[dump][r][column]), float(after[dump][r][column])) for r in both]
        pairs = [(b, a) for b, a in pairs if b > 0 and a > 0]
        if not pairs:
            continue
        each = [math.log(a / b) for b, a in pairs]
        mean = math.log(sum(a for _, a in pairs) / sum(b for b, _ in pairs))
        logs.append((mean, statistics.stdev(each) / math.sqrt(len(each)) if len(each) > 1 else 0.0))
    if not logs:
        return ""
    mean = math.exp(sum(m for m, _ in logs) / len(logs))
    error = math.sqrt(sum(e * e for _, e in logs)) / len(logs)
    return f"{mean:.4f} +- {error:.4f}"


def energies(groups):
    values = [float(row["energy_ratio"]) for dump in groups.values() for row in dump.values() if row["energy_ratio"]]
    return f"{sum(values) / len(values):.4f}"


def table(groups):
    """One row for each method and budget: of each group of recordings, (title, before, after)."""
    lines = ["| recordings | sampler + filter | spp | relMSE, after / before | trimmed relMSE | energy before, after |", "|---|---|---|---|---|---|"]
    for title, before, after in groups:
        for key in sorted(before.keys() & after.keys()):
            sampler, filter, spp = key
            lines.append(f"| {title} | {sampler} + {filter} | {spp} | {ratio(before[key], after[key], 'relmse')} | "
                         f"{ratio(before[key], after[key], 'relmse_trimmed')} | {energies(before[key])}, {energies(after[key])} |")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=Path)
    parser.add_argument("--before", type=Path, help="the program as it was; without it nothing is measured")
    parser.add_argument("--then", action="append", default=[], metavar="NOW=THEN", help="sampler NOW is compared with THEN, as the program of before calls it")
    parser.add_argument("--samplers", default=",".join(SAMPLERS))
    parser.add_argument("--filters", default=",".join(FILTERS))
    parser.add_argument("--spp", default="4, 16")
    parser.add_argument("--replicates", type=int, default=4)
    parser.add_argument("--large", type=Path, default=Path(os.environ.get("SPOOL_RECORDINGS", "~/.cache/spool/recordings")).expanduser())
    parser.add_argument("--what", default="", help="in words: which build `before` is")
    options = parser.parse_args()
    if options.before is None:
        print("errors: not measured: give --before PROGRAM, another build of spool", file=sys.stderr)
        return
    then = dict(pair.split("=", 1) for pair in options.then)
    samplers, filters = options.samplers.split(","), options.filters.split(",")
    folder = options.build.resolve() / "errors"
    folder.mkdir(exist_ok=True)
    groups = []
    for title, recordings in (("tiny", sorted((ROOT / "dumps" / "tiny").glob("*.spool"))), ("full size", sorted(options.large.glob("*.spool")))):
        if not recordings:
            continue
        before = evaluate(options.before.resolve(), recordings, [then.get(s, s) for s in samplers], filters, options, folder / f"before-{title.split()[0]}")
        after = evaluate(options.build.resolve() / "spool", recordings, samplers, filters, options, folder / f"after-{title.split()[0]}")
        groups.append((f"{title} ({len(recordings)})", keyed(before, {old: now for now, old in then.items()}), keyed(after, {})))
    text = "\n\n".join([
        "## Errors before and after what was made faster",
        f"`tools/dev.sh bench errors`: {options.what or options.before.name} against the program of today, the same plan and seeds, {options.replicates} replicates. After over before, geometric mean over "
        "recordings; what follows +- is the standard error over replicates. Equal to the last digit shown means that nothing was decided otherwise.",
        table(groups)])
    print(text)


if __name__ == "__main__":
    main()
