"""evaluate(executor=...): the same bits on workers of others, whatever is lost on the way."""
import concurrent.futures
import contextlib
import importlib.util
import multiprocessing
import os
import shutil
import signal
import subprocess
import sys
import threading
import time
import types
from pathlib import Path

import distributed
import pytest

import spool
from conftest import LONGEST_RUN, PROGRAM
from spool import executors

TIMES = ("seconds", "cpu", "efficiency", "peak_memory", "timing", "threads_used")  # of the machine
PLAN = {"samplers": ["uniform", "multiscale"], "filters": ["box", "directional"], "spp": [2, 4], "replicates": 2}
CELLS = 2 * 2 * 2 * 2
MPI4PY = importlib.util.find_spec("mpi4py") is not None


def lines_in(folder):
    """How many cells are finished in it."""
    return sum(file.read_bytes().count(b"\n") for file in folder.glob("cells/*.jsonl"))


def facts(results):
    """Rows without what depends on the machine."""
    return [{key: value for key, value in row.items() if not key.startswith(TIMES)} for row in results.rows]


def plan_of(path, **changes):
    return {"recordings": [path], **PLAN, **changes}


@pytest.fixture
def whole(path):
    return spool.evaluate(plan_of(path))


@pytest.fixture
def pool():
    with concurrent.futures.ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")) as made:
        yield made


def test_the_same_bits_as_in_one_process(path, whole, pool, tmp_path):
    shares = []
    spread = spool.evaluate(plan_of(path), executor=pool, progress=lambda *at: shares.append(at))
    assert facts(spread) == facts(whole)
    assert spread.statistics["conditions"] == whole.statistics["conditions"]
    assert shares[-1] == (1.0, CELLS, CELLS)
    assert {row["timing"] for row in spread.rows} == {"shared"}


OFFSET = 0.0


@spool.sampler
def by_variance(statistics, power=0.5):
    return statistics.variance.sum(axis=2)**power


@spool.filter
def shifted(statistics):
    return statistics.mean + OFFSET


def test_own_functions_are_found_by_name(path, pool, monkeypatch):
    plan = plan_of(path, samplers=["uniform", {"name": by_variance, "power": [0.5, 1.0]}], filters=["box", shifted], spp=[4])
    assert facts(spool.evaluate(plan, executor=pool)) == facts(spool.evaluate(plan))
    monkeypatch.setitem(globals(), "OFFSET", 0.5)
    with pytest.raises(spool.SpoolError, match="shifted> is another function in a worker"):
        spool.evaluate(plan, executor=pool)


def test_a_function_that_no_worker_can_import_is_named(path, pool, monkeypatch):
    """As one of a notebook is."""
    monkeypatch.setitem(sys.modules, "notebook", types.ModuleType("notebook"))
    exec("import spool\n@spool.filter\ndef mine(statistics): return statistics.mean", vars(sys.modules["notebook"]))
    with pytest.raises(spool.SpoolError, match="python:mine@.*: a worker cannot import it .*notebook.*: put it into a module"):
        spool.evaluate(plan_of(path, filters=[sys.modules["notebook"].mine]), executor=pool)


def test_pictures_are_those_of_one_process(path, pool, tmp_path):
    spool.evaluate(plan_of(path, replicates=1), output=tmp_path / "one")
    spool.evaluate(plan_of(path, replicates=1), output=tmp_path / "many", executor=pool)
    names = sorted(str(file.relative_to(tmp_path / "one")) for file in (tmp_path / "one").rglob("*")
                   if file.suffix in (".png", ".exr"))
    assert names
    for name in names:
        assert (tmp_path / "many" / name).read_bytes() == (tmp_path / "one" / name).read_bytes(), name


def test_the_expensive_comes_first(path, monkeypatch):
    seen, told = [], executors._core.tasks

    class Core:
        evaluate = executors._core.evaluate

        @staticmethod
        def tasks(*arguments):
            seen.extend(told(*arguments)[0])
            return told(*arguments)

    monkeypatch.setattr(executors, "_core", Core)
    plan = plan_of(path, samplers=["uniform", "nl_means"], spp=[2, 16], filters=["box"], replicates=1)
    with concurrent.futures.ThreadPoolExecutor(1) as executor:
        spool.evaluate(plan, executor=executor)
    costs = [cost for _, _, cost in seen]
    assert len(costs) == 4 and costs == sorted(costs, reverse=True) and costs[0] > 3 * costs[-1] > 0


