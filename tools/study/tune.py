#!/usr/bin/env python3
"""Asks which options of the preset robust other recordings would choose, and writes docs/tuning.md.

    tools/dev.sh tune                 candidates, the choices, rivals; what is done is not done again
    tools/dev.sh tune --write-only    only the page, from what is kept in docs/results/tuning
    tools/dev.sh tune --full          the candidates on those recordings of full size that are here (tools/plans/tuning_full.toml)

Candidates are the claims of tools/plans/tuning.toml: each against the defaults. The program judges them; here its verdicts are counted.
"""
import argparse
from pathlib import Path

from tools.report.whole_file import write_whole
from tools.study import full_size, kept, pages, tables
from tools.study.plans import NAMED, PLANS, ROOT, full_recordings, make_recordings, text_of

SAMPLER, FILTER = "multiscale", "directional"
BAND = (0.97, 1.03)  # of the energy ratio
APART = ("caustic_mitsuba", "chess_sequence", "fireflies", "scene_s", "scene_s_fireflies",
         *(name for name in NAMED["analytic"] if name.startswith("stress_")))
FULL_APART = ("thin_lens", "matpreview", "fireflies_256", "scene_s", "scene_s_fireflies")


def parse():
    parser = argparse.ArgumentParser(prog="tune", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=ROOT / "build/release/spool", type=Path)
    parser.add_argument("--results", default=ROOT / "build/tuning", type=Path)
    parser.add_argument("--output", default=ROOT / "docs", type=Path, help="folder of the pages")
    parser.add_argument("--threads", default="0")
    parser.add_argument("--write-only", action="store_true")
    parser.add_argument("--full", action="store_true", help="on recordings of full size that are here")
    return parser.parse_args()


class Candidates:
    """Claims against the defaults, by recording. `statistics` as kept: claims and results."""

    def __init__(self, statistics):
        self.claims = [c for c in statistics["claims"] if c["metric"] == "relmse" and c["samples"] == "own"]
        self.energy = {(tables.recording(e["dump"]), e["spp"], f"{e['sampler']} + {e['filter']}"): e["quantities"].get("energy_ratio", [])
                       for e in statistics["results"]}

    @property
    def recordings(self):
        return list(dict.fromkeys(tables.recording(p["dump"]) for c in self.claims for p in c["places"]))

    def places(self, claim, recordings):
        return [p for p in claim["places"] if tables.recording(p["dump"]) in recordings]

    def _outside(self, place, method):
        """Whether the whole interval of the energy ratio is outside the band."""
        found = self.energy.get((tables.recording(place["dump"]), place["spp"], method), [])
        return len(found) == 3 and (found[2] < BAND[0] or found[1] > BAND[1])

    def count(self, claim, recordings):
        """Places where it holds less those where it is reversed, less those where it alone loses or adds light."""
        points = 0
        for place in self.places(claim, recordings):
            points += {"holds": 1, "reversed": -1}.get(place["verdict"], 0)
            points -= self._outside(place, claim["better"]) and not self._outside(place, claim["than"])
        return points

    def choose(self, recordings):
        """(claim, its count), or (None, 0): the defaults. Of equal counts the one with the fewest options, then the first of the plan."""
        counted = [(self.count(c, recordings), -c["better"].count("=") - c["better"].count(":"), -i) for i, c in enumerate(self.claims)]
        best = max(counted, default=(0, 0, 0))
        return (self.claims[-best[2]], best[0]) if best[0] > 0 else (None, 0)


def name_of(claim):
    return "the defaults" if claim is None else f"`{claim['better']}`"


def place_cell(places):
    """'holds 0.91 [0.88, 0.95] at 4': verdict and ratio of relMSE to that of the defaults, a budget after another."""
    return "; ".join(f"{p['verdict']} {tables.interval(p['ratio'])} at {p['spp']:g}" for p in places) or "–"


def choices(candidates, choosing):
    rows = []
    for left_out in choosing:
        claim, count = candidates.choose([r for r in choosing if r != left_out])
        rows.append([left_out, name_of(claim), count, place_cell(candidates.places(claim, [left_out])) if claim else "–"])
    claim, count = candidates.choose(choosing)
    return [*rows, ["*none*", name_of(claim), count, "–"]]


def choices_table(candidates, choosing):
    return tables.markdown(["left out", "choice of the others", "count", "on the one left out, relMSE over that of the defaults"],
                           choices(candidates, choosing))


