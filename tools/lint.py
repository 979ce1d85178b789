"""Checks that no compiler makes: one rule a file, in tools/lint_rules."""

import subprocess
import sys
from pathlib import Path

from lint_rules import citations, file_shapes, includes, machine_paths, pages, parsers, seeded_bugs, words


def tracked_files():
    listing = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard", "-z"],
        check=True, capture_output=True).stdout
    return [Path(name) for name in listing.decode().split("\0") if name and Path(name).is_file()]


def main():
    files = tracked_files()
    for note in file_shapes.long_files(files):
        print(f"note: {note}")
    problems = [*seeded_bugs.check(), *citations.check(files), *machine_paths.check(files), *parsers.check(files), *includes.check(),
                *file_shapes.check(files), *pages.check(files), *words.check(files)]
    for problem in problems:
        print(problem)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
