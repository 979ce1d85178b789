"""What `spool evaluate PLAN --executor KIND:WHERE` calls: an executor by its name, and a plan on its workers."""
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
_CONNECTING = 10  # seconds


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


def run(plan: str, folder: str, executor: str, *switches: str) -> None:
    """Makes what is missing of the file `plan` in `folder`. `switches`: force, exact (timing), quiet."""
    written, name, beside = _text_of(plan, None)
    with executor_of(executor) as made:
        spread(made, Plan(written, name, beside, "exact" in switches), os.path.abspath(folder), "force" in switches,
               None if "quiet" in switches else _progress, merge=False)
