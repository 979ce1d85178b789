#!/usr/bin/env python3
"""Tunes the preset robust of multiscale + directional and writes docs/tuning.md.

    tools/dev.sh tune                 candidates, rivals, the choice, its judgement; what is done is not done again
    tools/dev.sh tune --write-only    only the page, from the results that are there
    tools/dev.sh tune --full          its last part alone: the same question on recordings of full size (tuning_full.py)

The candidates are those of tools/plans/tuning.toml, on the pools that choose. For each of these the choice is made from
the others and judged on it; the choice from all is judged on pools that never choose (tools/experiments/tuning_pools.py).
"""
import argparse
import itertools
import json
import os
import subprocess
import sys
import zlib
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from page_tables import take_apart  # noqa: E402
import tuning_full  # noqa: E402
from evaluation import evaluate  # noqa: E402
from full_size import Measuring  # noqa: E402
from pools import PLANS, make_pools  # noqa: E402
from inference import use_program  # noqa: E402
from results import Results  # noqa: E402
from tuning_choice import Candidate, Scores  # noqa: E402
from tuning_page import page  # noqa: E402
from tuning_pools import ALONE, APART, CHOOSING, SECOND, recording  # noqa: E402
from tuning_verdict import RIVALS  # noqa: E402
from whole_file import with_last_part, write_whole  # noqa: E402

ROOT = PLANS.parents[1]
SAMPLER, FILTER = "multiscale", "directional"
BUDGETS = [4, 8, 16]
CONTROL = ("uniform", "box")


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=ROOT / "build/release/spool", type=Path)
    parser.add_argument("--results", default=ROOT / "build/tuning", type=Path)
    parser.add_argument("--output", default=ROOT / "docs/tuning.md", type=Path)
    parser.add_argument("--threads", default="0")
    parser.add_argument("--write-only", action="store_true")
    parser.add_argument("--full", action="store_true", help="on recordings of full size that are here")
    return parser.parse_args()


def results_of(plan, folder, arguments):
    """The folder, or None where there are no results and none are to be made."""
    if arguments.write_only:
        return folder if (folder / "results.jsonl").exists() else None
    evaluate(arguments.program, plan, folder, arguments.threads)
    return folder


def defaults_of(program, kind, name):
    listed = json.loads(subprocess.run([program, "list", kind, "--json"], check=True, capture_output=True, text=True).stdout)
    options = next(m["options"] for m in listed if m["name"] == name)
    return {o["name"]: o["defaults"]["robust"] for o in options}


def changes(manifest, kind, name, defaults):
    """{label: ((option, value), ...) that differ from the defaults} of a plan's settings of one method."""
    return {m["label"]: tuple((o, v) for o, v in m["options"].items() if v != defaults[o])
            for m in manifest["plan"][kind] if m["name"] == name and m.get("preset") == "robust"}


def candidate_cells(results, manifest, defaults):
    """{Candidate: {pool: [(relMSE, energy, relMSE of the defaults) per budget]}}"""
    samplers = changes(manifest, "samplers", SAMPLER, defaults["samplers"])
    filters = changes(manifest, "filters", FILTER, defaults["filters"])
    plain = [next((label for label, options in found.items() if not options), None) for found in (samplers, filters)]
    if None in plain:
        sys.exit("tune: the plan lacks the defaults: every other candidate is compared with them")
    cells, seen = {}, set()
    for place, ((s_label, s), (f_label, f)) in enumerate(itertools.product(samplers.items(), filters.items())):
        if (s, f) in seen:  # a default written out
            continue
        seen.add((s, f))
        cells[Candidate(s, f, place)] = {
            pool: [(results.values("relmse", pool, s_label, f_label, spp),
                    results.values("energy_ratio", pool, s_label, f_label, spp),
                    results.values("relmse", pool, *plain, spp)) for spp in BUDGETS] for pool in CHOOSING}
    return cells


def label(name, options):
    return name + ("{" + ",".join(f"{o}={v}" for o, v in sorted(options)) + "}" if options else "")


def methods(candidate):
    return label(SAMPLER, candidate.sampler), label(FILTER, candidate.filter)


def quoted(names):
    return json.dumps(list(dict.fromkeys(names)))


def singles(candidate):
    """Each change of a candidate alone, and the defaults."""
    return [Candidate((), (), -1), *(Candidate((c,), (), -1) for c in candidate.sampler),
            *(Candidate((), (c,), -1) for c in candidate.filter)]


