"""The pages docs/findings.md and docs/experiments.md: templates, filled from what is kept.

A template (templates/PAGE.in) contains sentences. In them
    {{chapters}}                                      is a row for each chapter of chapters.toml
    {{readings}}                                      is the preset paper as a family: its best, worst and shipped member
    {{rivals}}                                        is the paper's statements, counted by preset and class of rival
    {{matrix}}                                        is whole methods by recordings: relMSE to uniform + box, energy
    {{equal_time}}                                    is the same at equal processor time, of 64 x 64 pixels
    {{PLAN; BETTER; THAN; METRIC; SAMPLES; VERDICT}}  is where a claim holds, and requires that its verdict is this one; "small PLAN": on
                                                      recordings of 64 x 64 pixels, though it was run at full size;
                                                      "METRIC < 0.95": the one of several that has this bound
so a sentence that was written about a verdict cannot outlive it.
"""
import itertools
import json
import re
from pathlib import Path

import tomllib

from tools.report.whole_file import write_whole
from tools.study import kept, tables
from tools.study.plans import FULL

HERE = Path(__file__).parent
CHAPTERS = tomllib.loads((HERE / "chapters.toml").read_text(encoding="utf-8"))["chapter"]
CLAIM = re.compile(r"\{\{((?:small )?\w+;[^\n]*?;\s*\w+)\}\}")

METHODS = {"uniform + directional": "uniform + directional", "multiscale:paper + directional:paper": "paper", "multiscale{update=epoch} + directional": "robust",
           "uniform + nl_means": "uniform + nl_means", "nl_means + nl_means": "nl_means", "greedy_error + greedy_selection": "greedy",
           "mitchell + multistage": "mitchell [R]", "adaptive_wavelet + wavelet_shrinkage": "wavelet [R]"}
# Of the plan quick.
QUICK = {"uniform + nl_means": "uniform + nl_means", "uniform + directional": "uniform + directional",
         "multiscale + box": "multiscale + box", "multiscale + directional": "robust"}

NETWORK = "n_beside_network"
READINGS = {"a14_sampler_readings": ("multiscale:paper", "box"), "a15_filter_readings": ("multiscale:paper", "directional:paper")}


class Changed(kept.Failed):
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

    def described(self, plan):
        made = self.json(plan, "made.json")
        return set().union(*(m.get("described", ()) for m in (made, *made.values()) if isinstance(m, dict)))


def links_of(plan, store):
    """Counted verdicts of a plan with the table of every place, and what is kept of its results."""
    if not store.texts(plan):
        return "not run"
    claims = store.claims(plan)
    names = {**({"_claims.csv": tables.summary(claims)} if claims else {}), ".tar.xz": "results"}
    return ", ".join(f"[{name}](results/{store.folder.name}/{plan}{end})" for end, name in names.items())


def chapter_rows(chapter, small, full):
    """A row for each plan of a chapter: what it asks, and what came out at both sizes."""
    rows = []
    for i, plan in enumerate((*chapter["plans"], *(p for p in chapter.get("more", ()) if small.texts(p)))):
        rows.append([chapter["id"] if i == 0 else "", chapter["title"] if i == 0 else "", f"[{plan}](../tools/plans/{plan}.toml)",
                     "" if chapter["plans"][0] in FULL["left_out"] else links_of(plan, full), links_of(plan, small)])
    return rows


def chapters_table(small, full):
    rows = [row for chapter in CHAPTERS for row in chapter_rows(chapter, small, full)]
    return tables.markdown(["", "question", "plan", "full size", "64 x 64 pixels"], rows)


def chapter_claims(store, full):
    """The claims of every chapter as tables, for the site."""
    blocks = []
    for chapter in chapters_of(full):
        asked = {p: store.claims(p) for p in (*chapter["plans"], *chapter.get("more", ())) if store.claims(p)}
        if asked:
            described = set().union(*(store.described(p) for p in asked))
            blocks += [f"### {chapter['id']}: {chapter['title']}", f"{chapter['question']} {chapter.get('note', '')}".strip(), tables.claims_table(asked, described)]
    return blocks


def matrix(store, methods, plans, spp=8):
    """Recording by method: relMSE over that of the baseline; after a stroke the energy, where it is not 0.99 to 1.01."""
    rows = {}
    for plan in plans:
        statistics = store.json(plan, "statistics.json")
        ratios = {tables.place({**c, **m}): m["ratio"][0] for c in statistics.get("conditions", ()) if c["metric"] == "relmse" for m in c["ranking"]}
        for entry in statistics.get("results", ()):
            where = tables.place(entry)
            if entry["spp"] == spp and where in ratios and " + ".join(where[3:]) in methods:
                energy = f"{entry['quantities']['energy_ratio'][0]:.2f}"
                cell = tables.number(ratios[where], 2) + ("" if energy in ("0.99", "1.00", "1.01") else f" / {energy}")
                rows.setdefault(where[0], {}).setdefault(" + ".join(where[3:]), cell)
    return tables.markdown(["recording", *methods.values()], [[name, *(of.get(m, "–") for m in methods)] for name, of in sorted(rows.items())])


