"""Which methods are re-implementations by description: [R] beside their names in every table."""
import json
import re

MARK = "[R] marks re-implementations by description, not from the primary text: indicative only."


def described(folders):
    """Names of such methods in the manifests of the folders."""
    names = set()
    for folder in folders:
        manifest = json.loads((folder / "manifest.json").read_text())
        for kind in ("samplers", "filters"):
            names |= {m["name"] for m in manifest["plan"][kind] if m.get("by_description")}
    return names


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
