"""Means and comparisons of series of replicates, computed by the program series_statistics; none in Python.

It lies beside spool: use_program() says where. The same functions of lib/inference that write statistics.json.
"""
import json
import subprocess
import sys
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[1] / "report"))
from statistics_file import NAN, Interval, interval_of  # noqa: E402, F401

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
    return Interval(*_numbers(values, positive, "mean", "low", "high"))


def mean_and_error(values):
    """Arithmetic, and its standard error."""
    return _numbers(values, False, "mean", "standard_error")


def _numbers(values, positive, *wanted):
    found = _ask({"a": list(values), "positive": positive}) if values else {}
    return tuple(NAN if found.get(k) is None else found[k] for k in wanted)


def ratio_of(a, b):
    """a / b, replicate by replicate."""
    return interval_of(_ask({"a": list(a), "b": list(b)})["ratio"]) if a and len(a) == len(b) else Interval()


ORDER = {"better": -1, "worse": 1, "undecided": 0, "identical": 0, "not compared": None}


def order_of(a, b):
    """-1 where a is below b, 1 above, 0 not told apart, None not known; this comparison alone."""
    return ORDER[_ask({"a": list(a), "b": list(b)})["verdict"]] if len(a) > 1 and len(a) == len(b) else None


def judged_together(ratios, freedom):
    """Orders (as order_of) of ratios with their 95 % intervals, as one family at 5 % (Holm); freedom: of each."""
    asked = {"ratios": [[r.mean, r.low, r.high] for r in ratios], "freedom": list(freedom)}
    return [ORDER[verdict] for verdict in _ask(asked)["verdicts"]] if ratios else []
