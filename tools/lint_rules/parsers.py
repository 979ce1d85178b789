"""JSON of any file comes in through formats/bounded_json.h, which knows its length and depth first."""

import re

PARSES = re.compile(r"json::(?:parse|sax_parse|accept|from_cbor)\b|istream.*>>.*json")
ALLOWED = {"formats/bounded_json.h", "formats/meta_rules.cpp"}  # the second asks for the same bounds


def check(files):
    for path in files:
        if path.suffix not in {".h", ".cpp"} or path.parts[0] not in {"formats", "lib", "tools"} or str(path) in ALLOWED:
            continue
        for number, line in enumerate(path.read_text(encoding="utf-8", errors="replace").splitlines(), 1):
            if PARSES.search(line):
                yield f"{path}:{number}: parses JSON of any depth: use formats/bounded_json.h"
