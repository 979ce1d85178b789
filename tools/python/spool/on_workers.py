"""`spool evaluate PLAN --executor KIND:WHERE` calls this: python3 -m spool.on_workers PLAN FOLDER KIND:WHERE [force] [exact].

Makes what is missing in FOLDER; the program then makes the results of it. Exit codes are the program's.
"""
from __future__ import annotations

import concurrent.futures
import contextlib
import importlib
import multiprocessing
import os
import sys

from .error import SpoolError
from .evaluation import _text_of
from .executors import Plan, spread

KINDS = "processes:N, dask:ADDRESS, mpi"
_CONNECTING = 20  # seconds


@contextlib.contextmanager
def executor_of(text: str):
    """The executor that a text names -> concurrent.futures.Executor; SpoolError where there is none."""
    kind, _, where = text.partition(":")
    if kind == "processes" and where.isdecimal() and 1 <= int(where) <= 4096:
        spawn = multiprocessing.get_context("spawn")  # threads of the library do not survive a fork
        with concurrent.futures.ProcessPoolExecutor(int(where), mp_context=spawn) as executor:
            yield executor
    elif kind == "dask" and where:
        distributed = _package("distributed", "dask distributed")
        try:
            client = distributed.Client(where, timeout=_CONNECTING)
        except (OSError, ValueError) as reason:  # TimeoutError is an OSError
            raise SpoolError("io", f"--executor {text}: no Dask scheduler there ({reason}): dask scheduler starts one") from reason
        with client:
            yield client.get_executor()
    elif text == "mpi":
        with _package("mpi4py.futures", "mpi4py").MPIPoolExecutor() as executor:
            yield executor
    else:
        raise SpoolError("usage", f"--executor {text}: write one of {KINDS}")


def _package(name, distribution):
    try:
        return importlib.import_module(name)
    except ImportError:
        raise SpoolError("missing_package", f"{name} is not there: {sys.executable} -m pip install {distribution}") from None


def _progress(share, done, of):
    if sys.stderr.isatty():
        print(f"\revaluate: {100 * share:3.0f} %, {done} of {of} results", end="\n" if done == of else "", file=sys.stderr, flush=True)


def main(plan: str, folder: str, executor: str, *switches: str) -> int:
    try:
        written, name, beside = _text_of(plan, None)
        with executor_of(executor) as made:
            spread(made, Plan(written, name, beside, "exact" in switches), os.path.abspath(folder), "force" in switches,
                   _progress, merge=False)
    except SpoolError as failure:
        print(f"spool: {failure}", file=sys.stderr)
        return failure.code
    except KeyboardInterrupt:
        print(f"spool: interrupted; results that arrived are kept in {folder}: the same command goes on from there", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
