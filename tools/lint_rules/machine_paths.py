"""No file names a path of one machine."""

import re

ABSOLUTE_PATH = re.compile(r"(?<![\w.$}])/(?:home|root|work|Users|mnt|media)/\w+")
TEXT_SUFFIXES = {".h", ".cpp", ".py", ".md", ".sh", ".cmake", ".txt", ".json", ".toml", ".bib"}


def check(files):
    for path in files:
        if path.suffix not in TEXT_SUFFIXES or path.name == "machine_paths.py":
            continue
        for number, line in enumerate(path.read_text(encoding="utf-8", errors="replace").splitlines(), 1):
            if ABSOLUTE_PATH.search(line):
                yield f"{path}:{number}: a path of one machine: {line.strip()[:80]}"
