"""The headers of lib/ and formats/ as Doxygen reads them: header_comments.py FOLDER

// before a declaration becomes ///, behind one ///<; the first block is the file's own.
"""

import re
import sys
from pathlib import Path

TREE = Path(__file__).resolve().parents[2]
WHOLE = re.compile(r"^(\s*)//(?![/<])\s?(.*)$")
BEHIND = re.compile(r"^(.*\S)\s+//(?![/<])\s?(.*)$")


def escaped(text):
    return re.sub(r"([@\\<>#&])", r"\\\1", text)


def converted(lines):
    behind = False
    yield "/// @file"
    for line in lines:
        if whole := WHOLE.match(line):
            mark = "///<" if behind and len(whole[1]) > 8 else "///"
            yield f"{whole[1]}{mark} {escaped(whole[2])}"
            continue
        found = BEHIND.match(line) if '"' not in line else None
        behind = found is not None
        yield f"{found[1]}  ///< {escaped(found[2])}" if found else line


def main():
    folder = Path(sys.argv[1])
    for room in ("lib", "formats"):
        for header in (TREE / room).rglob("*.h"):
            made = folder / header.relative_to(TREE)
            made.parent.mkdir(parents=True, exist_ok=True)
            text = header.read_text(encoding="utf-8")
            made.write_text("\n".join(converted(text.splitlines())) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
