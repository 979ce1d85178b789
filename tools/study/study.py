#!/usr/bin/env python3
"""Runs the plans of tools/plans, keeps what they gave, and writes docs/experiments.md and docs/findings.md from it.

    tools/dev.sh experiments                 every experiment; what is done is not done again
    tools/dev.sh experiments E1 A3 methods   these; the page keeps what is there of the others
    tools/dev.sh experiments --write-only    only the page, from what is kept in docs/results/experiments
    tools/dev.sh experiments --judge         what is kept of full size judged anew by the program: after a change of its claims
    tools/dev.sh experiments --full          the same on those recordings of full size that are here, added to what
                                             was measured before, on any machine: docs/findings.md
    tools/dev.sh experiments --full E4 --recording torus    that alone; with --again although it was measured
"""
import argparse
import sys
from pathlib import Path

from tools.study import full_size, kept, pages
from tools.study.plans import PLANS, ROOT, full_recording, make_recordings, read


def parse():
    parser = argparse.ArgumentParser(prog="experiments", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("ids", nargs="*", help="of the experiments; default: all")
    parser.add_argument("--program", default=ROOT / "build/release/spool", type=Path)
    parser.add_argument("--full", action="store_true", help="on recordings of full size")
    parser.add_argument("--results", type=Path, help="one folder per plan in it; default: build/experiments[_full]")
    parser.add_argument("--output", default=ROOT / "docs", type=Path, help="folder of the pages")
    parser.add_argument("--threads", default="0")
    parser.add_argument("--recording", action="append", help="of full size: these alone")
    parser.add_argument("--again", action="store_true", help="of full size: also what was measured")
    parser.add_argument("--more", action="store_true", help="also plans that only add recordings")
    parser.add_argument("--judge", action="store_true", help="run nothing; judge anew what is kept of full size")
    parser.add_argument("--write-only", action="store_true")
    arguments = parser.parse_args()
    arguments.full = arguments.full or arguments.judge
    if not arguments.full and (arguments.recording or arguments.again):
        parser.error("--recording and --again are of full size: give --full too")
    arguments.results = arguments.results or ROOT / "build" / ("experiments_full" if arguments.full else "experiments")
    known = {name.lower() for c in pages.CHAPTERS for name in (c["id"], c.get("also", c["id"]))}
    unknown = [i for i in arguments.ids if i.lower() not in known]
    if unknown:
        parser.error(f"no experiment {unknown[0]}: there are {', '.join(c['id'] for c in pages.CHAPTERS)}")
    return arguments


def chosen(arguments, full):
    wanted = {i.lower() for i in arguments.ids}
    return [c for c in pages.chapters_of(full) if not wanted or wanted & {c["id"].lower(), c.get("also", "").lower()}]


def run_small(arguments):
    make_recordings(arguments.program)
    for chapter in chosen(arguments, False):
        for plan in (*chapter["plans"], *(chapter.get("more", ()) if arguments.more else ())):
            folder = arguments.results / plan
            threads = () if "threads" in read(PLANS / f"{plan}.toml") else ("--threads", arguments.threads)
            kept.evaluate(arguments.program, PLANS / f"{plan}.toml", folder, *threads)
            kept.pack(arguments.output / f"results/experiments/{plan}.tar.xz", kept.texts_of(folder))


def write_so_far(output):
    """The run may be stopped any time; a sentence whose verdict has changed is left to its end."""
    try:
        pages.write(output, True)
    except pages.Changed as changed:
        print(f"study: {changed}", file=sys.stderr, flush=True)


def run_full(arguments):
    store = full_size.Store(arguments.program, arguments.results, arguments.output / "results/experiments_full", arguments.threads)
    known = dict.fromkeys(name for chapter in chosen(arguments, True) for plan in chapter["plans"] for name in full_size.full_recordings(plan))
    for name in arguments.recording or ():
        if name not in known:
            raise kept.Failed(f"--recording {name}: there are {', '.join(known)}")
        if full_recording(arguments.program, name, store.scratch / "pools") is None:
            raise kept.Failed(f"--recording {name}: is not here: tools/dev.sh record {name}")
    for chapter in chosen(arguments, True):
        for plan in chapter["plans"]:
            if arguments.judge:
                store.judge(plan)
                continue
            for name in full_size.full_recordings(plan):
                if not arguments.recording or name in arguments.recording:
                    if store.measure(plan, name, arguments.again):
                        write_so_far(arguments.output)


def main():
    arguments = parse()
    if not arguments.write_only:
        (run_full if arguments.full else run_small)(arguments)
    pages.write(arguments.output, arguments.full)


if __name__ == "__main__":
    kept.run(main)
