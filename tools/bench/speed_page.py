"""Sections of docs/speed.md that a command writes: each stands between two marker comments, so that
every measurement can be repeated without touching what people wrote around it."""

from pathlib import Path

PAGE = Path(__file__).resolve().parents[2] / "docs" / "speed.md"


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
