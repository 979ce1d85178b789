"""Every [Key, ...] in a comment is a key of docs/references.bib."""

import re
from pathlib import Path

# [LiuZheng, eq 5], [Ottosson20].
CITATION = re.compile(r"\[([A-Z][A-Za-z]+[A-Za-z0-9]*)(?:,\s[^\]]*|\s[^\]]*)?\]")


def bibliography_keys():
    path = Path("docs/references.bib")
    return set(re.findall(r"^@\w+\{([^,\s]+)", path.read_text(), re.M)) if path.exists() else set()


def comment_of(line):
    """The comment part of a line of C++, so that array indices are not taken for citations."""
    at = line.find("//")
    return line[at:] if at >= 0 else ""


def check(files):
    keys = bibliography_keys()
    for path in files:
        if path.suffix not in {".h", ".cpp"}:
            continue
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            for key in CITATION.findall(comment_of(line)):
                if key not in keys and any(c.islower() for c in key):
                    yield f"{path}:{number}: [{key}] is not in docs/references.bib"