def equal_time(store, methods, plan):
    """Recording and budget of the baseline by method: relMSE over that of the baseline in its processor time; rows where a method is fast enough."""
    rows = {}
    for curve in store.json(plan, "curves.json"):
        name = methods.get(f"{curve['sampler']} + {curve['filter']}")
        for at in curve["equal_time"] if name else ():
            rows.setdefault((curve["dump"], at["at"]), {})[name] = at.get("outside") or tables.interval(at["ratio"])
    shown = [[name, f"{spp:g}", *(row.get(m, "–") for m in methods.values())] for (name, spp), row in sorted(rows.items()) if {*row.values()} != {"too slow"}]
    return tables.markdown(["recording", "spp", *methods.values()], shown)


def readings(stores, plans):
    """The family of the preset paper by recording, at the largest budget: MSE over that of uniform + box of its shipped, best and worst member."""
    rows = []
    for (plan, shipped), store in itertools.product(plans.items(), stores):
        conditions = [c for c in store.json(plan, "statistics.json").get("conditions", ()) if c["metric"] == "mse"]
        for c in (c for c in conditions if c["spp"] == max(c["spp"] for c in conditions)):
            ratios = {tables.place({**c, **m})[3:]: m["ratio"][0] for m in c["ranking"]}
            family = sorted((ratio, "+".join(p for part in m for p in part.split("+")[1:]) or "shipped") for m, ratio in ratios.items()
                            if m[0].startswith("multiscale:paper") and (m[1] == "box") == (shipped[1] == "box"))
            if family and shipped in ratios:
                ends = [f"{tables.number(ratio, 2)} {name}" for ratio, name in (family[0], family[-1])]
                rows.append([plan.split("_")[0].upper(), tables.recording(c["dump"]), f"{c['spp']:g}", len(family), tables.number(ratios[shipped], 2), *ends])
    return tables.markdown(["", "recording", "spp", "members", "shipped", "best", "worst"], rows)


def rival_of(claim, described):
    """What a statement of the paper compares with."""
    if claim["than"] == "uniform + box":
        return "uniform sampling"
    if tables.names(claim["than"])[0] == "multiscale":
        return "its own variants"
    return "re-implementations [R]" if tables.by_description(claim["than"], described) else "methods with released code"


def rivals(small, full):
    """The statements of the paper by preset, samples and class of rival: '3 hold, 1 mixed'."""
    found = {}
    for plan in dict.fromkeys(p for c in CHAPTERS for p in c["plans"]):
        store = full if full.texts(plan) else small
        for claim in (c for c in store.claims(plan) if c.get("source", "").startswith("LiuZheng")):
            preset = "paper" if claim["better"].startswith("multiscale:paper") else "robust"
            found.setdefault(rival_of(claim, store.described(plan)), {}).setdefault((preset, claim["samples"]), []).append(claim)
    columns = [(preset, samples) for preset in ("robust", "paper") for samples in ("own", "fresh")]
    return tables.markdown(["against", *(f"`{preset}`, {samples} samples" for preset, samples in columns)],
                           [[rival, *(tables.summary(of.get(c, ())) or "–" for c in columns)] for rival, of in found.items()])


def short_name(method):
    """Without options, and an ensemble without its parts, but with its own options."""
    heads = (part.partition(":") for part in method.split(" + ", 1))
    return " + ".join(f"`{head if colon else head.partition('{')[0]}`" for head, colon, _ in heads)


def beside_network(store, plan):
    """Method by budget: trimmed relMSE and FLIP over those of the plan's baseline; energy and CPU seconds at 8 samples."""
    rows, budgets = {}, {}
    for o in store.json(plan, "statistics.json").get("overall", ()):
        if o["sampler"] != "uniform" and o["filter"] in ("box", "nl_means"):
            continue  # cells have them
        row = rows.setdefault(short_name(f"{o['sampler']} + {o['filter']}"), {})
        budgets[o["spp"]] = f"{o['spp']:g} spp"
        row[o["spp"]] = " / ".join(tables.number(o["ratios"][m][0], 3) if o["ratios"] else "1" for m in ("relmse_trimmed", "flip_ldr"))
        if o["spp"] == 8:
            row["energy"], row["CPU-s"] = f"{o['quantities']['energy_ratio'][0]:.2f}", tables.number(o["quantities"]["cpu_total"][0], 2)
    last = ("energy", "CPU-s")
    return tables.markdown(["sampler + filter", *budgets.values(), *last], [[name, *(row.get(k, "") for k in (*budgets, *last))] for name, row in rows.items()])


def needed(store, plan, methods, budgets):
    """Recording by method: samples a pixel with which it has the relMSE that the plan's baseline has with `budgets`."""
    rows = {}
    for curve in store.json(plan, "statistics.json").get("needed", ()):
        name = short_name(f"{curve['sampler']} + {curve['filter']}")
        if name in methods:
            found = {n["at"]: {"at most": "≤", "more than": ">"}.get(n["bound"], "") + tables.number(n["spp"], 2) for n in curve["needed"]}
            rows.setdefault(curve["dump"], {})[name] = ", ".join(found.get(b, "–") for b in budgets)
    return tables.markdown(["recording", *methods], [[name, *(row.get(m, "–") for m in methods)] for name, row in rows.items()])


