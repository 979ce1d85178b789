"""Means and comparisons of series of replicates, computed by the program series_statistics; none in Python.

It lies beside spool: use_program() says where. The same functions of lib/inference that write statistics.json.
"""
import json
import math
import subprocess
from pathlib import Path
from typing import NamedTuple

NAN = math.nan


class Interval(NamedTuple):
    mean: float = NAN
    low: float = NAN
    high: float = NAN
    standard_error: float = NAN


def interval_of(numbers):
    """Of [mean, low, high], [mean] or nothing, as statistics.json has them."""
    numbers = [NAN if n is None else float(n) for n in numbers or []]
    return Interval(*numbers) if len(numbers) in (1, 3) else Interval()


_program = Path(__file__).resolve().parents[2] / "build/release/series_statistics"
_process = None


def use_program(spool):
    """The one beside this `spool`."""
    global _program
    _program = Path(spool).resolve().parent / "series_statistics"


def _ask(question):
    global _process
    if _process is None:
        _process = subprocess.Popen([_program], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    _process.stdin.write(json.dumps(question) + "\n")
    _process.stdin.flush()
    return json.loads(_process.stdout.readline())


def mean_of(values, positive=True):
    """Over replicates; geometric where all values are positive, unless told otherwise."""
    if not values:
        return Interval()
    found = _ask({"a": list(values), "positive": positive})
    return Interval(*(NAN if found[k] is None else found[k] for k in ("mean", "low", "high", "standard_error")))


def ratio_of(a, b):
    """a / b, replicate by replicate."""
    return interval_of(_ask({"a": list(a), "b": list(b)})["ratio"]) if a and len(a) == len(b) else Interval()


ORDER = {"better": -1, "worse": 1, "undecided": 0, "identical": 0, "not compared": None}


def order_of(a, b):
    """-1 where a is below b, 1 above, 0 not told apart, None not known; this comparison alone."""
    return ORDER[_ask({"a": list(a), "b": list(b)})["verdict"]] if len(a) > 1 and len(a) == len(b) else None
