"""Ctrl-C ends the work and raises KeyboardInterrupt; other Python threads run meanwhile; the interpreter may end."""
import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import spool


def interrupted(call, *seconds):
    """Signals after so many seconds; where the first one ends the call already, the others reach no later one."""
    timers = [threading.Timer(after, os.kill, (os.getpid(), signal.SIGINT)) for after in seconds]
    for timer in timers:
        timer.start()
    with pytest.raises(KeyboardInterrupt):
        call()
    handler = signal.signal(signal.SIGINT, signal.SIG_IGN)
    for timer in timers:
        timer.cancel()
        timer.join()
    signal.signal(signal.SIGINT, handler)


@pytest.fixture(scope="module")
def large():
    return spool.synth("slanted_edge", width=256, height=256, spp=32)


def test_evaluate_goes_on_afterwards(large, tmp_path):
    plan = {"recordings": [large], "spp": [8, 16], "replicates": 12, "samplers": ["multiscale"],
            "filters": ["directional", "twin_guides"], "pictures": False}
    begin = []

    def interrupt(share, done, of):
        if done > 0 and not begin:
            begin.append(time.monotonic())
            os.kill(os.getpid(), signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        spool.evaluate(plan, output=tmp_path / "kept", progress=interrupt)
    assert time.monotonic() - begin[0] < 1.0 * int(os.environ.get("SPOOL_TIMEOUT_FACTOR", "1"))
    assert len(list((tmp_path / "kept" / "cells").iterdir())) > 0
    with pytest.raises(spool.SpoolError, match="does not have"):
        spool.evaluate({**plan, "replicates": 1, "spp": [2]}, output=tmp_path / "kept")


def test_evaluate_of_arrays_goes_on_afterwards(tmp_path):
    def evaluated(random):
        samples = np.random.default_rng(random).random((8, 8, 8, 3))
        return spool.evaluate({"recordings": [samples, spool.recording(samples, albedo=samples, reference=samples[:, :, 0])], "spp": [2],
                               "replicates": 1, "samplers": ["uniform"], "filters": ["box"]}, output=tmp_path / "kept").rows

    first, again = evaluated(1), evaluated(1)
    assert len(first) == 2 and [{**row, "dump_path": ""} for row in first] == [{**row, "dump_path": ""} for row in again]
    with pytest.raises(spool.SpoolError, match="is not the recording"):
        evaluated(2)


def test_a_sampler_in_python(large):
    @spool.sampler(rounds=1000, init_spp=1)
    def slow(statistics):
        time.sleep(0.05)
        return np.ones(statistics.n.shape) if statistics.round == 0 else np.eye(256)

    start = time.monotonic()
    interrupted(lambda: spool.replay(large, slow, 16), 0.5)
    assert time.monotonic() - start < 10


def test_what_progress_raises_ends_the_work(large):
    def enough(share, done, of):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        spool.evaluate({"recordings": [large], "spp": [8], "replicates": 16, "samplers": ["multiscale"],
                        "filters": ["directional"], "pictures": False}, progress=enough)


def test_other_threads_run_meanwhile(large):
    ticks, going = [], True

    def tick():
        while going:
            ticks.append(time.monotonic())
            time.sleep(0.002)

    thread = threading.Thread(target=tick)
    thread.start()
    begin = time.monotonic()
    spool.reconstruct(large, spool.replay(large, "multiscale", 16), "directional")
    end = time.monotonic()
    going = False
    thread.join()
    inside = [time for time in ticks if begin < time < end]
    assert len(inside) > 5 and max(np.diff([begin, *inside, end])) < 0.5 * (end - begin)


@pytest.mark.parametrize("name", ["nl_means", "twin_guides", "directional", "welch", "greedy_selection"])
def test_a_filter_ends_within_a_second(name):
    large = spool.synth("slanted_edge", width=512, height=512, spp=16)
    spool.replay(large, "uniform", 1)  # the file is open
    begin = []

    def interrupt():
        begin.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    timer = threading.Timer(0.7, interrupt)
    timer.start()
    try:
        spool.reconstruct(large, None, name, **({"window": 10} if name == "nl_means" else {}))
        timer.cancel()  # done before the signal, or just then: until the timer has ended, it may still come
        timer.join()
        assert not begin
    except KeyboardInterrupt:
        assert time.monotonic() - begin[0] < 1.0 * int(os.environ.get("SPOOL_TIMEOUT_FACTOR", "1"))
    assert np.isfinite(spool.reconstruct(large, None, "box")).all()


def test_a_command_that_waits_is_ended(large, tmp_path):
    waiting, ended, begin = tmp_path / "waiting", threading.Event(), []
    command = f"exec:touch {waiting}; sleep 60;"
    plan = {"recordings": [large], "spp": [4], "replicates": 1, "samplers": ["uniform"], "filters": ["box", command], "pictures": False}

    def interrupt():
        while not waiting.exists():
            if ended.wait(0.02):
                return
        begin.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    for call in (lambda: spool.reconstruct(large, None, command), lambda: spool.replay(large, command, 4),
                 lambda: spool.evaluate(plan, output=tmp_path / "kept")):
        waiting.unlink(missing_ok=True)
        thread = threading.Thread(target=interrupt)
        thread.start()
        try:
            with pytest.raises(KeyboardInterrupt):
                call()
            assert time.monotonic() - begin[-1] < 30
        finally:
            ended.set()
            thread.join()
            ended.clear()
    line, = next((tmp_path / "kept" / "cells").iterdir()).read_text().splitlines()
    assert '"method":"uniform + box"' in line  # the other one is missing, not failed


def test_a_function_that_never_ends(large):
    @spool.sampler
    def endless(statistics):
        while True:
            pass

    @spool.filter
    def stubborn(statistics):
        for _ in range(2):  # takes one signal for something else
            try:
                while True:
                    time.sleep(0.01)
            except KeyboardInterrupt:
                pass
        return statistics.mean

    interrupted(lambda: spool.replay(large, endless, 4), 0.5)
    interrupted(lambda: spool.reconstruct(large, None, stubborn), 0.5, 0.7)
    interrupted(lambda: spool.evaluate({"recordings": [large], "spp": [4], "replicates": 1, "samplers": [endless], "filters": ["box"]}), 0.7)


def test_a_function_that_waits_is_left_to_itself(large, tmp_path):
    began, ended = [], []

    def wait(statistics):
        began.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)
        try:
            time.sleep(3)  # no exception reaches it there
        finally:
            ended.append(time.monotonic())
        return statistics.mean

    def files():
        return [(path, path.stat().st_mtime_ns) for path in sorted(tmp_path.rglob("*"))]

    waiting, waiting_too = spool.filter(wait), spool.sampler(lambda statistics: wait(statistics)[..., 0])
    plan = {"recordings": [large], "spp": [4], "replicates": 2, "samplers": ["uniform"], "filters": ["box", waiting]}
    for call in (lambda: spool.reconstruct(large, None, waiting), lambda: spool.replay(large, waiting_too, 4),
                 lambda: spool.evaluate(plan, output=tmp_path / "kept")):
        with pytest.raises(KeyboardInterrupt):
            call()
        assert time.monotonic() - began[-1] < 1.0 * int(os.environ.get("SPOOL_TIMEOUT_FACTOR", "1"))
    kept = files()
    while len(ended) < len(began):
        time.sleep(0.1)
    time.sleep(0.2)
    assert len(began) == 3 and kept and files() == kept


