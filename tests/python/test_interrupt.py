"""Ctrl-C ends the work and raises KeyboardInterrupt; other Python threads run meanwhile."""
import os
import signal
import threading
import time

import numpy as np
import pytest

import spool


def interrupt_after(seconds):
    timer = threading.Timer(seconds, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    return timer


@pytest.fixture(scope="module")
def large():
    return spool.synth("slanted_edge", width=256, height=256, spp=32)


def test_evaluate_goes_on_afterwards(large, tmp_path):
    plan = {"recordings": [large], "spp": [8, 16], "replicates": 12, "samplers": ["multiscale"],
            "filters": ["directional", "twin_guides"], "pictures": False}
    start = time.monotonic()
    interrupt_after(3.0)
    with pytest.raises(KeyboardInterrupt):
        spool.evaluate(plan, output=tmp_path / "kept")
    assert time.monotonic() - start < 30
    kept = len(list((tmp_path / "kept" / "cells").iterdir()))
    smaller = {**plan, "replicates": 1}
    with pytest.raises(spool.SpoolError, match="does not have" if kept else ""):
        spool.evaluate({**smaller, "spp": [2]}, output=tmp_path / "kept")


def test_a_sampler_in_python(large):
    @spool.sampler(rounds=1000, init_spp=1)
    def slow(statistics):
        time.sleep(0.05)
        return np.ones(statistics.n.shape) if statistics.round == 0 else np.eye(256)

    interrupt_after(0.5)
    start = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        spool.replay(large, slow, 16)
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