def two_sizes(store, plan):
    """Scene by method and budget: relMSE over that of the plan's baseline, of the smaller picture and of the larger one."""
    ratios = {}
    for claim in store.claims(plan):
        if claim["metric"] == "relmse":
            for p in claim["places"]:
                scene = p["dump"].removesuffix("_512").removesuffix("_256")
                column = f"{short_name(claim['better']).partition(' + ')[2]}, {p['spp']:g}"
                ratios.setdefault(scene, {}).setdefault(column, []).append(tables.number(p["ratio"][0], 3))
    columns = sorted({column for of in ratios.values() for column in of})
    return tables.markdown(["", *columns], [[scene, *("→".join(of.get(c, "–")) for c in columns)] for scene, of in ratios.items()])


def chapters_of(full):
    return [c for c in CHAPTERS if (c["plans"][0] not in FULL["left_out"] if full else not c.get("full"))]


def place_text(claim, plan, store):
    """Where a claim holds, and its least and largest ratio, with a link to every place."""
    counts = claim["counts"]
    more = [f"{counts[w]} {w}" for w in tables.ORDER[1:3] if counts.get(w)]
    compared = sum(counts.get(word, 0) for word in tables.ORDER[:3])
    ratios = sorted(p["ratio"][0] for p in claim["places"] if p["ratio"] and p["verdict"] in tables.ORDER[:3])
    spread = f"; {' to '.join(dict.fromkeys(tables.number(r, 3 if 0.9 < r < 1.1 else 2) for r in (ratios[0], ratios[-1])))}" if ratios else ""
    name = plan.split("_")[0].upper()
    bound = "" if claim["below"] == 1 else f" below {claim['below']:g}"
    late = tables.LATE if claim.get("after_results") else ""
    return f"([{name}](results/{store.folder.name}/{plan}_claims.csv){late}: {counts.get('holds', 0)} of {compared} hold{bound}{''.join(', ' + m for m in more)}{spread})"


def said(match, small, full):
    """Of full size, where the plan was run so and the word small does not stand before it."""
    plan, better, than, metric, samples, verdict = (part.strip() for part in match.group(1).split(";"))
    of_small, plan = plan.startswith("small "), plan.removeprefix("small ")
    store = full if full.texts(plan) and not of_small else small
    metric, _, below = (part.strip() for part in metric.partition("<"))
    found = [c for c in store.claims(plan) if (c["better"], c["than"], c["metric"], c["samples"]) == (better, than, metric, samples)
             and (not below or c["below"] == float(below))]
    if len(found) != 1:
        raise Changed(f"{match.group(0)}: {len(found) or 'no'} such claims are kept: write the sentence anew, or the bound behind the metric")
    if found[0]["verdict"] != verdict:
        raise Changed(f"{match.group(0)}: the verdict is now '{found[0]['verdict']}': write the sentence anew")
    return place_text(found[0], plan, store)


def page(template, small, full):
    """The text of a page, from what is kept of both sizes."""
    text = (HERE / "templates" / template).read_text(encoding="utf-8")
    text = CLAIM.sub(lambda match: said(match, small, full), text)
    for name, made in (("chapters", lambda: chapters_table(small, full)),
                       ("readings", lambda: readings((full, small), READINGS)), ("rivals", lambda: rivals(small, full)),
                       ("equal_time", lambda: equal_time(small, QUICK, "quick")),
                       ("beside_network", lambda: beside_network(full, NETWORK)),
                       ("two_sizes", lambda: two_sizes(full, "n2_size")),
                       ("needed", lambda: needed(full, NETWORK, ("`uniform` + `ensemble`", "`cross_halves` + `ensemble{weights=halves}`"), (8, 16, 32))),
                       ("matrix", lambda: matrix(full, METHODS, ("e9_chess", "e10_balls")))):
        if "{{" + name + "}}" in text:
            text = text.replace("{{" + name + "}}", made())
    return text.rstrip("\n") + "\n"


def write_csv(store, chapter):
    """Every place of a chapter's claims."""
    for plan in (*chapter["plans"], *chapter.get("more", ())):
        if store.claims(plan):
            write_whole(store.folder / f"{plan}_claims.csv", tables.claims_csv(store.claims(plan)))


def write(docs, full):
    """Pages and tables, in the folder of the pages; findings are those of full size."""
    small, large = (Kept(docs / "results" / name) for name in ("experiments", "experiments_full"))
    store = large if full else small
    store.folder.mkdir(parents=True, exist_ok=True)
    for chapter in chapters_of(full):
        write_csv(store, chapter)
    made = {name: page(f"{name}.in", small, large) for name in (("experiments", "findings", "filters") if full else ("experiments",))}
    for name, text in made.items():
        write_whole(docs / f"{name}.md", text)
