"""Tables of what statistics.json holds: claims and errors, as Markdown and as CSV. Prints figures; computes none."""
import csv
import io
import math
from pathlib import PurePosixPath

ORDER = ("holds", "reversed", "undecided", "not compared")
LATE = "†"  # a claim that was written after its results
WITH_INTERVAL = ("mse", "relmse", "energy_ratio", "mse_ratio", "relmse_ratio")
QUESTION = ("better", "than", "metric", "below")


def recording(dump):
    return PurePosixPath(dump).stem


def place(entry):
    """Of a method's results: recording, budget, threads and method."""
    return recording(entry["dump"]), entry["spp"], entry["threads"], entry["sampler"], entry["filter"]


def number(value, digits=3):
    """Three significant digits, no exponent between 0.001 and 10000."""
    if value is None or value == "":
        return ""
    if value == 0 or 1e-3 <= abs(value) < 1e4:
        places = max(0, digits - 1 - math.floor(math.log10(abs(value)))) if value else 0
        return f"{value:.{places}f}"
    return f"{value:.{digits - 1}e}"


def interval(found):
    """0.123 [0.110, 0.138]"""
    if not found:
        return "–"
    return number(found[0]) + (f" [{number(found[1])}, {number(found[2])}]" if len(found) == 3 and found[1] != found[2] else "")


def markdown(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    return "\n".join(lines + ["| " + " | ".join(str(cell).replace("|", "\\|") for cell in row) + " |" for row in rows])


def as_csv(header, rows):
    stream = io.StringIO()
    csv.writer(stream, lineterminator="\n").writerows([header, *rows])
    return stream.getvalue()


def names(method):
    """Of "SAMPLER + FILTER", without presets and options."""
    return [part.partition("{")[0].partition(":")[0] for part in method.split(" + ")]


def by_description(method, described):
    """Whether a part of "SAMPLER + FILTER" is re-implemented from a description."""
    return any(name in described for name in names(method))


def verdict(claim):
    """'mixed 28/6/2 -1': the program's verdict, at how many places the claim holds, is reversed, is undecided, and how many have none."""
    if claim is None:
        return "–"
    without = claim["counts"].get(ORDER[3], 0)
    return f"{claim['verdict']} " + "/".join(str(claim["counts"].get(word, 0)) for word in ORDER[:3]) + (f" -{without}" if without else "")


def claims_table(by_plan, described=()):
    """A row for each question, a column for each plan that asks some, on own and on fresh samples."""
    rows, columns = {}, {}
    for plan, claims in by_plan.items():
        for claim in claims:
            row = rows.setdefault(tuple(claim[k] for k in QUESTION), {"text": claim["text"]})
            if by_description(claim["better"], described) or by_description(claim["than"], described):
                row["text"] = claim["text"] + " [R]"
            row[plan, claim["samples"]] = claim
            name = {"own": "own samples", "fresh": "fresh samples"}[claim["samples"]]
            columns[plan, claim["samples"]] = name if len(by_plan) == 1 else f"{plan.split('_')[0].upper()}, {name}"
    return markdown(["claim", *columns.values()], [[row["text"], *(verdict(row.get(c)) for c in columns)] for row in rows.values()])


def summary(claims):
    """'6 hold, 10 mixed', and whether some were asked late"""
    verdicts = [c["verdict"] for c in claims]
    found = ", ".join(f"{verdicts.count(v)} {v.replace('holds', 'hold')}" for v in (*ORDER[:1], "mixed", *ORDER[1:]) if v in verdicts)
    return found + (LATE if any(c.get("after_results") for c in claims) else "")


def claims_csv(claims):
    header = ["better", "than", "metric", "samples", "below", "after_results", "recording", "spp", "threads", "verdict",
              "withheld", "ratio", "low", "high", "p", "replicates"]
    rows = []
    for c in claims:
        than = c["than"] + (f", threads {c['threads'][1]}" if "threads" in c else "")
        question = [c["better"], than, c["metric"], c["samples"], number(c["below"]), int(c.get("after_results", False))]
        for place in c["places"]:
            ratio = [number(v) for v in place["ratio"]] + [""] * (3 - len(place["ratio"]))
            rows.append([*question, recording(place["dump"]), number(place["spp"]), place["threads"], place["verdict"], place.get("withheld", ""), *ratio,
                         number(place["p"], 2), place["replicates"]])
    return as_csv(header, rows)


def results_csv(statistics):
    """A row for each method, recording and budget: every quantity that is there, those of WITH_INTERVAL with it, and the ratios to the baseline."""
    ratios = {}
    for condition in statistics["conditions"]:
        for method in condition["ranking"]:
            ratios.setdefault(place({**condition, **method}), {})[condition["metric"] + "_ratio"] = method["ratio"]
    found = [({**e["quantities"], **ratios.get(place(e), {})}, e) for e in statistics["results"]]
    several = len({e["threads"] for e in statistics["results"]}) > 1  # then wall times say something
    columns = list(dict.fromkeys(name for quantities, _ in found for name in quantities if several or not name.startswith("seconds_")))
    ends = {c: ("", "_low", "_high") if c in WITH_INTERVAL else ("",) for c in columns}
    header = ["recording", "spp", "threads", "sampler", "filter", *(c + end for c in columns for end in ends[c])]
    rows = []
    for quantities, e in found:
        values = [[number(v) for v in quantities.get(c, [])] + [""] * 3 for c in columns]
        rows.append([recording(e["dump"]), number(e["spp"]), e["threads"], e["sampler"], e["filter"],
                     *(v for c, found_values in zip(columns, values) for v in found_values[:len(ends[c])])])
    return as_csv(header, rows)
