"""Reads results.csv of `spool evaluate`: one row per recording, sampler, filter, budget, replicate.

A metric is any column NAME that has a column NAME_se beside it, so that new metrics appear in the
report without a change here.
"""

import csv
import math
import re
from typing import NamedTuple

from tools.report.failure import USAGE, Failure, open_regular
from tools.report.number_text import count_text

COUNTED = {"spp": 1e-9, "replicate": 0.0, "threads": 0.0}  # of the key: numbers, and the least they may be
KEY = ("dump", "sampler", "filter", "spp", "replicate", "threads")
TEXT = {"dump", "dump_path", "sampler", "filter", "timing", "reference", "energy_masks", "guards", "error"}
FORMULA = re.compile(r"^'([=+\-@'\t\r])")  # to_csv_row of lib/experiment puts the ' before
csv.field_size_limit(1 << 24)


class ResultsTable(NamedTuple):
    rows: list  # of {column: text or float; NaN where the field is empty}
    metrics: list  # names, in the order of the file


def read_results(path):
    try:
        with open_regular(path, newline="", errors="replace") as file:
            return _read(path, csv.reader(file, strict=True))
    except OSError as error:
        hint = "run spool evaluate ... -o DIR first"
        if path.with_name(path.name + ".partial").exists():
            hint = "the evaluation has not finished"
        raise Failure(f"{path}: {error.strerror}: {hint}", 3) from error
    except csv.Error as error:
        raise Failure(f"{path}: {error}: not a table that spool evaluate wrote") from error


def _read(path, reader):
    header = next(reader, None)
    missing = [name for name in KEY if name not in (header or [])]
    if missing:
        raise Failure(f"{path}: no column {missing[0]}: not a table that spool evaluate wrote")
    if len(set(header)) != len(header):
        raise Failure(f"{path}: a column occurs twice: not a table that spool evaluate wrote")
    rows, seen = [], set()
    for fields in reader:
        if len(fields) != len(header):
            raise Failure(f"{path}: line {reader.line_num} has {len(fields)} fields, not "
                          f"{len(header)}: run spool evaluate again")
        row = {name: FORMULA.sub(r"\1", field) if name in TEXT else _number(path, reader.line_num, name, field)
               for name, field in zip(header, fields)}
        row["dump"] = row.get("dump_path", row["dump"])  # as statistics.json names it
        key = tuple(row[name] for name in KEY)
        if key in seen:
            raise Failure(f"{path}: line {reader.line_num} repeats an earlier result: keep one")
        seen.add(key)
        rows.append(row)
    if not rows:
        raise Failure(f"{path}: no results in it: run spool evaluate again")
    _name_threads(rows)
    return ResultsTable(rows, [name for name in header if name + "_se" in header])


def choose_metric(wanted, table):
    if wanted and wanted not in table.metrics:
        raise Failure(f"--metric: no {wanted} in results.csv, which has {', '.join(table.metrics)}",
                      USAGE)
    if not table.metrics:
        raise Failure("results.csv has no metric: not a table that spool evaluate wrote")
    return wanted or ("relmse" if "relmse" in table.metrics else table.metrics[0])


def _name_threads(rows):
    """Where numbers of threads are swept over, they are part of the sampler's name."""
    if len({row["threads"] for row in rows}) > 1:
        for row in rows:
            row["sampler"] += bracketed_threads(row["threads"])


def bracketed_threads(threads):
    """What follows the name of a method that ran with several numbers of threads."""
    return f" [{count_text(int(threads), 'thread')}]"


def without_threads(sampler):
    return re.sub(r" \[\d+ threads?\]$", "", sampler)


def _number(path, line, name, field):
    try:
        value = float(field) if field else math.nan
    except ValueError:
        value = None
    if value is None or (name in COUNTED and not COUNTED[name] <= value < math.inf):
        raise Failure(f"{path}: line {line}, column {name}: '{field[:40]}' is no number that belongs there: "
                      "run spool evaluate again")
    return value