def test_short_runs_of_one_recording_go_together():
    tasks = [("a", ["1"], 5.0), ("b", ["2"], 1.5), ("a", ["3"], 1.0), ("b", ["4"], 0.75), ("a", ["5"], 0.25)]
    assert list(executors._together(tasks)) == [(5.0, ["1"]), (2.25, ["2", "4"]), (1.25, ["3", "5"])]


def test_what_a_killed_worker_had_is_made_by_the_same_call(path, whole, tmp_path, monkeypatch):
    monkeypatch.setattr(executors, "_SHORT", 0.0)
    output = tmp_path / "results"
    with concurrent.futures.ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as executor:
        def kill(share, done, of):
            if done < of:
                os.kill(next(iter(executor._processes)), signal.SIGKILL)
        with pytest.raises(spool.SpoolError, match="were lost with their workers .* the same call goes on") as raised:
            spool.evaluate(plan_of(path), output=output, executor=executor, progress=kill)
    assert raised.value.code == 1
    kept = lines_in(output)
    assert 0 < kept < CELLS
    counts = []
    with concurrent.futures.ThreadPoolExecutor(2) as executor:
        results = spool.evaluate(plan_of(path), output=output, executor=executor,
                                 progress=lambda share, done, of: counts.append(done))
    assert min(counts) > kept
    assert facts(results) == facts(whole)


def test_cells_that_fail_are_results(path, pool, layers, tmp_path):
    del layers["albedo"], layers["normal"], layers["depth"]
    spool.write(tmp_path / "bare.spool", sample_order="exchangeable", **layers)
    plan = {"recordings": [tmp_path / "bare.spool"], "samplers": ["uniform"], "filters": ["box", "cross_bilateral"], "spp": [2]}
    with pytest.raises(spool.SpoolError, match="results failed"):
        spool.evaluate(plan, output=tmp_path / "results", executor=pool)
    errors = [bool(row.get("error")) for row in spool.results(tmp_path / "results").rows]
    assert any(errors) and not all(errors)


def test_an_input_that_was_changed_is_noticed(path, program, pool, tmp_path):
    def evaluated(*filters):
        return spool.evaluate(plan_of(path, samplers=["counts:" + str(tmp_path / "n.exr")], filters=[*filters], spp=[4]), output=tmp_path / "results", executor=pool)

    for sampler in ("uniform", "multiscale"):
        assert program("replay", path, "--sampler", sampler, "--spp", 4, "-o", "n.exr", "--force")[0] == 0
        if sampler == "uniform":
            evaluated("box")
            evaluated("box", "gaussian")
    with pytest.raises(spool.SpoolError, match="n.exr: has changed since"):
        evaluated("box", "gaussian", "nl_means")


def test_an_input_that_is_another_for_a_worker_is_noticed(path, program, tmp_path):
    class Elsewhere(concurrent.futures.ThreadPoolExecutor):
        def submit(self, *call):
            assert program("replay", path, "--sampler", "multiscale", "--spp", 4, "-o", "n.exr", "--force")[0] == 0
            return super().submit(*call)

    assert program("replay", path, "--sampler", "uniform", "--spp", 4, "-o", "n.exr")[0] == 0
    with Elsewhere(1) as executor, pytest.raises(spool.SpoolError, match="n.exr: is another file for a worker"):
        spool.evaluate(plan_of(path, samplers=["counts:" + str(tmp_path / "n.exr")], spp=[4]), executor=executor)


def test_dask_with_workers_killed(path, whole, tmp_path, monkeypatch):
    monkeypatch.setattr(executors, "_SHORT", 0.0)
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None,
                                  local_directory=str(tmp_path)) as cluster, distributed.Client(cluster) as client:
        killed = []

        def kill(share, done, of):
            if len(killed) < 2 and done < of:
                worker = list(cluster.workers.values())[len(killed)]
                if worker.pid:
                    killed.append(worker.pid)
                    os.kill(worker.pid, signal.SIGKILL)
        results = spool.evaluate(plan_of(path), executor=client.get_executor(), progress=kill)
    assert len(killed) == 2
    assert facts(results) == facts(whole)