def judging_plan(pools, candidates, folder, budgets=BUDGETS, rivals=(CONTROL, *RIVALS)):
    """The candidates beside the rivals, every sampler with every filter: that tells which of the two loses."""
    def entries(kind, name, settings):
        for options in dict.fromkeys(settings):
            yield "\n".join([f"[[{kind}]]", f'name = "{name}"', *(f'{o} = "{v}"' for o, v in options)])

    return "\n".join([
        f'title = "judged on {", ".join(pools)}"',
        f"recordings = {json.dumps([os.path.relpath(ROOT / recording(p), folder) for p in pools])}",
        f"spp = {budgets}", "replicates = 8", "pictures = false",
        f"samplers = {quoted(s for s, _ in rivals)}", f"filters = {quoted(f for _, f in rivals)}",
        *entries("sampler", SAMPLER, [c.sampler for c in candidates]),
        *entries("filter", FILTER, [c.filter for c in candidates])]) + "\n"


def judge(name, pools, candidates, arguments, **more):
    folder = arguments.results / "judged"
    folder.mkdir(parents=True, exist_ok=True)
    text = judging_plan(pools, candidates, folder, **more)
    plan = folder / f"{name}-{zlib.crc32(text.encode()):08x}.toml"  # another choice is another folder
    write_whole(plan, text)
    return results_of(plan, plan.with_suffix(""), arguments)


def choices(left_out, from_all):
    """{pool: the candidate that it judges, that chose without it}"""
    return ({p: left_out[p].candidate for p in CHOOSING} | {p: left_out[scene].candidate for p, scene in SECOND.items()}
            | {p: from_all.candidate for p in APART})


def full_section(arguments):
    """Of the page, from all that was ever measured; measures first, where that is asked."""
    folder = arguments.output.parent / "results"
    measuring = Measuring(arguments.program, PLANS, ROOT / "build/experiments_full", folder / "experiments_full/measured", arguments.threads)
    if arguments.full and not arguments.write_only:
        for name in (*tuning_full.CHOOSING, *tuning_full.APART):
            measuring.measure(tuning_full.PLAN, name, False)
    with_rivals = {file.stem: file for plan in ("e10_balls", "e9_chess") for file in measuring.sources(plan)}  # a recording once
    text = tuning_full.section(measuring.sources(tuning_full.PLAN), measuring.missing(tuning_full.PLAN), list(with_rivals.values()))
    return take_apart(text, "tuning_full", folder)


def main():
    arguments = parse()
    use_program(arguments.program)
    if arguments.full:
        page_now = arguments.output.read_text(encoding="utf-8")
        write_whole(arguments.output, with_last_part(page_now, tuning_full.TITLE, full_section(arguments)))
        return
    make_pools(arguments.program, PLANS / "pools")
    folder = results_of(PLANS / "tuning.toml", arguments.results / "candidates", arguments)
    if folder is None:
        sys.exit("tune: no candidate was measured yet: run it without --write-only first")
    manifest = json.loads((folder / "manifest.json").read_text())
    defaults = {"samplers": defaults_of(arguments.program, "samplers", SAMPLER),
                "filters": defaults_of(arguments.program, "filters", FILTER)}
    scores = Scores(candidate_cells(Results([folder]), manifest, defaults), CHOOSING)
    left_out, from_all = scores.leave_one_out(CHOOSING), scores.choose(CHOOSING)
    unchanged = Candidate((), (), -1)
    choice = choices(left_out, from_all)
    folders = {p: judge(p, [p], [c, unchanged], arguments) for p, c in choice.items()}
    judged = Results([folder for folder in folders.values() if folder])
    chosen = {p: methods(c) for p, c in choice.items() if folders[p]}
    alone = None
    if from_all.candidate.changes:
        alone = judge("alone", ALONE, [from_all.candidate, *singles(from_all.candidate)],
                      arguments, budgets=[8], rivals=())
    settings = [(c, methods(c)) for c in [*singles(from_all.candidate)[1:], from_all.candidate]]
    text = page(scores, left_out, from_all, judged, chosen, (SAMPLER, FILTER), BUDGETS,
                (Results([alone]), settings) if alone else None)
    text = take_apart(text, arguments.output.stem, arguments.output.parent / "results")
    write_whole(arguments.output, with_last_part(text, tuning_full.TITLE, full_section(arguments)))


if __name__ == "__main__":
    main()
