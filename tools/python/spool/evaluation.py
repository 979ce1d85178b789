"""Methods compared: `spool evaluate` in this process."""
from __future__ import annotations

import json
import os
import tempfile
import weakref
from collections.abc import Callable

from . import _core
from .cells import results_html
from .error import SpoolError
from .own_methods import failure_shown
from .plan_text import plan_text
from .recordings import Dump, Recording, recording_of
from .save import write


def evaluate(plan: dict | str | os.PathLike, *, output: str | os.PathLike | None = None, force: bool = False,
             exact_timing: bool = False, progress: Callable[[float, int, int], object] | None = None) -> Results:
    """Answers a plan -> Results.

    `plan`: the path of a TOML file, or a dict of the same keys, in which "recordings" may be Dumps, Recordings and
    arrays, and "samplers" and "filters" functions made by @spool.sampler and @spool.filter. `output`: the folder of
    the results, which the same call continues; without it they go with the Results, and no pictures are made of a dict.
    `progress(share, done, of)` is
    called a few times a second.
    """
    with tempfile.TemporaryDirectory(prefix="spool-") as scratch:
        folder = None if output else tempfile.TemporaryDirectory(prefix="spool-")
        place = os.path.abspath(output) if output else os.path.join(folder.name, "results")
        if isinstance(plan, dict) and not output:
            plan = {"pictures": False, **plan}  # nobody would see them
        text, name, beside = _text_of(plan, scratch)
        # Results that are there are kept, whatever the rest of the plan did.
        with failure_shown(*_functions_of(plan)):
            _core.evaluate(text, name, beside, place, force, exact_timing, progress)
    return Results(place, folder)


def results(folder: str | os.PathLike) -> Results:
    """What `spool evaluate -o FOLDER` wrote, or evaluate(output=FOLDER)."""
    return Results(os.path.abspath(folder))


class Results:
    """rows: a dict for each recording, sampler, filter, budget and replicate; statistics: means, intervals, verdicts."""

    def __init__(self, folder, temporary=None):
        self.folder = folder
        self.rows = [json.loads(line) for line in _read(folder, "results.jsonl").splitlines()]
        self.statistics = json.loads(_read(folder, "statistics.json"))
        if temporary:
            weakref.finalize(self, temporary.cleanup)

    def __repr__(self):
        return f"<spool.Results: {len(self.rows)} rows, {len(self.means)} means>"

    def _repr_html_(self):
        return results_html(self.rows, self.statistics)

    @property
    def means(self) -> list[dict]:
        """A dict for each recording or group, sampler, filter and budget: mean, interval and verdict of each metric."""
        return self.statistics["results"]

    @property
    def claims(self) -> list[dict]:
        """The questions of the plan, each with its verdict and the places where it was asked."""
        return self.statistics["claims"]

    def to_pandas(self):  # -> pandas.DataFrame, where pandas is there
        """The rows as a pandas.DataFrame."""
        try:
            import pandas
        except ImportError:
            raise SpoolError("missing_package", "to_pandas() needs pandas: pip install pandas") from None
        return pandas.DataFrame(self.rows)


def _text_of(plan, scratch):
    """TOML, its name in errors, and the folder that its paths are relative to."""
    if not isinstance(plan, dict):
        path = os.fspath(plan)
        try:
            with open(path, encoding="utf-8") as file:
                return file.read(), path, os.path.dirname(os.path.abspath(path))
        except (OSError, UnicodeDecodeError) as reason:
            raise SpoolError("io", f"{path}: {getattr(reason, 'strerror', None) or reason}") from reason
    return plan_text(plan, lambda item: _path_of(item, scratch)), "plan", os.getcwd()


def _path_of(item, scratch):
    """Arrays are written to a file, which goes when the results are there."""
    if isinstance(item, (str, os.PathLike)):
        return os.path.abspath(item)
    if isinstance(item, Dump):
        return os.path.abspath(item.path)
    held = recording_of(item)
    assert isinstance(held, Recording)
    path = os.path.join(scratch, f"{held.source.name}.spool")
    write(path, sample_order=held.sample_order, **held.arrays)
    return path


def _functions_of(plan):
    named = [*plan.get("samplers", ()), *plan.get("filters", ())] if isinstance(plan, dict) else []
    return [entry["name"] if isinstance(entry, dict) else entry for entry in named]


def _read(folder, name):
    try:
        with open(os.path.join(folder, name), encoding="utf-8") as file:
            return file.read()
    except OSError as reason:
        raise SpoolError("io", f"{folder}: no {name} in it ({reason.strerror}): evaluate it first") from reason
