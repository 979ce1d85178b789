"""A plan on the workers of a concurrent.futures.Executor: a process pool, Dask, MPI or Ray."""
from __future__ import annotations

import collections
import concurrent.futures
import contextlib
import os
import pickle
import secrets
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

from . import _core
from .error import SpoolError
from .own_methods import method_text
from .scratch import scratch_folder

_SHORT = 2.0        # expected CPU seconds: shorter runs of one recording make one task
_UNDER_WAY = 1000   # tasks that wait in the executor; the others wait here
_MAIN_FILES = (".json", ".jsonl", ".toml", ".csv")  # at the top of a folder of results: not a worker's to write


class Plan(NamedTuple):
    """What a worker needs beside the recordings, which it finds under the same paths."""
    text: str
    name: str     # in errors
    beside: str   # the folder that paths of the text are relative to
    exact_timing: bool
    own: Sequence[tuple[bytes, str]] = ()  # functions, pickled, with their names in the text


def spread(executor: concurrent.futures.Executor, plan: Plan, place: str, force: bool,
           progress: Callable[[float, int, int], object] | None, merge: bool = True) -> None:
    """Makes what is missing in the folder `place`, then (`merge`) its results.

    A result is kept when it arrives; what was lost with a worker is named in the SpoolError, and the same call makes it.
    """
    _run(plan, place, force=force, only=[])  # the folder, its recordings and claims
    tasks, done, threads = _core.tasks(*plan[:3], place)
    left = collections.deque(_together(tasks))
    of, lost = done + sum(len(ids) for _, ids in left), []
    identity = {name: _read(os.path.join(place, name)) for name in ("dumps.json", "inputs.json") if name in os.listdir(place)}
    lines = os.path.join(place, "cells", f"{secrets.token_hex(8)}.jsonl")
    running: dict[concurrent.futures.Future, int] = {}
    try:
        while left or running:
            while left and len(running) < _UNDER_WAY:
                ids = left.popleft()[1]
                try:
                    running[executor.submit(_do, plan, identity, ids, threads or 1)] = len(ids)
                except RuntimeError as reason:  # the executor has ended: a lost worker of a process pool ends it
                    lost.append((len(ids) + sum(len(rest) for _, rest in left), reason))
                    left.clear()
            ended, _ = concurrent.futures.wait(running, return_when=concurrent.futures.FIRST_COMPLETED)
            for future in ended:
                count = running.pop(future)
                try:
                    files = future.result()
                except SpoolError:
                    raise
                except Exception as reason:  # of the executor: each has errors of its own for a worker that ended
                    lost.append((count, reason))
                    continue
                _keep(place, files, lines)
                done += count
                if progress is not None:
                    progress(done / of, done, of)
    finally:
        for future in running:
            future.cancel()
    if lost:
        reason = str(lost[0][1]) or type(lost[0][1]).__name__
        raise SpoolError("data", f"{place}: {sum(count for count, _ in lost)} of {of} results were lost with their "
                         f"workers ({reason}): the same call goes on from what is kept") from lost[0][1]
    if merge:
        _run(plan, place, merge=True)


def _run(plan, place, *, force=False, only=None, merge=False, threads=0):
    _core.evaluate(plan.text, plan.name, plan.beside, place, force, plan.exact_timing, only, merge, threads, None)


def _together(tasks) -> Iterator[tuple[float, list[str]]]:
    """Tasks as (cost, names of cells), the most expensive first."""
    bundles: list[tuple[float, list[str]]] = []
    open_of: dict[str, tuple[float, list[str]]] = {}
    for dump, ids, cost in tasks:
        before, names = open_of.pop(dump, (0.0, []))
        bundle = before + cost, names + ids
        if bundle[0] < _SHORT:
            open_of[dump] = bundle
        else:
            bundles.append(bundle)
    bundles.extend(open_of.values())
    return iter(sorted(bundles, key=lambda bundle: -bundle[0]))


def _do(plan: Plan, identity: dict[str, bytes], ids: list[str], threads: int) -> dict[str, bytes]:
    """In a worker: the files of these cells, by their paths in the folder of results.

    `identity`: dumps.json and inputs.json of that folder; a worker that finds other recordings or files raises.
    """
    for pickled, name in plan.own:
        try:
            method = pickle.loads(pickled)
            found = method_text(method.kind, method)
        except Exception as reason:  # noqa: BLE001 - whatever its module raises
            raise SpoolError("usage", f"{name}: a worker cannot import it ({reason}): put it into a module that workers find, too") from None
        if found != name:
            raise SpoolError("usage", f"{method!r} is another function in a worker: its module there has another text or other values")
    with scratch_folder() as scratch:
        place = os.path.join(scratch, "results")
        os.makedirs(os.path.join(place, "cells"))
        for name, data in identity.items():
            with open(os.path.join(place, name), "wb") as file:
                file.write(data)
        try:
            _run(plan, place, only=ids, threads=threads)
        except SpoolError:
            # Cells that failed are results, too; only what is not there is an error.
            made = b"".join(_read(path) for path in _files(place) if path.endswith(".jsonl"))
            if not all(f'"cell":"{name}"'.encode() in made for name in ids):
                raise
        return {os.path.relpath(path, place): _read(path) for path in _files(place)}


def _files(place):
    for folder, _, names in os.walk(place):
        for name in sorted(names):
            if folder != place or not name.endswith(_MAIN_FILES):
                yield os.path.join(folder, name)


def _keep(place, files, lines):
    """Pictures first: a cell counts as done when its line is in the file `lines`."""
    cells = b""
    for name, data in files.items():
        parts = name.split(os.sep)
        if os.path.isabs(name) or ".." in parts or len(parts) == 1 and name.endswith(_MAIN_FILES):
            raise SpoolError("data", f"{name}: a worker sent a file of this name, which is not one of a result")
        if parts[0] == "cells":
            cells += data
            continue
        path = os.path.join(place, name)
        part = f"{path}.spool-{secrets.token_hex(6)}.partial"
        try:
            os.makedirs(os.path.dirname(path), exist_ok=True)
            with open(part, "xb") as file:
                file.write(data)
            os.replace(part, path)
        except OSError as reason:
            with contextlib.suppress(OSError):
                os.unlink(part)
            raise SpoolError("io", f"{path}: {reason.strerror}") from reason
    try:
        with open(lines, "ab") as file:
            file.write(cells)
    except OSError as reason:
        raise SpoolError("io", f"{lines}: {reason.strerror}") from reason


def _read(path):
    try:
        with open(path, "rb") as file:
            return file.read()
    except OSError as reason:
        raise SpoolError("io", f"{path}: {reason.strerror}") from reason