def test_functions_and_what_is_no_executor_are_named(path, pool):
    @spool.filter
    def mine(statistics):
        return statistics.mean

    with pytest.raises(spool.SpoolError, match="<spool.filter mine> is not found by its name in its module"):
        spool.evaluate(plan_of(path, filters=[mine]), executor=pool)
    with pytest.raises(spool.SpoolError, match="executor"):
        spool.evaluate(plan_of(path), executor=3)


@pytest.mark.parametrize("name", ["../outside", "/outside", "cells/../../outside", "dumps.json"])
def test_a_worker_writes_nothing_but_results(name, tmp_path):
    with pytest.raises(spool.SpoolError, match="a worker sent a file"):
        executors._keep(str(tmp_path / "results"), {name: b""}, str(tmp_path / "lines"))
    assert not (tmp_path / "outside").exists()


@pytest.fixture
def shell(path, program, monkeypatch):
    """`spool evaluate --executor`, with this Python."""
    monkeypatch.setenv("SPOOL_PYTHON", sys.executable)
    words = ["evaluate", path, "--samplers", "uniform,multiscale", "--filters", "box,directional", "--spp", "2,4", "--replicates", "2"]
    return lambda executor, *more: program(*words, "--executor", executor, *more)


def test_the_shell_names_an_executor(path, whole, shell, program, tmp_path):
    assert shell("processes:2", "-o", tmp_path / "results", "-q") == (0, "")
    made = spool.results(tmp_path / "results")
    assert facts(made) == facts(whole) and {row["timing"] for row in made.rows} == {"shared"}
    assert made.statistics["conditions"] == whole.statistics["conditions"]
    kept = {file: file.read_bytes() for file in (tmp_path / "results" / "cells").iterdir()}
    assert len(kept) == 1
    assert shell("processes:1", "-o", tmp_path / "results", "-q") == (0, "")
    assert {file: file.read_bytes() for file in (tmp_path / "results" / "cells").iterdir()} == kept
    assert shell("processes:1", "-o", tmp_path / "results", "-q", "--force") == (0, "")
    assert not any(file.exists() for file in kept)
    code, line = shell("processes:1", "-o", tmp_path / "results", "-q", "--seed", 7)
    assert code == 2 and "--force" in line  # in the program's words


def processes_with(word):
    """In their environment."""
    found = []
    for file in Path("/proc").glob("[0-9]*/environ"):
        with contextlib.suppress(OSError):
            if word.encode() in file.read_bytes():
                found.append(file)
    return found


@pytest.fixture
def at_work(path, tmp_path, monkeypatch):
    """Starts the program with workers, of which one waits for a command -> its process and its temporary folder."""
    monkeypatch.setenv("SPOOL_PYTHON", sys.executable)

    def start(name="run"):
        waiting, scratch = tmp_path / f"{name}_waiting", tmp_path / f"{name}_scratch"
        scratch.mkdir()
        started = subprocess.Popen([PROGRAM, "evaluate", path, "--samplers", "multiscale", "--filters", f"exec:touch {waiting}; sleep 600;", "--spp", "8",
                                    "--executor", "processes:2", "-o", tmp_path / name, "-q", "--no-pictures"],
                                   env={**os.environ, "TMPDIR": str(scratch)}, stderr=subprocess.PIPE, text=True)
        deadline = time.monotonic() + LONGEST_RUN
        while not waiting.exists():
            assert started.poll() is None and time.monotonic() < deadline
            time.sleep(0.05)
        return started, scratch
    return start


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_no_signal_leaves_a_worker_or_a_folder(at_work, number):
    started, scratch = at_work()
    assert len(processes_with(str(scratch))) >= 4
    started.send_signal(number)
    deadline = time.monotonic() + LONGEST_RUN
    lines = started.communicate(timeout=LONGEST_RUN)[1].splitlines()
    assert (started.returncode, len(lines)) == ((-number, 0) if number == signal.SIGKILL else (128 + number, 1)), lines
    while processes_with(str(scratch)) or any(scratch.iterdir()):
        assert time.monotonic() < deadline
        time.sleep(0.05)


