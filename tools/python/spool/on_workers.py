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
    """The executor that a text names -> concurrent.futures.Executor; SpoolError where there is none.

    None in processes of MPI but the first, when there is nothing left to do: they were its workers.
    """
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
        # Of processes that are there: spawning more is not possible everywhere, and hangs where it fails.
        futures = _package("mpi4py.futures", "mpi4py")
        processes = _package("mpi4py.MPI", "mpi4py").COMM_WORLD
        if processes.Get_size() < 2:
            raise SpoolError("usage", "--executor mpi: no workers: mpiexec -n N spool evaluate ... starts N - 1 of them")
        with futures.MPICommExecutor(processes, root=0) as executor:
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


def run(plan: str, folder: str, executor: str, *switches: str) -> bool:
    """Makes what is missing of the file `plan` in `folder`; False in a worker of the process that does so.

    `switches`: force, exact (timing), quiet.
    """
    SpoolError.options = ()  # the program prints the line
    written, name, beside = _text_of(plan, None)
    with executor_of(executor) as made:
        if made is None:
            return False
        spread(made, Plan(written, name, beside, "exact" in switches), os.path.abspath(folder), "force" in switches,
               None if "quiet" in switches else _progress, merge=False)
        return True
