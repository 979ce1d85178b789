"""Methods compared: `spool evaluate` in this process."""
from __future__ import annotations

import concurrent.futures
import functools
import hashlib
import itertools
import json
import os
import pickle
import uuid
import warnings
from collections.abc import Callable

import numpy as np

from . import _core
from .arguments import absolute, flag, path, text, wrong
from .cells import results_html
from .error import SpoolError, open_regular
from .executors import Plan, spread
from .own_methods import Method, method_text
from .plan_text import plan_text
from .recordings import Dump, Recording, recording_of
from .save import write
from .scratch import scratch_folder


def evaluate(plan: dict | str | os.PathLike, *, output: str | os.PathLike | None = None, force: bool = False,
             exact_timing: bool = False, executor: concurrent.futures.Executor | None = None,
             progress: Callable[[float, int, int], object] | None = None) -> Results:
    """Answers a plan -> Results.

    `plan`: the path of a TOML file, or a dict of the same keys, in which "recordings" may be Dumps, Recordings and
    arrays, and "samplers" and "filters" functions made by @spool.sampler and @spool.filter. `output`: the folder of
    the results, which the same call continues; without it they go with the Results, and no images are kept of a dict.
    Where some fail, the SpoolError has the Results of all as `results`.
    `executor`: any concurrent.futures.Executor, whose workers find the recordings under the same paths, and functions by
    name in their modules: each task is a sampling run on one thread, the most expensive first; the same bits.
    `progress(share, done, of)` is called a few times a second, with an executor after each task.
    """
    if progress is not None and not callable(progress):
        raise wrong("progress", progress, "no function of (share, done, of)")
    kept = None if output is None else absolute(text("output", path("output", output)))
    own = () if executor is None else _own_methods(executor, plan)
    switches = flag("force", force), flag("exact_timing", exact_timing)
    if kept and isinstance(plan, (str, os.PathLike)) and not os.path.isdir(os.path.join(kept, "cells")):
        own_plan = os.path.join(kept, "plan.toml")  # beside cells it is one that an evaluation kept
        if os.path.exists(own_plan) and os.path.exists(plan) and os.path.samefile(own_plan, plan):
            raise SpoolError("usage", f"{own_plan}: output is the input: choose another folder")
    with scratch_folder() as scratch:
        folder = None if kept else scratch_folder()
        place = kept or os.path.join(folder.name, "results")
        if isinstance(plan, dict) and not kept:
            plan = {"pictures": False, **plan}  # they would not be looked at
        written, name, beside = _text_of(plan, scratch)
        earlier = _versions(place)
        try:
            if executor is None:
                _core.evaluate(written, name, beside, place, *switches, None, False, 0, progress)
            else:
                spread(executor, Plan(written, name, beside, switches[1], own), place, switches[0], progress)
        except SpoolError as reason:
            # Results that this call wrote are kept, whatever the rest of the plan did.
            if all(version and version != before for version, before in zip(_versions(place), earlier)):
                reason.results = Results(place, folder)
            raise
    return Results(place, folder)


def results(folder: str | os.PathLike) -> Results:
    """What `spool evaluate -o FOLDER` wrote, or evaluate(output=FOLDER)."""
    return Results(absolute(path("folder", folder)))


class Results:
    """rows: a dict for each recording, sampler, filter, budget and replicate; statistics: means, intervals, verdicts."""

    def __init__(self, folder, temporary=None):
        self.folder = folder
        for name in _FILES:  # read when they are asked for, but missed at once
            if not os.path.isfile(os.path.join(folder, name)):
                raise SpoolError("io", f"{folder}: no {name} in it: evaluate it first")
        self._temporary = temporary  # goes with the last of those that read it

    def __getstate__(self):
        """What was read goes along; a temporary folder stays behind."""
        if self._temporary:
            self.rows, self.statistics  # noqa: B018 - read now
        return {**self.__dict__, "_temporary": None}

    @functools.cached_property
    def rows(self) -> list[dict]:
        """A dict for each result, as results.jsonl has them."""
        return [_parsed(self.folder, _FILES[0], line) for line in _read(self.folder, _FILES[0]).split("\n") if line]

    @functools.cached_property
    def statistics(self) -> dict:
        """What statistics.json has."""
        return _parsed(self.folder, _FILES[1], _read(self.folder, _FILES[1]))

    def __repr__(self):
        return f"<spool.Results: {len(self.rows)} rows, {len(self.means)} means>"

    def _repr_html_(self):
        try:
            return results_html(self.rows, self.statistics)
        except (LookupError, TypeError, AttributeError, ValueError) as reason:
            raise SpoolError("data", f"{os.path.join(self.folder, _FILES[1])}: lacks what is shown of it ({reason!r}): evaluate it again") from reason

    @property
    def means(self) -> list[dict]:
        """A dict for each recording or group, sampler, filter and budget: mean, interval and verdict of each metric."""
        return self._list("results")

    @property
    def claims(self) -> list[dict]:
        """The questions of the plan, each with its verdict and the places where it was asked."""
        return self._list("claims")

    def _list(self, key):
        if not isinstance(found := self.statistics.get(key), list):
            raise SpoolError("data", f"{os.path.join(self.folder, _FILES[1])}: has no {key}: evaluate it again")
        return found

    def to_pandas(self):  # -> pandas.DataFrame, where pandas is there
        """The rows as a pandas.DataFrame."""
        try:
            import pandas
        except ImportError:
            raise SpoolError("missing_package", "to_pandas() needs pandas: pip install pandas") from None
        return pandas.DataFrame(self.rows)


