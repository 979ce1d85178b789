"""What the program says it needs of memory is what it takes, and limits of the process count."""
import os
import re
import resource
import subprocess
import time
from pathlib import Path

import numpy as np
import pytest
import spool

from conftest import LONGEST_RUN, PROGRAM

SLOW = int(os.environ.get("SPOOL_TIMEOUT_FACTOR", "1"))
SIZE, SAMPLES = 256, 16
SAMPLERS = ["uniform", "multiscale", "mitchell", "adaptive_wavelet", "greedy_error", "nl_means", "cross_bilateral", "neyman", "filtered_halves", "cross_halves", "denoised_variance"]
FILTERS = ["box", "gaussian", "directional", "greedy_selection", "nl_means", "cross_bilateral", "multistage", "wavelet_shrinkage", "oracle_scale",
           "twin_guides", "welch", "stater"]
GROUPS = {Path("/sys/fs/cgroup/memory"): "memory.limit_in_bytes", Path("/sys/fs/cgroup"): "memory.max"}

pytestmark = pytest.mark.skipif(SLOW > 1, reason="a sanitizer takes memory of its own")


@pytest.fixture(scope="module")
def recordings(tmp_path_factory):
    """The same picture with its samples in the file, packed, and with a film position of each sample."""
    folder = tmp_path_factory.mktemp("recordings")
    random = np.random.default_rng(1)
    mean = np.linspace(0.2, 2, SIZE)[None, :, None, None] * np.where(np.arange(SIZE)[:, None, None, None] < SIZE // 2, 1, 3)
    radiance = (mean * random.exponential(1, (SIZE, SIZE, SAMPLES, 3))).astype("f4")
    reference = np.repeat(mean[:, :, 0], 3, axis=2).astype("f4")
    layers = {"reference": reference, "reference_variance": np.zeros_like(reference), "depth": random.random((SIZE, SIZE, SAMPLES)).astype("f2"),
              "albedo": random.random((SIZE, SIZE, SAMPLES, 3)).astype("f2"), "normal": random.random((SIZE, SIZE, SAMPLES, 3)).astype("f2")}
    spool.write(folder / "plain.spool", radiance, sample_order="exchangeable", **layers)
    spool.write(folder / "half.spool", radiance.astype("f2"), sample_order="exchangeable", **layers)
    film = random.random((SIZE, SIZE, SAMPLES, 2)).astype("f4")
    spool.write(folder / "film.spool", radiance, sample_order="exchangeable", film=film, **layers)
    return folder


def command(verb, dump, method, folder):
    return [PROGRAM, verb, str(dump), *{"replay": ["--sampler", method, "--spp", "8"], "reconstruct": ["--filter", method, "--spp", "4"],
                                        "evaluate": ["--samplers", "uniform", "--filters", method, "--spp", "4", "--replicates", "2", "--no-pictures",
                                                     "--timing", "exact"]}[verb],  # one result after another
            *(["--filter", "box"] if method in ("filtered_halves", "cross_halves") else []), "--force", "-q", "--threads", "2",
            "-o", str(folder / ("results" if verb == "evaluate" else "out.exr"))]


def said(arguments):
    """Bytes that the program says it needs, refused because almost nothing is free."""
    done = subprocess.run(arguments, env={**os.environ, "SPOOL_MEMORY": "1000"}, capture_output=True, text=True, timeout=LONGEST_RUN)
    found = re.search(r"needs about ([\d.e+-]+) GB", done.stderr)
    assert done.returncode == 1 and found, done.stderr
    return 1e9 * float(found.group(1))


def taken(arguments):
    """The largest anonymous memory that was seen, bytes; mapped files are not among it."""
    with subprocess.Popen(arguments, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as process:
        most, status = 0, Path(f"/proc/{process.pid}/status")
        while process.poll() is None:
            found = re.search(r"RssAnon:\s+(\d+) kB", status.read_text())
            most = max(most, 1024 * int(found.group(1)) if found else 0)
            time.sleep(0.0005)
        assert process.returncode == 0, process.stderr.read()
    return most


def compare(arguments):
    """Within a tenth; a second look where the peak was short and not seen."""
    need = said(arguments)
    for attempt in range(4):
        ratio = need / taken(arguments)
        if 0.9 < ratio < 1.1:
            break
    print(f"{need / 1e6:7.1f} MB said, {need / ratio / 1e6:7.1f} MB taken: {ratio:.3f}  {arguments[1:5]}")
    assert 0.9 < ratio < 1.1, (arguments[1:], need, ratio)


@pytest.mark.parametrize("sampler", SAMPLERS)
def test_what_a_sampler_needs_is_known_within_a_tenth(recordings, tmp_path, sampler):
    compare(command("replay", recordings / "plain.spool", sampler, tmp_path))


@pytest.mark.parametrize("filter_name", [*FILTERS, "box{clamp=on}", "box{energy=box}", "box{energy=first}", "box{residual=halves}", "directional{clamp=on}", "nl_means{clamp=on,energy=box}"])
def test_what_a_filter_needs_is_known_within_a_tenth(recordings, tmp_path, filter_name):
    compare(command("reconstruct", recordings / "plain.spool", filter_name, tmp_path))


@pytest.mark.parametrize("verb, method", [("replay", "multiscale"), ("reconstruct", "directional")])
def test_images_that_are_shown_are_counted_roughly(recordings, tmp_path, verb, method):
    """How many a family has is known when they are made; refused too late would be a killed process."""
    arguments = [*command(verb, recordings / "plain.spool", method, tmp_path), "--views", "all"]
    ratio = said(arguments) / taken(arguments)
    print(f"{ratio:.3f} {arguments[1:]}")
    assert 0.75 < ratio < 1.5, ratio


@pytest.mark.parametrize("dump", ["half", "film"])
def test_what_cannot_stay_in_the_file_is_counted(recordings, tmp_path, dump):
    for verb, method in (("replay", "uniform"), ("reconstruct", "directional")):
        compare(command(verb, recordings / f"{dump}.spool", method, tmp_path))


@pytest.mark.parametrize("filter_name", ["box", "nl_means", "directional"])
def test_what_an_evaluation_needs_is_known_within_a_tenth(recordings, tmp_path, filter_name):
    compare(command("evaluate", recordings / "plain.spool", filter_name, tmp_path))


def test_film_positions_that_no_method_asks_for_are_not_read(recordings, tmp_path):
    """So that their damage is not noticed, and they take no memory."""
    data = bytearray((recordings / "film.spool").read_bytes())
    with spool.open(recordings / "film.spool") as dump:
        at = data.index(dump.read("film")[0, 0, :4, 0].tobytes())
    data[at] ^= 1
    (tmp_path / "damaged.spool").write_bytes(data)
    plain = said(command("reconstruct", recordings / "plain.spool", "box", tmp_path))
    assert said(command("reconstruct", recordings / "film.spool", "box", tmp_path)) == plain
    # Read where they lie, they take none either; packed ones take what they are unpacked.
    assert said(command("reconstruct", recordings / "film.spool", "multistage", tmp_path)) == said(
        command("reconstruct", recordings / "plain.spool", "multistage", tmp_path))
    for arguments, code in ((command("reconstruct", tmp_path / "damaged.spool", "box", tmp_path), 0),
                            (command("reconstruct", tmp_path / "damaged.spool", "multistage", tmp_path), 4),
                            (command("replay", tmp_path / "damaged.spool", "uniform", tmp_path), 0),
                            ([*command("replay", tmp_path / "damaged.spool", "uniform", tmp_path), "--pieces", "2"], 4)):
        done = subprocess.run(arguments, capture_output=True, text=True, timeout=LONGEST_RUN)
        assert done.returncode == code and ("damaged.spool" in done.stderr) == (code == 4), (arguments, done)


def control_group(limit):
    """A new group with this limit of memory, or a skip."""
    for top, file in GROUPS.items():
        group = top / f"spool_test_{os.getpid()}"
        try:
            if (top / "cgroup.procs").exists():
                group.mkdir()
                (group / file).write_text(str(int(limit)))
                return group
        except OSError:
            if group.exists():
                group.rmdir()
    pytest.skip("no control group can be made here")


@pytest.mark.parametrize("dump, filter_name", [("half", "directional"), ("film", "box"), ("film", "multistage")])
def test_what_is_said_to_fit_fits_into_a_control_group(recordings, tmp_path, dump, filter_name):
    """Nothing but the limit holds the process: if it took more than it said, the kernel would end it."""
    arguments = command("reconstruct", recordings / f"{dump}.spool", filter_name, tmp_path)
    group = control_group(1.1 * said(arguments) + 3e6)  # program and libraries
    try:
        enter = lambda: (group / "cgroup.procs").write_text(str(os.getpid()))
        done = subprocess.run(arguments, preexec_fn=enter, capture_output=True, text=True, timeout=LONGEST_RUN)
        assert done.returncode == 0, (done.returncode, done.stderr)
        group_limit = next(file for file in GROUPS.values() if (group / file).exists())
        (group / group_limit).write_text(str(int(0.7 * said(arguments))))
        done = subprocess.run(arguments, preexec_fn=enter, capture_output=True, text=True, timeout=LONGEST_RUN)
        assert done.returncode == 1 and "GB of memory" in done.stderr, (done.returncode, done.stderr)
    finally:
        group.rmdir()


@pytest.mark.parametrize("limit", ["RLIMIT_AS", "RLIMIT_DATA"])
def test_limits_of_the_process_count(recordings, tmp_path, limit):
    arguments = command("reconstruct", recordings / "half.spool", "directional", tmp_path)
    kind = getattr(resource, limit)

    def run(most):
        return subprocess.run(arguments, preexec_fn=lambda: resource.setrlimit(kind, (most, most)), capture_output=True, text=True,
                              timeout=LONGEST_RUN)
    done = run(4 << 30)
    assert done.returncode == 0, done.stderr
    done = run((140 << 20) if limit == "RLIMIT_AS" else (100 << 20))
    assert done.returncode == 1 and "GB of memory" in done.stderr and len(done.stderr.splitlines()) == 1, (done.returncode, done.stderr)


def test_one_thread_needs_no_addresses_for_others(recordings, tmp_path):
    """A further thread takes 72 MB of addresses; of `ulimit -v` nothing is set aside for threads that there will not be."""
    arguments = command("reconstruct", recordings / "half.spool", "directional", tmp_path)
    for threads, code in (("1", 0), ("2", 1)):
        arguments[arguments.index("--threads") + 1] = threads
        done = subprocess.run(arguments, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (140 << 20, 140 << 20)), capture_output=True,
                              text=True, timeout=LONGEST_RUN)
        assert done.returncode == code, (threads, done.returncode, done.stderr)


@pytest.fixture(scope="module")
def long_recording(tmp_path_factory):
    """Little picture, many samples, film positions: eight times the memory that it may take."""
    folder = tmp_path_factory.mktemp("long")
    random = np.random.default_rng(2)
    side, samples = 96, 400
    radiance = random.exponential(1, (side, side, samples, 3)).astype("f4")
    film = random.random((side, side, samples, 2)).astype("f4")
    spool.write(folder / "long.spool", radiance, sample_order="exchangeable", film=film, tile_size=16, block_spp=16)
    spool.write(folder / "half.spool", radiance.astype("f2"), sample_order="exchangeable", film=(0.99 * film).astype("f2"), tile_size=16, block_spp=16)
    return folder


def watched(arguments, memory):
    """Most anonymous memory and bytes read of a run that may take so much, as last seen."""
    with subprocess.Popen(arguments, env={**os.environ, "SPOOL_MEMORY": str(int(memory))}, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                          text=True) as process:
        most, read = 0, 0
        while process.poll() is None:
            try:
                anonymous = re.search(r"RssAnon:\s+(\d+) kB", Path(f"/proc/{process.pid}/status").read_text())
                most = max(most, 1024 * int(anonymous.group(1)) if anonymous else 0)
                read = max(read, int(re.search(r"rchar: (\d+)", Path(f"/proc/{process.pid}/io").read_text()).group(1)))
            except OSError:
                pass
            time.sleep(0.0005)
        assert process.returncode == 0, process.stderr.read()
    return most, read


@pytest.mark.parametrize("dump", ["long", "half"])
@pytest.mark.parametrize("verb, method", [("replay", "uniform"), ("replay", "multiscale{tile=16}"), ("reconstruct", "box"), ("reconstruct", "gaussian"),
                                          ("reconstruct", "directional"), ("reconstruct", "multistage")])
def test_a_recording_larger_than_memory_is_read_block_by_block(long_recording, tmp_path, dump, verb, method):
    """The same bytes as in place, memory as it was given, and each pass over the samples reads them once."""
    recording = long_recording / f"{dump}.spool"
    size = (long_recording / "long.spool").stat().st_size  # of the samples as they are used
    arguments = command(verb, recording, method, tmp_path)
    arguments[arguments.index("--spp") + 1] = "200"
    arguments[-1] = str(tmp_path / "in_place.exr")
    watched(arguments, 1 << 40)
    arguments[-1] = str(tmp_path / "in_blocks.exr")
    anonymous, read = watched(arguments, size / 8)
    print(f"{anonymous / 1e6:.1f} MB taken of {size / 8e6:.1f} MB, {read / recording.stat().st_size:.2f} times the file read")
    assert anonymous < 1.1 * size / 8 + 4e6  # program and libraries
    # multistage works on bands of rows, two at a time, each with a row of its neighbours: a block is read for up to three of them.
    assert read < (8 if method == "multistage" else 3) * recording.stat().st_size
    assert (tmp_path / "in_blocks.exr").read_bytes() == (tmp_path / "in_place.exr").read_bytes()
