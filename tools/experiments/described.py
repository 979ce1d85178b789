"""Which methods are re-implementations by description: [R] beside their names in every table."""
import json
import re

import measured

MARK = "[R] marks re-implementations by description, not from the primary text: indicative only."


def in_folder(folder):
    """Names of such methods in the manifest of a folder of `spool evaluate`."""
    plan = json.loads((folder / "manifest.json").read_text())["plan"]
    return {m["name"] for kind in ("samplers", "filters") for m in plan[kind] if m.get("by_description")}


def described(sources):
    """Names of such methods in folders, or files of measured.py."""
    return set().union(*(in_folder(s) if s.is_dir() else measured.read_head(s)["described"] for s in sources))


def marked(blocks, names):
    """The blocks with the mark in every row of a table; what it means is said once, before them."""
    if not names:
        return blocks
    label = re.compile(rf"(?<![\w`])(?:{'|'.join(sorted(names))})\b(?::\w+)?(?:\{{[^}}]*\}})?(?! \[R\])")
    # "AWR" is how figures of others call adaptive_wavelet.
    label = re.compile(label.pattern + r"|\bAWR\b(?! \[R\])") if "adaptive_wavelet" in names else label
    lines = ["\n".join(label.sub(r"\g<0> [R]", line) if line.startswith("|") else line
                       for line in block.split("\n")) for block in blocks]
    return lines if lines == blocks else [MARK, *lines]