_FILES = ("results.jsonl", "statistics.json")
_LARGEST_PLAN = 16 << 20  # as the program's


def _versions(folder):
    """What differs once a file was written anew; None where there is none."""
    found = []
    for file in (os.path.join(folder, name) for name in _FILES):
        state = os.stat(file) if os.path.isfile(file) else None
        found.append(state and (state.st_ino, state.st_mtime_ns, state.st_size))
    return found


def _text_of(plan, scratch):
    """TOML, its name in errors, and the folder that its paths are relative to."""
    if not isinstance(plan, dict):
        if not isinstance(plan, (str, os.PathLike)):
            raise wrong("plan", plan, "neither a dict of a plan's keys nor the path of a TOML file")
        place = path("plan", plan)
        try:
            with open_regular(place, "r", encoding="utf-8") as file:
                written = file.read(_LARGEST_PLAN + 1)
        except (OSError, ValueError) as reason:
            raise SpoolError("io", f"{place}: {getattr(reason, 'strerror', None) or reason}: give a dict, or the path of a "
                             "TOML file") from reason
        if len(written) > _LARGEST_PLAN:
            raise SpoolError("usage", f"{place}: is longer than {_LARGEST_PLAN} characters: it is no plan")
        return written, place, os.path.dirname(absolute(place))
    return plan_text(plan, lambda item: _path_of(item, scratch)), "plan", absolute(".")


def _path_of(item, scratch):
    """Arrays are written to a file, which goes when the results are there."""
    if isinstance(item, (str, os.PathLike)):
        return absolute(text("recordings", path("recordings", item)))
    if isinstance(item, Dump):
        return text("recordings", item.source.path())
    held = recording_of(item)
    assert isinstance(held, Recording)
    name = held.source.name
    taken = set(os.listdir(scratch))  # two of one name: NAME, NAME_2
    free = next(one for one in itertools.chain([name], (f"{name}_{i}" for i in itertools.count(2))) if f"{one}.spool" not in taken)
    place = os.path.join(scratch, f"{free}.spool")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # what is said of arrays is said when they become a recording
        write(place, sample_order=held.sample_order, uuid=_uuid_of(held), **held.arrays)
    return place


def _uuid_of(held):
    """Of its values: the same call goes on with the results of the last one."""
    digest = hashlib.sha256(held.sample_order.encode())
    for name, values in held.arrays.items():
        digest.update(f"{name} {values.shape}".encode())
        digest.update(np.moveaxis(values, 3, 0) if values.ndim == 4 else values)  # as it lies in memory
    return uuid.UUID(bytes=digest.digest()[:16])


def _own_methods(executor, plan):
    """(a Method as workers find it, its name in the plan)."""
    if not isinstance(executor, concurrent.futures.Executor):
        raise wrong("executor", executor, "no concurrent.futures.Executor")
    own = []
    for method in (method for method in _functions_of(plan) if isinstance(method, Method)):
        try:
            own.append((pickle.dumps(method), method_text(method.kind, method)))
        except (pickle.PicklingError, AttributeError):
            raise SpoolError("usage", f"executor: {method!r} is not found by its name in its module, from which workers import it: "
                                      "decorate it at the top of a module, or leave executor out") from None
    return own


def _functions_of(plan):
    given = [plan.get(key, ()) for key in ("samplers", "filters")] if isinstance(plan, dict) else []
    named = [entry for entries in given for entry in (entries if isinstance(entries, (list, tuple)) else [entries])]
    return [entry.get("name") if isinstance(entry, dict) else entry for entry in named]


def _parsed(folder, name, written):
    try:
        parsed = json.loads(written)
    except ValueError as reason:
        raise SpoolError("data", f"{os.path.join(folder, name)}: is no JSON ({reason}): evaluate it again") from reason
    if not isinstance(parsed, dict):
        raise SpoolError("data", f"{os.path.join(folder, name)}: holds no objects: evaluate it again")
    return parsed


def _read(folder, name):
    try:
        with open_regular(os.path.join(folder, name), "r", encoding="utf-8") as file:
            return file.read()
    except (OSError, UnicodeDecodeError) as reason:
        raise SpoolError("io", f"{folder}: {name}: {getattr(reason, 'strerror', None) or reason}") from reason
