"""Puts the pages of the tree, and what they link, where MkDocs reads them: stage.py FOLDER

The site has the tree's own folders, so links stay as they are; a link to a folder becomes one to its README, and links to
sources lead to copies. Notebooks (docs/examples/*.py with `# %%` cells) become pages when jupytext is there.
"""

import re
import shutil
import subprocess
import sys
from pathlib import Path

TREE = Path(__file__).resolve().parents[2]
LINK = re.compile(r"(\]\()([^)\s#]+)((?:#[^)\s]*)?\))")
# An indented or fenced block is code: what looks like a link there is none.
CODE = re.compile(r"^```.*?^```$|^(?: {4}[^\n]*\n)+|`[^`\n]+`", re.M | re.S)


def tracked(*patterns):
    listed = subprocess.run(["git", "ls-files", "--cached", "--others", "--exclude-standard", "-z", *patterns], cwd=TREE,
                            check=True, capture_output=True).stdout.decode()
    return [Path(name) for name in listed.split("\0") if name and (TREE / name).is_file()]


def outside_code(text, change):
    """`text` with `change` applied where it is no code."""
    parts, end = [], 0
    for block in CODE.finditer(text):
        parts += [change(text[end:block.start()]), block.group(0)]
        end = block.end()
    return "".join(parts) + change(text[end:])


def linked(page, target):
    """What a link of a page leads to, as a path in the tree: a folder is its README. None: not in the tree."""
    found = (TREE / page.parent / target).resolve()
    if found.is_dir():
        found = found / "README.md"
    return found.relative_to(TREE) if found.is_file() and found.is_relative_to(TREE) else None


def stage_page(page, folder, copied):
    def changed(match):
        before, target, after = match.groups()
        if "://" in target or target.startswith("mailto:"):
            return match.group(0)
        found = linked(page, target)
        if found is None:
            return match.group(0)  # strict MkDocs names it
        copied.add(found)
        slash = "" if target.endswith("README.md") or not (TREE / page.parent / target).is_dir() else "/README.md"
        return before + target.rstrip("/") + slash + after

    text = (TREE / page).read_text(encoding="utf-8")
    destination = folder / page
    destination.parent.mkdir(parents=True, exist_ok=True)
    destination.write_text(outside_code(text, lambda part: LINK.sub(changed, part)), encoding="utf-8")


def main():
    folder = Path(sys.argv[1])
    shutil.rmtree(folder, ignore_errors=True)
    copied, pages = set(), set(tracked("*.md"))
    for page in sorted(pages):
        stage_page(page, folder, copied)
    for file in sorted(copied - pages):
        (folder / file).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(TREE / file, folder / file)
    print(f"{len(pages)} pages, {len(copied - pages)} files that they link")


if __name__ == "__main__":
    main()
