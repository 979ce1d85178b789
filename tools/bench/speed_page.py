"""Sections of docs/speed.md that a command writes: each stands between two marker comments, so that
every measurement can be repeated without touching what people wrote around it."""

import argparse
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "speed.md"


def parser_of(about, pages="docs/speed.md"):
    """Of a command that publishes a section: the folder of the build, and --print."""
    parser = argparse.ArgumentParser(description=about, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=Path)
    parser.add_argument("--print", action="store_true", help=f"leave {pages} alone")
    return parser


def publish(name, text, options, page=PAGE):
    print(text)
    if not options.print:
        replace_section(name, text, page)


def turns_text(turns):
    return f"{turns} turn{'s' if turns > 1 else ''}"


def replace_section(name, markdown, page=PAGE):
    """Puts `markdown` between <!-- NAME --> and <!-- end NAME -->; appends the section if it is not there yet."""
    begin, end = f"<!-- {name} -->", f"<!-- end {name} -->"
    text = page.read_text(encoding="utf-8") if page.exists() else "# Speed\n"
    section = f"{begin}\n{markdown.strip()}\n{end}"
    before, found, rest = text.partition(begin)
    if found:
        inside, closed, after = rest.partition(end)
        if not closed:
            raise ValueError(f"{page}: '{begin}' is never closed: add '{end}'")
        text = before + section + after
    else:
        text = text.rstrip("\n") + "\n\n" + section + "\n"
    page.write_text(text, encoding="utf-8")