def apart_table(claims, recordings):
    rows = [[name, *(place_cell([p for p in c["places"] if tables.recording(p["dump"]) == name]) for c in claims)] for name in recordings]
    return tables.markdown(["recording", *(c["text"].replace("the defaults are below", "defaults below") for c in claims)], rows)


def apart_plan(claim):
    """The choice of all against the defaults, on recordings that never choose."""
    def entry(label):
        name, _, options = label.partition("{")
        pairs = dict(pair.split("=", 1) for pair in options.removesuffix("}").split(",") if pair)
        return {"name": name, **{k: str(v) for k, v in pairs.items()}}
    sampler, filter_name = claim["better"].split(" + ")
    paths = [str(ROOT / ("tools/plans/pools" if r in NAMED["analytic"] else "dumps/tiny") / f"{r}.spool") for r in APART]
    return {"title": "the choice on recordings kept apart", "recordings": paths, "spp": [4, 8, 16], "replicates": 8, "pictures": False,
            "sampler": [{"name": SAMPLER}, *([entry(sampler)] if sampler != SAMPLER else [])],
            "filter": [{"name": FILTER}, *([entry(filter_name)] if filter_name != FILTER else [])],
            "claim": [{"better": claim["better"], "than": f"{SAMPLER} + {FILTER}", "text": "the choice is below the defaults in relMSE"}]}


def measure(arguments, store, name, plan=None):
    folder = arguments.results / name
    kept.evaluate(arguments.program, plan or PLANS / f"{name}.toml", folder, "--threads", arguments.threads)
    kept.pack(store.folder / f"{name}.tar.xz", kept.texts_of(folder))


def run(arguments, store):
    make_recordings(arguments.program)
    measure(arguments, store, "tuning")
    candidates = Candidates(pages.Kept(store.folder).json("tuning", "statistics.json"))
    claim, _ = candidates.choose(candidates.recordings)
    if claim:
        plan = arguments.results / "apart.toml"
        write_whole(plan, text_of(apart_plan(claim)))
        measure(arguments, store, "tuning_apart", plan)
    measure(arguments, store, "tuning_rivals")


def parts(store):
    """{placeholder: its text}"""
    found = {}
    small, full = (store.json(name, "statistics.json") for name in ("tuning", "tuning_full"))
    if small:
        candidates = Candidates(small)
        found |= {"choices": choices_table(candidates, candidates.recordings) + "\n\nEvery place: [tuning_claims.csv](results/tuning/tuning_claims.csv)."}
    if full:
        candidates = Candidates(full)
        choosing = [r for r in candidates.recordings if r not in FULL_APART]
        claim, _ = candidates.choose(choosing)
        found |= {"full_choices": choices_table(candidates, choosing), "full_apart": apart_table([claim], FULL_APART) if claim else "The choice is the defaults."}
    for name, key in (("tuning_apart", "apart"), ("tuning_rivals", "rivals")):
        if statistics := store.json(name, "statistics.json"):
            found[key] = apart_table(statistics["claims"], list(dict.fromkeys(p["dump"] for p in statistics["claims"][0]["places"])))
    return found


NOT_RUN = "{{not run}}"


def write(docs):
    store = pages.Kept(docs / "results/tuning")
    text = (pages.HERE / "templates/tuning.in").read_text(encoding="utf-8")
    filled = parts(store)
    for key in ("choices", "apart", "rivals", "full_choices", "full_apart"):
        text = text.replace("{{" + key + "}}", filled.get(key, NOT_RUN))
    text = "\n## ".join(part for part in text.split("\n## ") if NOT_RUN not in part).rstrip("\n") + "\n"
    for name in ("tuning", "tuning_full", "tuning_rivals", "tuning_apart"):
        if claims := store.claims(name):
            write_whole(store.folder / f"{name}_claims.csv", tables.claims_csv(claims))
    write_whole(docs / "tuning.md", text)


def main():
    arguments = parse()
    store = pages.Kept(arguments.output / "results/tuning")
    if arguments.full and not arguments.write_only:
        measuring = full_size.Store(arguments.program, ROOT / "build/experiments_full", store.folder, arguments.threads)
        for name in full_recordings("tuning_full"):
            measuring.measure("tuning_full", name, False)
    elif not arguments.write_only:
        run(arguments, store)
    write(arguments.output)


if __name__ == "__main__":
    kept.run(main)
