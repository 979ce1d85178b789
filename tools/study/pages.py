"""The pages docs/experiments.md and docs/experiments_full.md: templates, filled from what is kept.

A template (templates/PAGE.in) holds sentences. In them
    {{chapters}}                                      is a part for each chapter of chapters.toml
    {{PLAN; BETTER; THAN; METRIC; SAMPLES; VERDICT}}  is where a claim holds, and requires that its verdict is this one
so a sentence that was written about a verdict cannot outlive it.
"""
import json
import re
from pathlib import Path

import tomllib

from tools.study import kept, tables
from tools.study.plans import FULL
from tools.study.whole_file import write_whole

HERE = Path(__file__).parent
CHAPTERS = tomllib.loads((HERE / "chapters.toml").read_text(encoding="utf-8"))["chapter"]
CLAIM = re.compile(r"\{\{(\w+;[^\n]*?;\s*\w+)\}\}")
DENSITY = {"levels_3_4": "samples of levels 3 and 4", "near_edges": "adaptive samples near edges", "correlation": "correlation with noise",
           "block_index": "jump at multiples of 16", "tile_jump": "jump at its tiles"}


class Changed(Exception):
    """A sentence whose claim has another verdict now, or is not asked any more."""


class Kept:
    """What is kept of the plans of one page: FOLDER/PLAN.tar.xz, a plan once."""

    def __init__(self, folder):
        self.folder, self._plans, self._parsed = folder, {}, {}

    def texts(self, plan):
        if plan not in self._plans:
            self._plans[plan] = kept.unpack(self.folder / f"{plan}.tar.xz")
        return self._plans[plan]

    def json(self, plan, name):
        if (plan, name) not in self._parsed:
            self._parsed[plan, name] = json.loads(self.texts(plan).get(name, "{}"))
        return self._parsed[plan, name]

    def claims(self, plan):
        return self.json(plan, "statistics.json").get("claims", [])

    def results(self, plan):
        """statistics.json; with means that an older program kept without the values of replicates (figures.json)."""
        statistics = self.json(plan, "statistics.json")
        more = {tables.place(e): e["quantities"] for e in self.json(plan, "figures.json") or ()}
        for entry in statistics.get("results", ()):
            entry["quantities"].update(more.get(tables.place(entry), {}))
        return statistics

    def described(self, plan):
        made = self.json(plan, "made.json")
        return set().union(*(m.get("described", ()) for m in (made, *made.values()) if isinstance(m, dict)))


def density_table(measured, measures):
    """Least and most over the replicates; nothing is averaged."""
    rows = []
    for name, found in measured.items():
        for key, values in found.items():
            method, spp = key.rsplit("|", 1)
            ranges = [sorted(values.get(m, [])) for m in measures]
            rows.append([name, method, f"{float(spp):g}", *(f"{tables.number(v[0], 2)} to {tables.number(v[-1], 2)}" if v else "–" for v in ranges)])
    return ["recording", "method", "spp", *(DENSITY[m] for m in measures)], rows


def links_of(chapter, plan, store):
    """Plan, and every place, cell and density of it."""
    ends = {"_claims": bool(store.claims(plan)), "_density": "density" in chapter, "": True}
    files = [f"[{name}](results/{store.folder.name}/{plan}{end}.csv)" for end, name in
             (("_claims", "every place"), ("_density", "densities"), ("", "every cell")) if ends[end]]
    return f"[{plan}](../tools/plans/{plan}.toml): {', '.join(files) if store.texts(plan) else '**not run yet**'}"


def chapter_blocks(chapter, store, brief):
    """brief: of what claims came to numbers alone, and no words that another page has."""
    plans = [*chapter["plans"], *(p for p in chapter.get("more", ()) if store.texts(p))]
    asked = {p: store.claims(p) for p in plans if store.claims(p)}
    blocks = [f"## {chapter['id']}: {chapter['title']}"]
    links = "; ".join(links_of(chapter, p, store) for p in plans) + "."
    if brief:
        claims = [c for of_plan in asked.values() for c in of_plan]
        return [*blocks, f"{tables.summary(claims)} {links}" if claims else links]
    blocks.append(f"{chapter['question']} {chapter.get('note', '')}".strip())
    if asked:
        described = set().union(*(store.described(p) for p in asked))
        blocks.append(tables.claims_table(asked, described))
    return [*blocks, links]


def chapters_of(full):
    return [c for c in CHAPTERS if not full or c["plans"][0] not in FULL["left_out"]]


def place_text(claim):
    counts = claim["counts"]
    more = [f"{counts[w]} {w}" for w in tables.ORDER[1:3] if counts.get(w)]
    compared = sum(counts.get(word, 0) for word in tables.ORDER[:3])
    return f"({counts.get('holds', 0)} of {compared} hold{''.join(', ' + m for m in more)})"


def said(match, store):
    plan, better, than, metric, samples, verdict = (part.strip() for part in match.group(1).split(";"))
    for claim in store.claims(plan):
        if (claim["better"], claim["than"], claim["metric"], claim["samples"]) == (better, than, metric, samples):
            if claim["verdict"] != verdict:
                raise Changed(f"{match.group(0)}: the verdict is now '{claim['verdict']}': write the sentence anew")
            return place_text(claim)
    raise Changed(f"{match.group(0)}: no such claim is kept: write the sentence anew")


def page(template, store, full):
    """The text of a page, from what is kept in this Kept."""
    text = (HERE / "templates" / template).read_text(encoding="utf-8")
    text = CLAIM.sub(lambda match: said(match, store), text)
    blocks = [block for chapter in chapters_of(full) for block in chapter_blocks(chapter, store, full and chapter.get("brief", False))]
    return text.replace("{{chapters}}", "\n\n".join(blocks))


def write_csv(store, chapter):
    """The long tables of a chapter."""
    for plan in (*chapter["plans"], *chapter.get("more", ())):
        statistics = store.results(plan)
        if not statistics:
            continue
        write_whole(store.folder / f"{plan}.csv", tables.results_csv(statistics))
        if statistics["claims"]:
            write_whole(store.folder / f"{plan}_claims.csv", tables.claims_csv(statistics["claims"]))
        if "density" in chapter:
            measured = store.json(plan, "density.json")
            write_whole(store.folder / f"{plan}_density.csv", tables.as_csv(*density_table(measured, DENSITY)))


def write(docs, full):
    """Page and tables, in the folder of the pages."""
    name = "experiments_full" if full else "experiments"
    store = Kept(docs / "results" / name)
    store.folder.mkdir(parents=True, exist_ok=True)
    for chapter in chapters_of(full):
        write_csv(store, chapter)
    write_whole(docs / f"{name}.md", page(f"{name}.in", store, full).rstrip("\n") + "\n")
