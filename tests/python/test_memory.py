"""A mapped recording is not copied, an array is, and many calls take no more memory than a few."""
import os
import re
import subprocess
import sys
import weakref

import numpy as np
import pytest

import spool

# Private memory: what a copy would be. Pages of a mapped file are shared.
MEASURE = """
import re, sys, spool
def private():
    text = open("/proc/self/smaps_rollup").read()
    return sum(int(re.search(rf"^{name}: +(\\d+)", text, re.M)[1]) for name in ("Private_Dirty", "Anonymous")) // 2 * 1024
spool.replay(spool.synth("slanted_edge", width=16, height=16, spp=4), "uniform", 2)  # what is taken once
dump = spool.open(sys.argv[1])
before = private()
chosen = spool.replay(dump, "uniform", 4)
image = spool.reconstruct(dump, chosen, "box")
print(private() - before, chosen.counts.size)
"""


def measured(script, *words):
    """What a child prints; a sanitizer keeps nothing there that was let go."""
    options = os.environ.get("ASAN_OPTIONS", "") + ":quarantine_size_mb=0:thread_local_quarantine_size_kb=0"
    return subprocess.run([sys.executable, "-c", script, *map(str, words)], check=True, stdout=subprocess.PIPE, text=True,
                          env={**os.environ, "ASAN_OPTIONS": options}).stdout


def test_a_mapped_file(tmp_path):
    side = int(os.environ.get("SPOOL_PYTHON_MEMORY_SIDE", "256"))  # 1672: 2 GB
    spp = 64
    path = tmp_path / "large.spool"
    spool.synth("slanted_edge", width=side, height=side, spp=spp, path=path)
    taken, pixels = map(int, measured(MEASURE, path).split())
    size = path.stat().st_size
    assert size > 12 * spp * side * side
    # Statistics, selection and image are some 300 bytes a pixel; the samples are 768.
    assert taken < 400 * pixels + 8e6 < 0.75 * size + 8e6, (taken, size)


# After 200 calls, which take what is taken once; 3000 in the full test.
MANY_CALLS = """
import gc, re, sys, numpy as np, spool
def resident():
    gc.collect()
    return int(re.search(r"VmRSS:\\s+(\\d+)", open("/proc/self/status").read())[1]) * 1024
random = np.random.default_rng(1)
recording = spool.recording(random.random((8, 8, 8, 3), np.float32))
image = random.random((8, 8, 3))
chosen = spool.replay(recording, "uniform", 4)
calls = {"replay": lambda: spool.replay(recording, "multiscale", 4), "metrics": lambda: spool.metrics(image, image),
         "reconstruct": lambda: spool.reconstruct(recording, chosen, "directional")}
count = int(sys.argv[1])
for call in calls.values():
    for _ in range(200):
        call()
for name, call in calls.items():
    before = resident()
    for _ in range(count):
        call()
    print(name, resident() - before)
"""


def test_many_calls():
    calls = int(os.environ.get("SPOOL_PYTHON_CALLS", "1000"))
    taken = {name: int(size) for name, size in map(str.split, measured(MANY_CALLS, calls).splitlines())}
    assert len(taken) == 3 and max(taken.values()) < 4e6 * max(calls / 3000, 1 / 3), taken


def test_an_array_is_copied():
    planes = np.random.default_rng(1).random((3, 8, 8, 16), np.float32)  # [c][y][x][s], as the library reads it
    recording = spool.recording(np.moveaxis(planes, 0, 3), reference=np.ones((8, 8, 3)))
    before = {sampler: spool.replay(recording, sampler, 4).image for sampler in ("uniform", "greedy_error", "multiscale")}
    planes[1, 5, 5, 2] = np.nan
    planes[:, 3] = np.inf
    for sampler, image in before.items():
        assert (spool.replay(recording, sampler, 4).image == image).all()
    for array in recording.arrays.values():
        with pytest.raises(ValueError, match="read-only"):
            array[0, 0, 0] = 1
    with pytest.raises(spool.SpoolError, match="not finite"):
        spool.replay(np.moveaxis(planes, 0, 3), "uniform", 4)