@pytest.mark.parametrize("raised", [KeyboardInterrupt("mine"), SystemExit(3), GeneratorExit()])
def test_what_is_no_failure_stays_what_it_is(large, raised):
    @spool.sampler
    def leaving(statistics):
        raise raised

    @spool.filter
    def leaving_too(statistics):
        raise raised

    for call in (lambda: spool.replay(large, leaving, 4), lambda: spool.reconstruct(large, None, leaving_too),
                 lambda: spool.evaluate({"recordings": [large], "spp": [4], "replicates": 1, "samplers": ["uniform"],
                                         "filters": [leaving_too]})):
        with pytest.raises(type(raised)) as caught:
            call()
        assert caught.value is raised


def test_a_function_calls_the_library_and_not_itself(large):
    @spool.sampler(rounds=1)
    def helped(statistics):
        return spool.replay(large, "uniform", 2).counts

    @spool.sampler(rounds=1)
    def itself(statistics):
        return spool.replay(large, itself, 2).counts

    assert (spool.replay(large, helped, 4).counts >= 3).all()
    with pytest.raises(spool.SpoolError, match="none like itself"):
        spool.replay(large, itself, 4)
    assert threading.active_count() < 10


def test_calls_that_ask_for_themselves_by_other_threads_come_to_an_end():
    recording, deepest = spool.recording(np.ones((4, 4, 2, 3))), []

    @spool.filter
    def itself(statistics):
        def ask():
            try:
                spool.reconstruct(recording, None, itself)
            except spool.SpoolError as error:
                deepest.append((str(error), len(os.listdir("/proc/self/task"))))

        thread = threading.Thread(target=ask)
        thread.start()
        thread.join()
        return statistics.mean

    assert (spool.reconstruct(recording, None, itself) == 1).all()
    (line, tasks), = deepest
    assert "256 calls have not returned" in line and tasks < 900
    assert (spool.reconstruct(recording, None, "box") == 1).all()


