"""Pages: links lead somewhere, every page can be reached from README.md, decisions are numbered once.

Also names of pages in text and code: `algorithms.md` in a comment is a promise that there is such a page.
"""

import re
from pathlib import Path

LINK = re.compile(r"\]\(([^)\s#]*)(?:#([^)\s]*))?\)")
PAGE_NAME = re.compile(r"(?<![\w/.*-])((?:[\w.-]+/)*[\w-]+\.md)\b")
DECISION = re.compile(r"\bdecisions?(?:\.md,)? (\d{2,4})\b")
START = Path("README.md")
MADE = {"table.md", "claims.md", "curves.md"}  # by the program, or with the site


def anchor_of(heading):
    """As GitHub makes them."""
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")


def anchors(page):
    text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)
    return {anchor_of(re.sub(r"[`*]|\]\([^)]*\)|\[", "", line)) for line in re.findall(r"^#+ (.+)$", text, re.M)}


def links(page):
    for target, anchor in LINK.findall(page.read_text(encoding="utf-8")):
        if "://" in target or target.startswith("mailto:"):
            continue
        yield (page.parent / target if target else page), anchor


def dead_links(pages):
    for page in pages:
        for target, anchor in links(page):
            if not target.exists():
                yield f"{page}: a dead link to {target}"
            elif anchor and target.suffix == ".md" and anchor not in anchors(target):
                yield f"{page}: {target} has no heading #{anchor}"


def unreached(pages):
    reached, waiting = set(), [START]
    while waiting:
        page = waiting.pop()
        if page.resolve() in reached or not page.exists():
            continue
        reached.add(page.resolve())
        waiting += [target / "README.md" if target.is_dir() else target for target, _ in links(page)
                    if target.suffix == ".md" or target.is_dir()]
    for page in pages:
        if page.resolve() not in reached:
            yield f"{page}: no page leads here; link it from docs/README.md"


def missing_names(files, pages):
    names = {page.name for page in pages} | MADE
    for path in files:
        text = path.read_text(encoding="utf-8", errors="replace")
        for number, line in enumerate(text.splitlines(), 1):
            for name in PAGE_NAME.findall(line):
                if Path(name).name not in names:
                    yield f"{path}:{number}: there is no page {name}"


def decisions():
    numbers = re.findall(r"^### (\S+)", Path("docs/decisions.md").read_text(encoding="utf-8"), re.M)
    for number in numbers:
        if not re.fullmatch(r"\d{4}", number):
            yield f"docs/decisions.md: '### {number}' has no number of four digits"
        elif numbers.count(number) > 1:
            yield f"docs/decisions.md: two decisions have the number {number}"


def missing_decisions(files):
    numbers = set(re.findall(r"^### (\d{4})", Path("docs/decisions.md").read_text(encoding="utf-8"), re.M))
    for path in files:
        for number, line in enumerate(path.read_text(encoding="utf-8", errors="replace").splitlines(), 1):
            for name in DECISION.findall(line):
                if f"{int(name):04}" not in numbers:
                    yield f"{path}:{number}: docs/decisions.md has no decision {name}"


def missing_sources(pages):
    """`kernels/scale_ladder`, and with lib/ or an ending: a file or folder of the library."""
    rooms = "|".join(sorted(path.name for path in Path("lib").iterdir() if path.is_dir()))
    named = re.compile(rf"`(?:lib/)?((?:{rooms})/[\w/]+(?:\.\w+)?)`")
    for page in pages:
        for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
            for name in named.findall(line):
                if not any(Path("lib").glob(name.rstrip("/"))) and not any(Path("lib").glob(name.rstrip("/") + ".*")):
                    yield f"{page}:{number}: there is no lib/{name}"


def check(files):
    pages = [path for path in files if path.suffix == ".md"]
    code = [path for path in files if path.suffix in {".h", ".cpp", ".py", ".sh", ".md", ".cmake"}
            and "golden" not in path.parts and "lint_rules" not in path.parts]
    yield from dead_links(pages)
    yield from unreached(pages)
    yield from missing_names(code, pages)
    yield from missing_sources(pages)
    yield from decisions()
    yield from missing_decisions([*code, *(path for path in files if path.suffix in {".txt", ".toml", ".in"})])
