"""Takes the tables of a generated page apart: figures go to CSV files and plots, verdicts stay on the page.

A table is a block of markdown rows; the paragraph before it says what it shows and becomes the column `of`. Tables of one
chapter with the same header share a file. A cell "0.12 [0.10, 0.15]" becomes three columns: "...", "... low", "... high".
"""
import csv
import io
import os
import re
from dataclasses import dataclass, field

from whole_file import write_whole

# A table of that many rows or fewer can be read where it stands.
SHORT = 8
CURVES = ("| at samples per pixel |", "| with threads |")  # tables that are drawn, however short
STATEMENTS = ("| statement |", "| one option |", "| target on |")  # a table of verdicts stays on the page however long it is
INTERVAL = re.compile(r"(.*?) \[([^,\]]+), ([^\]]+)\]$")


@dataclass
class Table:
    caption: str  # the paragraph before it, without its colon
    header: list
    rows: list = field(default_factory=list)


def cells(line):
    return [cell.strip() for cell in re.split(r"(?<!\\)\|", line.strip().strip("|"))]


def plain(text):
    return re.sub(r"[*`]", "", text).replace("\\|", "|")


def parse(block, caption):
    lines = block.split("\n")
    return Table(caption, cells(lines[0]), [cells(line) for line in lines[2:]])


def is_table(block):
    return block.startswith("|") and all(line.startswith("|") for line in block.split("\n"))


def is_caption(block):
    return not block.startswith(("#", "|", "-", "    ")) and block.endswith(":") and "\n" not in block


def with_ends_apart(table):
    """(header, rows) in which the ends of an interval have columns of their own."""
    split = [any(INTERVAL.match(plain(row[i])) for row in table.rows if i < len(row)) for i in range(len(table.header))]
    header, rows = [], []
    for name, three in zip(table.header, split):
        header += [plain(name) + end for end in ("", " low", " high")] if three else [plain(name)]
    for row in table.rows:
        values = []
        for cell, three in zip(row, split):
            found = INTERVAL.match(plain(cell))
            values += ([*found.groups()] if found else [plain(cell), "", ""]) if three else [plain(cell)]
        rows.append(values)
    return header, rows


def chapter_name(heading):
    """E3 of "## E3: Figure 8b"; else the heading's words."""
    text = heading.lstrip("# ")
    name = text.split(":")[0] if re.match(r"[EA]\d+:", text) else text
    return re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_")


def write_csv(path, tables):
    header, _ = with_ends_apart(tables[0])
    # Intervals may be missing in one table and present in the next: all columns that any of them has.
    for table in tables[1:]:
        header += [name for name in with_ends_apart(table)[0] if name not in header]
    text = io.StringIO(newline="")
    writer = csv.DictWriter(text, ["of", *header], lineterminator="\n")
    writer.writeheader()
    for table in tables:
        names, rows = with_ends_apart(table)
        for row in rows:
            writer.writerow({"of": table.caption, **dict(zip(names, row))})
    write_whole(path, text.getvalue())


def groups_of(tables):
    """Tables by header, in the order of the page."""
    groups = {}
    for table in tables:
        groups.setdefault(tuple(map(plain, table.header)), []).append(table)
    return list(groups.values())


class Chapter:
    def __init__(self, heading, page):
        self.heading, self.name = heading, chapter_name(heading or page)
        self.blocks, self.tables, self.place = [], [], None
        self.files = []  # names of those written

    def take(self, block):
        """Keeps prose and short tables; long tables leave their place to the links."""
        short = block.count("\n") - 1 <= SHORT and not block.startswith(CURVES)
        if not is_table(block) or short or block.startswith(STATEMENTS):
            self.blocks.append(block)
            return
        caption = ""
        if self.blocks and is_caption(self.blocks[-1]):
            caption = self.blocks.pop().rstrip(":")
        self.tables.append(parse(block, caption))
        if self.place is None:
            self.place = len(self.blocks)

    def written(self, folder, plot):
        """The chapter's blocks, its CSV files and plots written into `folder`."""
        blocks = list(self.blocks)
        if self.tables:
            files, link = [], f"{folder.parent.name}/{folder.name}"
            for i, group in enumerate(groups_of(self.tables)):
                path = folder / f"{self.name}{f'_{i + 1}' if i else ''}.csv"
                write_csv(path, group)
                self.files.append(path.name)
                files.append(f"[{path.name}]({link}/{path.name})")
                drawn = plotted(plot, path.with_suffix(".svg"), group) if plot else None
                if drawn:
                    self.files.append(f"{path.stem}.svg")
                    blocks.insert(self.place, f"![{self.name}: {drawn}]({link}/{path.stem}.svg)")
                    self.place += 1
            blocks.insert(self.place, "Figures: " + ", ".join(files) + ".")
        return [self.heading, *blocks] if self.heading else blocks


def plotted(plot, path, tables):
    """What was drawn; the file appears whole, whoever else writes the page."""
    partial = path.with_name(f".{path.stem}.{os.getpid()}.svg")
    try:
        drawn = plot(partial, tables)
        if drawn:
            os.replace(partial, path)
    finally:
        partial.unlink(missing_ok=True)
    return drawn


def take_apart(text, page, folder, plot=None):
    """The page without its long tables. `plot(path, tables)` may draw a group: what it drew in words, or None."""
    folder = folder / page
    folder.mkdir(parents=True, exist_ok=True)
    chapters = [Chapter(None, page)]
    for block in text.strip("\n").split("\n\n"):
        if block.startswith(("## ", "### ")):
            chapters.append(Chapter(block, page))
        else:
            chapters[-1].take(block)
    blocks = [block for chapter in chapters for block in chapter.written(folder, plot)]
    kept = {name for chapter in chapters for name in chapter.files}
    for old in [*folder.glob("[!.]*.csv"), *folder.glob("[!.]*.svg")]:
        if old.name not in kept:
            old.unlink(missing_ok=True)
    return "\n\n".join(block for block in blocks if block) + "\n"
