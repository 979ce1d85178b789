"""Checks that no compiler makes: citations, absolute paths, file lengths.

Every [Key, ...] in a header or source must be in docs/references.bib; no file names a path of one
machine; every seeded bug of tests/mutation applies to the code as it is; files over 250 lines are listed (long tables are fine, long reasoning is not).
"""

import re
import subprocess
import sys
import tomllib
from pathlib import Path

LONG_FILE_LINES = 250
# A key of the bibliography in brackets: [LiuZheng, eq 5], [Ottosson20].
CITATION = re.compile(r"\[([A-Z][A-Za-z]+[A-Za-z0-9]*)(?:,\s[^\]]*|\s[^\]]*)?\]")
ABSOLUTE_PATH = re.compile(r"(?<![\w.$}])/(?:home|root|work|Users|mnt|media)/\w+")
TEXT_SUFFIXES = {".h", ".cpp", ".py", ".md", ".sh", ".cmake", ".txt", ".json", ".toml", ".bib"}


def tracked_files():
    listing = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard", "-z"],
        check=True, capture_output=True).stdout
    return [Path(name) for name in listing.decode().split("\0") if name and Path(name).is_file()]


def bibliography_keys():
    path = Path("docs/references.bib")
    return set(re.findall(r"^@\w+\{([^,\s]+)", path.read_text(), re.M)) if path.exists() else set()


def comment_text(line):
    """The comment part of a line of C++, so that array indices are not taken for citations."""
    at = line.find("//")
    return line[at:] if at >= 0 else ""


def unknown_citations(path, text, keys):
    for number, line in enumerate(text.splitlines(), 1):
        for key in CITATION.findall(comment_text(line)):
            if key not in keys and any(c.islower() for c in key):
                yield f"{path}:{number}: [{key}] is not in docs/references.bib"


def bugs_that_do_not_apply():
    """The code moves on; a bug whose text is gone would be a test of the tests that never runs."""
    for bug in tomllib.loads(Path("tests/mutation/mutations.toml").read_text(encoding="utf-8"))["mutation"]:
        path = Path(bug["file"])
        found = path.read_text(encoding="utf-8").count(bug["old"]) if path.is_file() else 0
        if found != 1:
            yield f"tests/mutation/mutations.toml: {bug['id']}: its text stands {found} times in {bug['file']}"


def main():
    problems, long_files = list(bugs_that_do_not_apply()), []
    keys = bibliography_keys()
    for path in tracked_files():
        if path.suffix not in TEXT_SUFFIXES:
            continue
        text = path.read_text(encoding="utf-8", errors="replace")
        if path.suffix in {".h", ".cpp"}:
            problems += unknown_citations(path, text, keys)
        if path.name != "lint.py":
            for number, line in enumerate(text.splitlines(), 1):
                if ABSOLUTE_PATH.search(line):
                    problems.append(f"{path}:{number}: a path of one machine: {line.strip()[:80]}")
        lines = text.count("\n")
        if path.suffix in {".h", ".cpp", ".py"} and lines > LONG_FILE_LINES:
            long_files.append((lines, path))
    for lines, path in sorted(long_files, reverse=True):
        print(f"note: {path} has {lines} lines")
    for problem in problems:
        print(problem)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