def test_an_interrupt_leaves_no_semaphore(at_work):
    """Python's guard of them has a tenth of a second, which a busy machine may take from it; other processes have some, too."""
    for attempt in range(5):
        before = set(Path("/dev/shm").glob("sem.mp-*"))
        started, _ = at_work(f"run_{attempt}")
        assert not before.issuperset(Path("/dev/shm").glob("sem.mp-*"))
        started.send_signal(signal.SIGINT)
        started.communicate(timeout=LONGEST_RUN)
        if before.issuperset(Path("/dev/shm").glob("sem.mp-*")):
            return
    pytest.fail("each run left some")


def test_dask_from_the_shell_with_a_worker_killed(path, whole, shell, tmp_path):
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None, local_directory=str(tmp_path / "dask")) as cluster:
        victim = list(cluster.workers.values())[0].pid
        folder = tmp_path / "results"
        lost = []

        def kill():
            while not lines_in(folder):
                time.sleep(0.01)
            lost.append(lines_in(folder))
            os.kill(victim, signal.SIGKILL)
        killer = threading.Thread(target=kill, daemon=True)
        killer.start()
        plan = tmp_path / "plan.toml"
        plan.write_text(f'recordings = ["{path}"]\nsamplers = ["uniform", "multiscale"]\nfilters = ["box", "directional"]\nspp = [2, 4]\nreplicates = 160\n')
        done = subprocess.run([PROGRAM, "evaluate", plan, "--executor", f"dask:{cluster.scheduler_address}", "-o", folder, "-q"],
                              capture_output=True, text=True, timeout=LONGEST_RUN)
        killer.join(timeout=LONGEST_RUN)
    assert done.returncode == 0 and done.stdout == "", done.stderr
    assert lost and 0 < lost[0] < 1280
    alone = subprocess.run([PROGRAM, "evaluate", plan, "-o", tmp_path / "alone", "-q"], capture_output=True, text=True, timeout=LONGEST_RUN)
    assert alone.returncode == 0, alone.stderr
    assert facts(spool.results(folder)) == facts(spool.results(tmp_path / "alone"))


@pytest.mark.skipif(not MPI4PY or not shutil.which("mpiexec"), reason="no MPI")
def test_processes_of_mpi_work_for_the_first(path, whole, tmp_path, monkeypatch):
    for name in ("OMPI_ALLOW_RUN_AS_ROOT", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "OMPI_MCA_rmaps_base_oversubscribe"):
        monkeypatch.setenv(name, "1")
    plan = tmp_path / "plan.toml"
    plan.write_text(f'recordings = ["{path}"]\nsamplers = ["uniform", "multiscale"]\nfilters = ["box", "directional"]\nspp = [2, 4]\nreplicates = 2\n')
    done = subprocess.run(["mpiexec", "-n", "3", PROGRAM, "evaluate", plan, "--executor", "mpi", "-o", tmp_path / "results"],
                          capture_output=True, text=True, timeout=LONGEST_RUN)
    assert done.returncode == 0 and done.stdout.count("numbers: ") == 1, done.stderr
    assert facts(spool.results(tmp_path / "results")) == facts(whole)


@pytest.mark.parametrize("executor, code, line", [
    ("processes:0", 2, "write one of processes:N, dask:ADDRESS, mpi"), ("ray:", 2, "write one of"), ("dask:", 2, "write one of"),
    ("dask:tcp://127.0.0.1:9", 3, "no Dask scheduler there"), ("mpi", 2, "no workers" if MPI4PY else "mpi4py.futures is not there")])
def test_an_executor_that_is_not_there_is_one_line(executor, code, line, shell, tmp_path):
    found, said = shell(executor, "-o", tmp_path / "results")
    assert found == code and line in said and "\n" not in said, said
    assert not (tmp_path / "results").exists()


def test_a_python_without_the_package_is_named(shell, tmp_path, monkeypatch):
    monkeypatch.setenv("SPOOL_PYTHON", "/nonexistent/python3")
    code, said = shell("processes:1", "-o", tmp_path / "results")
    assert code == 2 and "/nonexistent/python3 has no package spool" in said and "\n" not in said
    assert "pip install spool-lab" not in said and "docs/python.md" in said  # no index of packages has it
    assert shell("processes:1", "-o", tmp_path / "results", "--merge")[0] == 2
