"""Two folders of `spool evaluate` hold the same results, bit for bit, apart from times."""
import csv

from tools.study.kept import cells_in, cells_text

TIMES = {"efficiency", "peak_memory_mb", "threads_used", "timing"}


def rows_of(folder):
    with open(folder / "results.csv", newline="") as file:
        return list(csv.DictReader(file))


def cell_lines(folder):
    """The lines of its finished cells, whole ones."""
    found = [line for file in sorted(folder.glob("cells/*.jsonl")) for line in file.read_text().splitlines(keepends=True)]
    return [line for line in found if line.endswith("\n")]


def changed_cells(folder, change):
    """What `change` makes of each cell, in place of the folder's."""
    cells = cells_in("".join(cell_lines(folder)))
    for file in folder.glob("cells/*.jsonl"):
        file.unlink()
    (folder / "cells" / "changed.jsonl").write_text(cells_text({name: change(cell) for name, cell in cells.items()}))


def is_timing(name):
    return name in TIMES or name.startswith("cpu_") or (
        name.startswith("seconds_") and name != "seconds_per_sample")


def assert_same_results(a, b, apart=(), images=False):
    rows, others = rows_of(a), rows_of(b)
    assert len(rows) == len(others) > 0
    for row, other in zip(rows, others):
        assert list(row) == list(other)
        for name, value in row.items():
            if not is_timing(name) and name not in apart:
                assert value == other[name], (name, row["dump"], row["sampler"], row["filter"])
    if images:
        names = sorted(p.relative_to(a) for p in a.rglob("*.exr"))
        assert names and names == sorted(p.relative_to(b) for p in b.rglob("*.exr"))
        for name in names:
            assert (a / name).read_bytes() == (b / name).read_bytes(), name