@pytest.mark.parametrize("value", [np.nan, np.inf, -3e38])
def test_a_mapped_file_that_is_rewritten_in_place(tmp_path, value):
    """Its samples lie in the file: what stands there later gives an error, and no picture."""
    radiance = np.random.default_rng(3).random((20, 24, 16, 3), np.float32)
    path = tmp_path / "scene.spool"
    spool.write(path, radiance=radiance, albedo=radiance, normal=radiance, depth=radiance[..., :1], sample_order="exchangeable",
                tile_size=16, block_spp=8)
    with spool.open(path) as dump:
        chosen = spool.replay(dump, "uniform", 4)
        os.utime(path)  # touched, and nothing else
        assert np.isfinite(spool.replay(dump, "multiscale", 4).image).all()
        bytes_of_file = path.read_bytes()
        words = np.frombuffer(bytes_of_file[:len(bytes_of_file) // 4 * 4], "<u4")
        places = np.isin(words, radiance.ravel()[1000:1100].view("<u4")).nonzero()[0]
        assert len(places) >= 100
        with open(path, "r+b") as file:
            for place in places.tolist():
                file.seek(4 * place)
                file.write(np.float32(value).tobytes())
        for name, one in spool.samplers().items():
            if not one["argument"]:
                with pytest.raises(spool.SpoolError, match="overwritten|does not match its checksum"):
                    spool.replay(dump, f"{name}{{filter=box}}" if name in ("filtered_halves", "cross_halves") else name, 6)
        for name, one in spool.filters().items():
            if not one["argument"] and name != "oidn":
                with pytest.raises(spool.SpoolError, match="overwritten|does not match its checksum"):
                    spool.reconstruct(dump, chosen, name)


def test_a_file_that_another_took_the_name_of(tmp_path):
    """numpy has the file that was opened, and the library takes no other for it."""
    for name, value in ("a", 1), ("b", 2):
        spool.write(tmp_path / f"{name}.spool", radiance=np.full((4, 5, 4, 3), value, "f4"), sample_order="exchangeable")
    plan = {"samplers": ["uniform"], "filters": ["box"], "spp": [2], "replicates": 1}
    with spool.open(tmp_path / "a.spool") as dump, spool.open(tmp_path / "a.spool") as loaded:
        chosen = spool.replay(loaded, "uniform", 2)
        os.replace(tmp_path / "b.spool", tmp_path / "a.spool")
        assert dump.read("radiance").max() == 1 and spool.reconstruct(loaded, chosen, "box").max() == 1
        for call in (lambda: spool.replay(dump, "uniform", 2), lambda: spool.evaluate({"recordings": [dump], **plan}), dump._repr_html_):
            with pytest.raises(spool.SpoolError, match=r"a\.spool: is not the file that was opened: open it again"):
                call()
    assert spool.replay(tmp_path / "a.spool", "uniform", 2).image.max() == 2


def test_a_function_goes_with_the_last_that_holds_it():
    recording = spool.recording(np.ones((4, 4, 2, 3)))

    def made():
        held = np.ones(3)
        return spool.filter(lambda statistics: statistics.mean * held, label="own"), weakref.ref(held)

    for call in (lambda own: spool.reconstruct(recording, None, own),
                 lambda own: spool.evaluate({"recordings": [recording], "spp": [1], "replicates": 1, "samplers": ["uniform"], "filters": [own]})):
        own, held = made()
        twin, held_too = made()  # of the same name
        call(own), call(twin)
        del own
        call(twin)
        del twin
        assert held() is None and held_too() is None
    chosen = spool.replay(recording, spool.sampler(lambda statistics: statistics.n), 1)
    assert list(chosen.views) == ["n"]  # it runs again


def test_a_view_outlives_what_it_came_from():
    def image():
        samples = np.ones((8, 8, 4, 3), np.float32)
        return spool.replay(spool.recording(samples), "uniform", 4).image
    assert (image() == 1).all() and re.match(r"\d", spool.__version__)
