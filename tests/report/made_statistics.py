"""statistics.json for made results: invented verdicts that a test can know, in the form that the program writes.

Means are geometric, intervals 2 % either way, and methods are separated where their means are 5 % apart. None of it is
how the program does it: the report has to say what the file says.
"""
import json
import math
from collections import defaultdict

APART = 0.05
METRICS = ["mse", "mse_r", "rmse", "relmse", "relmse_trimmed", "relmse_dropped", "mae", "psnr_tm", "energy_ratio",
           "energy_ratio_d1"]
OTHERS = ["seconds_total", "seconds_sampling", "seconds_filtering", "cpu_sampling", "cpu_filtering", "seconds_reading",
          "saturated_share"]
RANKED = ["relmse", "mse", "energy_ratio"]


def made_mean(values):
    if all(v > 0 for v in values):
        return math.exp(sum(map(math.log, values)) / len(values))
    return sum(values) / len(values)


def made_interval(values):
    mean = made_mean(values)
    return [mean, min(mean * 0.98, mean * 1.02), max(mean * 0.98, mean * 1.02)]


def verdict(a, b):
    """Of mean a against mean b."""
    if abs(a - b) <= APART * abs(b):
        return "undecided"
    return "better" if a < b else "worse"


def make_statistics(rows):
    groups = defaultdict(list)
    for row in rows:
        groups[row["dump"], float(row["spp"]), row["sampler"], row["filter"]].append(row)
    results = [_result(key, group) for key, group in groups.items()]
    dumps = list(dict.fromkeys(row["dump"] for row in rows))
    conditions = [_condition(metric, place, [r for r in results if (r["dump"], r["spp"]) == place and
                                             r["quantities"].get(metric)])
                  for place in dict.fromkeys((r["dump"], r["spp"]) for r in results) for metric in RANKED]
    return {"version": 1, "rules": {"verdict": "Made up.", "interval": "Made up."},
            "scenes": [{"dump": dump, "group": "", "recordings": [dump]} for dump in dumps], "results": results,
            "conditions": [c for c in conditions if c["ranking"]], "curves": [],
            "overall": _overall(results, conditions) if len(dumps) > 1 else []}


def _result(key, group):
    dump, spp, sampler, filter_ = key
    done = [row for row in group if not row["error"]]
    quantities = {}
    for name in METRICS + OTHERS:
        values = [float(row[name]) for row in done if row[name] != ""]
        if values:
            quantities[name] = made_interval(values)
    if done:
        quantities["samples_per_pixel"] = [float(done[0]["samples_spent"]) / int(done[0]["width"]) / int(done[0]["height"])]
    alike = len(done) == 1 or len({row["mse"] for row in done}) == 1
    return {"dump": dump, "spp": spp, "threads": 0, "sampler": sampler, "filter": filter_, "replicates": len(done),
            "failed": len(group) - len(done), "one_image": alike, "shared": 0.0,
            "reference": done[0]["reference"] if done else "", "quantities": quantities}


def _condition(metric, place, results):
    entries = sorted(results, key=lambda r: (r["one_image"], r["quantities"][metric][0]))
    base = next((r for r in entries if (r["sampler"], r["filter"]) == ("uniform", "box")), None)
    ranking = []
    for r in entries:
        mean, best = r["quantities"][metric][0], entries[0]["quantities"][metric][0]
        entry = {"sampler": r["sampler"], "filter": r["filter"], "value": r["quantities"][metric],
                 "letters": "" if r["one_image"] else chr(97 + min(25, int(math.log(max(mean / best, 1.0)) / APART))),
                 "compared": not r["one_image"], "energy": r["quantities"].get("energy_ratio", [])}
        if r is not entries[0] and not r["one_image"]:
            entry["against_best"] = verdict(mean, best)
        if base is not None and r is not base:
            entry["against_baseline"] = "not compared" if r["one_image"] else verdict(mean, base["quantities"][metric][0])
            entry["ratio"] = [mean / base["quantities"][metric][0] * f for f in (1.0, 0.97, 1.03)]
        energy = r["quantities"].get("energy_ratio", [1.0, 1.0, 1.0])
        if energy[0] < 0.96:
            entry["loses_energy"] = 1.0 - energy[0]
        ranking.append(entry)
    alone = all(r["one_image"] for r in results)
    about = {"kind": "one image" if alone else "disjoint", "shared": 0.0, "text": "a made recording"}
    biased = any("biased" in r["reference"] for r in results)
    return {"dump": place[0], "spp": place[1], "threads": 0, "metric": metric, "biased": biased, "about": about,
            "ranking": ranking, "pairs": _pairs(ranking, metric) if metric in ("relmse", "mse") else []}


def _pairs(ranking, metric):
    """Every pair of two that are compared: [place, place, ratio, low, high, p, verdict of the first]."""
    found = []
    for a, first in enumerate(ranking):
        for b in range(a + 1, len(ranking)):
            if first["compared"] and ranking[b]["compared"]:
                word = verdict(first["value"][0], ranking[b]["value"][0])
                ratio = first["value"][0] / ranking[b]["value"][0]
                found.append([a, b, ratio, 0.9 * ratio, 1.1 * ratio, 1.0 if word == "undecided" else 0.01, word])
    return found


def _overall(results, conditions):
    overall = []
    for spp, sampler, filter_ in dict.fromkeys((r["spp"], r["sampler"], r["filter"]) for r in results):
        members = [r for r in results if (r["spp"], r["sampler"], r["filter"]) == (spp, sampler, filter_)]
        entry = {"spp": spp, "threads": 0, "sampler": sampler, "filter": filter_,
                 "quantities": {name: made_interval([r["quantities"][name][0] for r in members])
                                for name in members[0]["quantities"] if all(name in r["quantities"] for r in members)}}
        for metric in RANKED:
            found = [e for c in conditions if c["metric"] == metric and c["spp"] == spp for e in c["ranking"]
                     if (e["sampler"], e["filter"]) == (sampler, filter_) and "ratio" in e]
            if found:
                said = [e["against_baseline"] for e in found]
                entry.setdefault("against_baseline", {})[metric] = {
                    "ratio": made_interval([e["ratio"][0] for e in found]), "better": said.count("better"),
                    "worse": said.count("worse"), "undecided": len(said) - said.count("better") - said.count("worse")}
        overall.append(entry)
    return overall


def write_statistics(folder, rows):
    (folder / "statistics.json").write_text(json.dumps(make_statistics(rows)))
