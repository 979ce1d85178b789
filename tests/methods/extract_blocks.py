"""Writes the C++ blocks of a page to the files that their first lines name: extract_blocks.py PAGE FOLDER"""
import pathlib
import re
import sys

page, folder = map(pathlib.Path, sys.argv[1:])
blocks = re.findall(r"^```cpp\n// (\S+)\n(.*?)^```$", page.read_text(), re.MULTILINE | re.DOTALL)
if not blocks:
    sys.exit(f"{page}: no block ```cpp that begins with // FILE")
for name, text in blocks:
    target = folder / name
    target.parent.mkdir(parents=True, exist_ok=True)
    if not target.exists() or target.read_text() != text:
        target.write_text(text)
