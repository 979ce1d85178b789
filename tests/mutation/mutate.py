#!/usr/bin/env python3
"""Applies the seeded bugs of mutations.toml one at a time and sees whether the tests notice.

A copy of the tree is kept in build/mutation/tree; nothing outside it is changed. Each bug: replace the text, build the
test programs named, run them until one fails (killed), put the text back. A bug that survives them is tried against
every other test program (--whole). Results: a table, and build/mutation/results.json.
"""
import argparse
import json
import os
import shutil
import subprocess
import sys
import time
import tomllib
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
TEST_TIMEOUT = 300  # seconds; a test that hangs has noticed


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
        subprocess.run(["cmake", "-G", "Ninja", "-S", tree, "-B", self.build, *launcher, "-DCMAKE_BUILD_TYPE=",
                        "-DCMAKE_CXX_FLAGS=-O1 -w -DSPOOL_NO_VECTOR_CLONES"], check=True, stdout=subprocess.DEVNULL)
        targets = subprocess.run(["ninja", "-C", self.build, "-t", "targets", "all"], check=True, capture_output=True,
                                 text=True).stdout
        self.programs = sorted({line.split(":")[0] for line in targets.splitlines()
                                if line.startswith("test_") and line.endswith(": phony")})

    def make(self, program):
        # The library module is opened at run time; tests of pictures need it.
        return subprocess.run(["ninja", "-C", self.build, "-j", str(self.jobs), "--quiet", program],
                              capture_output=True, text=True)

    def passes(self, program):
        path = next(self.build.glob(f"tests/*/{program}"))
        try:
            return subprocess.run([path, "--gtest_brief=1", "--gtest_fail_fast"], cwd=path.parent, timeout=TEST_TIMEOUT,
                                  capture_output=True).returncode == 0
        except subprocess.TimeoutExpired:
            return False


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
    for program in programs:
        made = bench.make(program)
        if made.returncode != 0:
            return "does not build", made.stdout.splitlines()[-1] if made.stdout else program
        if not bench.passes(program):
            return "killed", program
    return "survived", ""


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("ids", nargs="*", help="mutations to try (default: all)")
    parser.add_argument("--jobs", type=int, default=1, help="compilers at once")
    parser.add_argument("--whole", action="store_true", help="meet a survivor with every test program")
    parser.add_argument("--trust", action="store_true", help="do not run the tests without a bug first")
    parser.add_argument("--nice", type=int, default=10, help="how far to stand back behind other work")
    options = parser.parse_args()
    os.nice(options.nice)
    mutations = load_mutations(options.ids)
    folder = ROOT / "build" / "mutation"
    tree = folder / "tree"
    copy_tree(tree)
    bench = Bench(tree, options.jobs)
    for program in sorted({f"test_{name}" for m in mutations for name in m["tests"]}):
        made = bench.make(program)
        if made.returncode != 0 or not (options.trust or bench.passes(program)):
            sys.exit(f"mutate.py: {program} does not pass without a bug in it: repair that first")

    results_path = folder / "results.json"
    known = json.loads(results_path.read_text(encoding="utf-8")) if results_path.exists() else {}
    for mutation in mutations:
        path = tree / mutation["file"]
        start = time.monotonic()
        before = replace(path, mutation["old"], mutation["new"])
        try:
            outcome, by = judge(bench, mutation, options.whole)
        finally:
            path.write_text(before, encoding="utf-8")
        known[mutation["id"]] = {"file": mutation["file"], "outcome": outcome, "by": by,
                                 "seconds": round(time.monotonic() - start, 1)}
        print(f"{outcome:14} {mutation['id']:44} {by}", flush=True)
        results_path.write_text(json.dumps(known, indent=1), encoding="utf-8")
    outcomes = [known[m["id"]]["outcome"] for m in mutations]
    print(f"{outcomes.count('killed')} of {len(outcomes)} killed, {outcomes.count('survived')} survived, "
          f"{outcomes.count('does not build')} do not build")
    return 0 if outcomes.count("killed") == len(outcomes) else 1


if __name__ == "__main__":
    sys.exit(main())
