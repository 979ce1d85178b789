#!/usr/bin/env python3
"""Applies the seeded bugs of mutations.toml one at a time and sees whether the tests notice.

A copy of the tree is kept in build/mutation/tree; nothing outside it is changed. Each bug: replace the text, build the
test programs named, run them until one fails (killed), put the text back. A bug that survives them is tried against
every other test program (--whole). Results: a table, and build/mutation/results.json.
"""
import argparse
import json
import os
import resource
import shutil
import subprocess
import sys
import time
import tomllib
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
HANGS = 10, 20  # times the CPU seconds that a program takes without a bug, and seconds more: a test that hangs has noticed


def load_mutations(wanted):
    mutations = tomllib.loads((HERE / "mutations.toml").read_text(encoding="utf-8"))["mutation"]
    unknown = set(wanted) - {m["id"] for m in mutations}
    if unknown:
        sys.exit(f"mutate.py: no mutation {', '.join(sorted(unknown))}: see tests/mutation/mutations.toml")
    return [m for m in mutations if not wanted or m["id"] in wanted]


def copy_tree(tree):
    """Brings the copy up to date; files that did not change keep their time, so that little is built again."""
    listed = subprocess.run(["git", "ls-files", "--cached", "--others", "--exclude-standard", "-z"], cwd=ROOT,
                            check=True, capture_output=True).stdout.decode().split("\0")
    names = {name for name in listed if name and (ROOT / name).is_file()}
    for name in names:
        source, target = ROOT / name, tree / name
        if not target.exists() or source.read_bytes() != target.read_bytes():
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(source, target)
            shutil.copymode(source, target)
    for path in [p for p in tree.rglob("*") if p.is_file() and "build" not in p.relative_to(tree).parts[:1]]:
        if str(path.relative_to(tree)) not in names:
            path.unlink()


class Bench:
    """The copy, its build folder, and its test programs."""

    def __init__(self, tree, jobs):
        self.tree, self.build, self.jobs = tree, tree / "build" / "mutation", jobs
        # The same results, built in a third of the time: one bug is one compilation and some links.
        launcher = ["-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"] if shutil.which("ccache") else []
        subprocess.run(["cmake", "-G", "Ninja", "-S", tree, "-B", self.build, *launcher, "-DCMAKE_BUILD_TYPE=Release",
                        "-DCMAKE_CXX_FLAGS_RELEASE=-O1", "-DCMAKE_CXX_FLAGS=-w -DSPOOL_NO_VECTOR_CLONES"], check=True,
                       stdout=subprocess.DEVNULL)
        targets = subprocess.run(["ninja", "-C", self.build, "-t", "targets", "all"], check=True, capture_output=True,
                                 text=True).stdout
        self.programs = sorted({line.split(":")[0] for line in targets.splitlines()
                                if line.startswith("test_") and line.endswith(": phony")})
        self.sound = {}  # CPU seconds of programs that pass without a bug

    def make(self, program):
        # The library module is opened at run time; tests of pictures need it.
        return subprocess.run(["ninja", "-C", self.build, "-j", str(self.jobs), "--quiet", program],
                              capture_output=True, text=True)

    def passes(self, program):
        path = next(self.build.glob(f"tests/*/{program}"))
        factor, more = HANGS
        limit = int(factor * self.sound.get(program, 100) + more)  # CPU time: the machine may be busy
        return subprocess.run([path, "--gtest_brief=1", "--gtest_fail_fast"], cwd=path.parent, capture_output=True,
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (limit, limit))).returncode == 0


    def expect_sound(self, program):
        if program in self.sound:
            return
        made = self.make(program)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        if made.returncode != 0 or not self.passes(program):
            sys.exit(f"mutate.py: {program} does not pass without a bug in it: repair that first\n{made.stdout[-2000:]}")
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        self.sound[program] = after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def replace(path, old, new):
    """Puts `new` for `old`, which must occur once, and gives the text as it was."""
    text = path.read_text(encoding="utf-8")
    if text.count(old) != 1:
        sys.exit(f"mutate.py: {path.name}: text occurs {text.count(old)} times, not once: {old!r}")
    path.write_text(text.replace(old, new), encoding="utf-8")
    return text


def judge(bench, mutation, whole):
    programs = [f"test_{name}" for name in mutation["tests"]]
    if whole:
        programs += [p for p in bench.programs if p not in programs]
    path = bench.tree / mutation["file"]
    for program in programs:
        bench.expect_sound(program)
        before = replace(path, mutation["old"], mutation["new"])
        try:
            made = bench.make(program)
            if made.returncode != 0:
                return "does not build", made.stdout.splitlines()[-1] if made.stdout else program
            if not bench.passes(program):
                return "killed", program
        finally:
            path.write_text(before, encoding="utf-8")
    return "survived", ""


def write_table(path, mutations, known):
    """The outcome of each bug as a page."""
    tried = [m for m in mutations if m["id"] in known]
    killed = sum(known[m["id"]]["outcome"] == "killed" for m in tried)
    newer = "" if len(tried) == len(mutations) else f" {len(mutations) - len(tried)} newer or changed ones have not run."
    lines = ["# Seeded bugs", "", "Written by `tools/dev.sh mutate`; the bugs are `mutations.toml`. "
             f"{killed} of {len(tried)} killed.{newer}", "", "| bug | file | outcome | by |", "|---|---|---|---|"]
    for m in tried:
        result = known[m["id"]]
        by = result["by"].removeprefix("test_") if result["outcome"] == "killed" else ""
        lines.append(f"| `{m['id']}` | `{m['file']}` | {result['outcome']} | {by} |")
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("ids", nargs="*", help="mutations to try (default: all)")
    parser.add_argument("--jobs", type=int, default=1, help="compilers at once")
    parser.add_argument("--whole", action="store_true", help="meet a survivor with every test program")
    parser.add_argument("--again", action="store_true", help="also those whose outcome is known from an earlier run")
    parser.add_argument("--nice", type=int, default=10, help="how far to stand back behind other work")
    options = parser.parse_args()
    os.nice(options.nice)
    mutations = load_mutations(options.ids)
    folder = ROOT / "build" / "mutation"
    tree = folder / "tree"
    copy_tree(tree)
    bench = Bench(tree, options.jobs)
    results_path = folder / "results.json"
    known = json.loads(results_path.read_text(encoding="utf-8")) if results_path.exists() else {}
    # Bugs that need the same program together: the first one's build is the others' too.
    for mutation in sorted(mutations, key=lambda m: (m["tests"][0], m["file"])):
        recipe = {key: mutation[key] for key in ("file", "old", "new")}
        if not options.again and not options.ids and known.get(mutation["id"], {}).get("recipe") == recipe:
            continue
        start = time.monotonic()
        outcome, by = judge(bench, mutation, options.whole)
        known[mutation["id"]] = {"recipe": recipe, "outcome": outcome, "by": by,
                                 "seconds": round(time.monotonic() - start, 1)}
        print(f"{outcome:14} {mutation['id']:44} {by}", flush=True)
        results_path.write_text(json.dumps(known, indent=1), encoding="utf-8")
    if not options.ids:
        write_table(HERE / "results.md", mutations, known)
    outcomes = [known[m["id"]]["outcome"] for m in mutations]
    print(f"{outcomes.count('killed')} of {len(outcomes)} killed, {outcomes.count('survived')} survived, "
          f"{outcomes.count('does not build')} do not build")
    return 0 if outcomes.count("killed") == len(outcomes) else 1


if __name__ == "__main__":
    sys.exit(main())