@pytest.mark.parametrize("work", ["spool.replay(dump, 'multiscale', 32)", "spool.reconstruct(dump, None, 'nl_means')",
                                  "spool.replay(dump, endless, 4)", "spool.replay(dump, asleep, 4)"])
def test_the_interpreter_ends_while_a_thread_works(work):
    script = f"""
import threading, time, spool
dump = spool.synth("slanted_edge", width=256, height=256, spp=32)
@spool.sampler
def endless(statistics):
    while True: pass
@spool.sampler
def asleep(statistics):
    time.sleep(1e6)
def go_on():
    while True: {work}
for _ in range(2):
    threading.Thread(target=go_on, daemon=True).start()
time.sleep(1)
print("end", flush=True)
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout) == (0, "end\n") and "terminate" not in done.stderr, done.stderr


def test_the_interpreter_ends_while_a_function_is_left_to_itself():
    script = """
import os, signal, time, spool
@spool.filter
def deaf(statistics):
    os.kill(os.getpid(), signal.SIGINT)
    while True:
        try:
            while True: time.sleep(0.0005)
        except KeyboardInterrupt: pass
for _ in range(2):
    try: spool.reconstruct(spool.example(), None, deaf)
    except KeyboardInterrupt: print("end")
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout, done.stderr) == (0, "end\nend\n", "")


def test_a_child_of_a_fork_waits_for_no_work_of_its_parent():
    script = """
import os, sys, threading, time, spool
inside, end = threading.Event(), threading.Event()
@spool.filter
def waits(statistics):
    inside.set()
    end.wait()
    return statistics.mean
dump = spool.example()
work = threading.Thread(target=lambda: spool.reconstruct(dump, None, waits))
work.start()
inside.wait()
if os.fork() == 0:
    begin = time.monotonic()
    spool._core.end_all_work()  # as at its exit, where work gets five seconds
    os._exit(time.monotonic() - begin > 4)
_, code = os.wait()
end.set()
work.join()
sys.exit(code != 0)
"""
    subprocess.run([sys.executable, "-c", script], check=True, timeout=60)


def fails(number):
    return spool.replay(np.ones((4, 4, 2, 3)), "uniform", number)


def works(number):
    return spool.replay(np.ones((4, 4, 8, 3)), "multiscale", number).log["spent"]


@pytest.mark.parametrize("start", ["fork", "spawn"])
def test_other_processes(start, monkeypatch):
    works(2)  # the threads of this process are not in the other one
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(sys.path))
    with multiprocessing.get_context(start).Pool(2) as pool:
        assert pool.map_async(works, [1, 2, 3, 4]).get(60) == [16, 32, 48, 64]
        with pytest.raises(spool.SpoolError, match="spp: -1") as caught:
            pool.map_async(fails, [-1]).get(60)
    assert caught.value.code == spool.USAGE
