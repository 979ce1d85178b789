"""Every [Key, ...] in a comment is a key of docs/references.bib."""

import re
from pathlib import Path

# [LiuZheng, eq 5], [Ottosson20].
CITATION = re.compile(r"\[([A-Z][A-Za-z]+[A-Za-z0-9]*)(?:,\s[^\]]*|\s[^\]]*)?\]")


def check(files):
    keys = set(re.findall(r"^@\w+\{([^,\s]+)", Path("docs/references.bib").read_text(), re.M))
    for path in files:
        if path.suffix not in {".h", ".cpp"}:
            continue
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            for key in CITATION.findall(line.partition("//")[2]):  # of its comment: array indices are no citations
                if key not in keys and any(c.islower() for c in key):
                    yield f"{path}:{number}: [{key}] is not in docs/references.bib"
