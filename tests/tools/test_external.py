"""Samplers and filters outside the program: counts:, image:, exec:. The examples of the docs run."""
import csv
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from conftest import LONGEST_RUN, PROGRAM, write_dump
from spool import exr

DOCS = Path(__file__).resolve().parents[2] / "docs" / "own_methods.md"


@pytest.fixture
def script(tmp_path):
    """Writes a script; the command that runs it."""
    def write(name, text):
        (tmp_path / name).write_text(text)
        return f"exec:{sys.executable} {tmp_path / name}"
    return write


@pytest.fixture
def example(script):
    def of_docs(name):
        block = re.search(rf"```python\n(# {re.escape(name)}:.*?)```", DOCS.read_text(), re.S).group(1)
        return script(name, block)
    return of_docs


def answer(expression):
    """A sampler or filter in two lines: `image` is what it was given."""
    return ("import os, sys, numpy as np\nfrom spool import exr\nimage = exr.read(sys.argv[1])\n"
            f"exr.write(sys.argv[2], {expression})\n")


def replay(run, dump, sampler, *options, spp=6):
    return run("replay", dump, "--sampler", sampler, "--spp", spp, "-o", "s.exr", "--json", "--force", *options)


def counts(tmp_path, name="s.exr"):
    return exr.read(tmp_path / name)["n"].astype(int)


def test_the_sampler_of_the_docs_has_20_lines_and_beats_uniform_sampling(good, example, dump, tmp_path):
    lines = [line for line in DOCS.read_text().split("```python\n")[1].split("```")[0].splitlines()
             if line.strip() and not line.startswith("#")]
    assert len(lines) <= 20
    command = example("most_uncertain.py")
    random = np.random.default_rng(5)
    noise = random.normal(0, np.where(np.arange(24) < 16, 0.02, 1.0)[None, :, None, None], (20, 24, 32, 3))
    noisy = write_dump(tmp_path / "noisy.spool", (1 + noise).astype("<f4"), reference=np.ones((20, 24, 3), "f4"))
    replay(good, noisy, command)
    n = counts(tmp_path)
    assert n.sum() == 6 * n.size and n.min() >= 2 and n[:, 18:].mean() > 3 * n[:, :14].mean()
    good("evaluate", noisy, "--samplers", f"uniform,{command}", "--filters", "box", "--spp", 6,
         "--replicates", 2, "--no-pictures", "-o", "results")
    with open(tmp_path / "results" / "results.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    error = {name: [float(row["mse"]) for row in rows if row["sampler"] == name] for name in ("uniform", "most_uncertain")}
    assert len(error["most_uncertain"]) == 2 and sum(error["most_uncertain"]) < 0.7 * sum(error["uniform"])


def test_the_filter_of_the_docs(good, example, dump, tmp_path):
    good("reconstruct", dump, "--filter", example("median.py"), "--spp", 4, "-o", "m.exr")
    good("reconstruct", dump, "--filter", "box", "--spp", 4, "-o", "b.exr")
    box, median = exr.read(tmp_path / "b.exr"), exr.read(tmp_path / "m.exr")
    assert median["R"].shape == (20, 24)
    window = [box["R"][y:y + 3, x:x + 3] for y, x in ((4, 5), (10, 11))]
    assert np.allclose([median["R"][5, 6], median["R"][11, 12]], [np.median(w) for w in window])


def test_the_wrapper_of_open_image_denoise_hands_it_images_and_guides(good, example, tmp_path):
    # A stand-in for the library, beside the script: it says what it was given.
    (tmp_path / "pyoidn.py").write_text(
        "import numpy as np\n"
        "def denoise(color, hdr, albedo, normal):\n"
        "    assert hdr and all(i.shape == (64, 64, 3) and i.dtype == np.float32 for i in (color, albedo, normal))\n"
        "    assert 0 <= albedo.min() and albedo.max() <= 1 and normal.min() < 0\n"
        "    return 2 * color\n")
    chess = Path(__file__).resolve().parents[2] / "dumps" / "tiny" / "chess.spool"
    good("reconstruct", chess, "--filter", example("oidn.py"), "--set", "filter.features=on", "--spp", 4, "-o", "o.exr")
    good("reconstruct", chess, "--filter", "box", "--spp", 4, "-o", "b.exr")
    box, filtered = exr.read(tmp_path / "b.exr"), exr.read(tmp_path / "o.exr")
    assert np.allclose(filtered["G"], 2 * box["G"], rtol=1e-6)


def test_statistics_say_what_was_taken(good, script, dump, tmp_path):
    seen = tmp_path / "seen.exr"
    command = script("s.py", answer("{'n': np.full(image['n'].shape, 2, 'u4')}")
                     + f"import shutil; shutil.copy(sys.argv[1], {str(seen)!r})\n")
    replay(good, dump, command, "--set", "sampler.init_spp=3", "--set", "sampler.rounds=1", spp=5)
    image = exr.read(seen)
    assert set(image) == {"R", "G", "B", "variance.R", "variance.G", "variance.B", "n", "left"}
    assert (image["n"] == 3).all() and (image["left"] == 13).all()
    good("reconstruct", dump, "--filter", "box", "--spp", 3, "--layers", "-o", "b.exr")
    box = exr.read(tmp_path / "b.exr")
    for name in ("R", "G", "B", "variance.R"):
        assert np.array_equal(image[name], box[name]), name
    assert (counts(tmp_path) == 5).all()


def test_start_and_files_are_told_apart_from_the_work(good, script, dump, tmp_path):
    command = script("slow.py", """
import sys, time
from spool import exr
time.sleep(0.4)  # as imports do
image = exr.read(sys.argv[1])
time.sleep(0.3)
t = time.process_time()
while time.process_time() - t < 0.2: pass
exr.write(sys.argv[2], {c: image[c] for c in "RGB"})
""")
    text = good("evaluate", dump, "--filters", command, "--spp", 4, "--replicates", 1, "-o", "out", "--no-pictures").out
    with open(tmp_path / "out" / "results.csv", newline="") as file:
        row = next(csv.DictReader(file))
    exchange, filtering, cpu = (float(row[name]) for name in ("seconds_exchange", "seconds_filtering", "cpu_filtering"))
    assert exchange >= 0.4 and filtering - exchange >= 0.5
    assert cpu >= 0.2  # the command's own counts
    assert "to start and for files" in text


def test_rounds_are_told_apart_and_the_budget_is_kept(good, script, dump, tmp_path):
    log = tmp_path / "log"
    command = script("s.py", answer("{'n': np.full(image['n'].shape, 3, 'u4')}")
                     + f"print(*(os.environ['SPOOL_' + k] for k in ('ROUND', 'ROUNDS', 'LEFT', 'SHARE', 'SEED')),"
                       f" file=open({str(log)!r}, 'a'))\n")
    said = replay(good, dump, command, "--set", "sampler.rounds=3", "--seed", 7).json
    pixels = 24 * 20
    assert log.read_text().split("\n")[:-1] == [f"0 3 {4 * pixels} {(4 * pixels + 2) // 3} 7",
                                                f"1 3 {1 * pixels} {(pixels + 1) // 2} 7"]
    assert said["spent"] == 6 * pixels and (counts(tmp_path) == 6).all()


def test_wants_beyond_the_pool_go_to_the_others_and_are_counted(good, script, dump, tmp_path):
    wants = "{'n': np.where(np.arange(24) < 4, 30, np.where(np.arange(24) < 12, 1, 0)).astype('u4')"
    command = script("s.py", answer(wants + " * np.ones((20, 1), 'u4')}"))
    said = replay(good, dump, command, "--set", "sampler.rounds=1").json
    n = counts(tmp_path)
    assert (n[:, :4] == 16).all() and (n[:, 12:] == 2).all()
    assert said["guards"]["want_beyond_pool"] == 80 * 16 and said["saturated_pieces"] == 80
    assert said["spent"] == n.sum() == 6 * n.size  # wanted 2560 of 1920: all of it went to those named
    enough = script("s.py", answer("{'n': np.zeros(image['n'].shape, 'u4')}"))
    said = replay(good, dump, enough).json
    assert said["spent"] == 2 * 480 and said["budget"] == 6 * 480


@pytest.mark.parametrize("text, words", [
    ("import sys; print('no numpy here', file=sys.stderr); sys.exit(3)", ("exit code 3", "no numpy here")),
    ("pass", ("wrote no answer", "last argument")),
    ("import sys; open(sys.argv[2], 'w').write('garbage ' * 50)", ("not an OpenEXR",)),
    ("import sys; open(sys.argv[2], 'wb')", ("answer",)),
    (answer("{'n': np.full((3, 4), 1, 'u4')}"), ("4 x 3 pixels", "24 x 20")),
    (answer("{'n': np.full((20, 24), -1.0)}"), ("-1", "pixel 0, 0")),
    (answer("{'n': np.where(np.eye(20, 24, 5) > 0, .5, 1)}"), ("0.5", "pixel 5, 0")),
    (answer("{'n': np.full((20, 24), np.nan)}"), ("nan", "pixel 0, 0")),
    (answer("{'n': np.full((20, 24), 65537, 'u4')}"), ("65537", "from 0 to 65536")),
    ("import os, signal; os.kill(os.getpid(), signal.SIGSEGV)", ("signal 11",)),
    ("import sys; sys.exit(-1)", ("exit code 255",)),
])
def test_a_sampler_that_goes_wrong_is_one_line(run, script, dump, tmp_path, text, words):
    finished = replay(run, dump, script("bad.py", text))
    finished.failed_with(1, "exec:", "bad.py", *words)
    assert not (tmp_path / "s.exr").exists()


@pytest.mark.parametrize("text, words", [
    ("import sys; sys.exit('what a pity')", ("exit code 1", "what a pity")),
    (answer("{c: image[c][1:] for c in 'RGB'}"), ("24 x 19", "24 x 20")),
    (answer("{'R': image['R'], 'G': image['G']}"), ("R, G, B",)),
    (answer("{c: np.where(image[c] == image[c].max(), np.inf, 1) for c in 'RGB'}"), ("inf", "finite")),
])
def test_a_filter_that_goes_wrong_is_one_line(run, script, dump, text, words):
    run("reconstruct", dump, "--filter", script("bad.py", text), "-o", "i.exr").failed_with(1, "bad.py", *words)


def processes_with(word):
    listing = subprocess.run(["ps", "-eo", "args"], capture_output=True, text=True, check=True).stdout
    return [line for line in listing.splitlines() if line.startswith(word)]


def test_a_command_that_hangs_is_ended_with_all_that_it_started(run, dump, tmp_path):
    begin = time.monotonic()
    word = f"73{os.getpid()}"
    finished = replay(run, dump, f"exec:sleep {word} & sleep {word}; true", "--set", "sampler.timeout=0.3")
    finished.failed_with(1, "no answer within 0.3 s", "timeout")
    assert time.monotonic() - begin < 20 and not processes_with(f"sleep {word}")


def test_an_interrupt_ends_the_command_and_leaves_nothing(dump, tmp_path):
    word = f"74{os.getpid()}"
    (tmp_path / "tmp").mkdir()
    process = subprocess.Popen([PROGRAM, "replay", dump, "--sampler", f"exec:sleep {word}; true", "--spp", "6", "-o",
                                tmp_path / "s.exr"], env={**os.environ, "TMPDIR": str(tmp_path / "tmp")},
                               stderr=subprocess.PIPE, text=True)
    for _ in range(400):
        if processes_with(f"sleep {word}"):
            break
        time.sleep(0.05)
    assert list((tmp_path / "tmp").iterdir())
    process.send_signal(signal.SIGINT)
    assert process.wait(20) == 128 + signal.SIGINT
    for _ in range(100):
        if not processes_with(f"sleep {word}"):
            break
        time.sleep(0.05)
    assert not processes_with(f"sleep {word}") and not list((tmp_path / "tmp").iterdir())


def wait_until(condition, seconds=20):
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.02)


@pytest.mark.parametrize("number", [signal.SIGHUP, signal.SIGQUIT, signal.SIGTERM, signal.SIGKILL])
def test_no_signal_leaves_a_command_or_a_folder(dump, tmp_path, number):
    """Of SIGKILL the program hears nothing: a guard beside the command ends it."""
    word = f"75{os.getpid()}{number}"
    (tmp_path / "tmp").mkdir()
    process = subprocess.Popen([PROGRAM, "replay", dump, "--sampler", f"exec:sleep {word} & setsid -f true; sleep {word}; true",
                                "--spp", "6", "-o", tmp_path / "s.exr"],
                               env={**os.environ, "TMPDIR": str(tmp_path / "tmp")}, stderr=subprocess.PIPE)
    wait_until(lambda: len(processes_with(f"sleep {word}")) == 2)
    assert list((tmp_path / "tmp").iterdir())
    process.send_signal(number)
    assert process.wait(20) == (-number if number == signal.SIGKILL else 128 + number)
    wait_until(lambda: not processes_with(f"sleep {word}") and not list((tmp_path / "tmp").iterdir()))


def test_a_command_has_no_files_but_its_streams(dump, tmp_path):
    """A pipe whose end another process waits for would not end while the command is there; a process of MPI is handed files on purpose."""
    (tmp_path / "python").write_text("#!/bin/sh\nls /proc/self/fd > files_of_python\n")
    (tmp_path / "python").chmod(0o755)
    ends = os.pipe()
    for words in (["replay", dump, "--sampler", "exec:ls /proc/self/fd > files_of_command; false", "--spp", "6", "-o", "s.exr"],
                  ["evaluate", dump, "--samplers", "uniform", "--filters", "box", "--spp", "6", "--executor", "mpi", "-o", "results"]):
        subprocess.run([PROGRAM, *words], cwd=tmp_path, pass_fds=ends, capture_output=True, timeout=LONGEST_RUN, check=False,
                       env={**os.environ, "SPOOL_PYTHON": str(tmp_path / "python")})
    for end in ends:
        os.close(end)
    files = {name: (tmp_path / f"files_of_{name}").read_text().split() for name in ("command", "python")}
    assert "2" in files["command"] and str(ends[1]) not in files["command"] and str(ends[1]) in files["python"]


def test_without_a_terminal_on_purpose_its_end_is_no_reason_to_stop(dump, tmp_path):
    word = f"76{os.getpid()}"
    process = subprocess.Popen(["nohup", PROGRAM, "replay", dump, "--sampler", f"exec:sleep 1.{word}; false", "--spp", "6", "-o",
                                tmp_path / "s.exr"], stderr=subprocess.PIPE, stdout=subprocess.DEVNULL)
    wait_until(lambda: processes_with(f"sleep 1.{word}"))
    process.send_signal(signal.SIGHUP)
    assert process.wait(30) == 1


def test_what_a_command_prints_takes_no_disk_and_no_time(run, dump, tmp_path):
    (tmp_path / "tmp").mkdir()
    process = subprocess.Popen([PROGRAM, "replay", dump, "--sampler", "exec:yes long-winded >&2; true", "--spp", "6", "-o",
                                tmp_path / "s.exr", "--set", "sampler.timeout=3"],
                               env={**os.environ, "TMPDIR": str(tmp_path / "tmp")}, stderr=subprocess.PIPE)
    largest = 0
    while process.poll() is None:
        largest = max([largest, *(p.stat().st_size for p in (tmp_path / "tmp").rglob("*") if p.is_file() and p.exists())])
        time.sleep(0.05)
    assert process.returncode == 1 and largest < 1 << 20
    words = "head -c 100000000 /dev/zero | tr '\\0' 'x'; echo; head -c 100000 /dev/zero | tr '\\0' 'y'; exit 3"
    finished = replay(run, dump, f"exec:{words}; false")
    assert finished.code == 1 and len(finished.err) < 1000 and "yyy" in finished.err and "xxx" not in finished.err


def test_a_dry_run_runs_no_command_and_says_that_their_time_is_not_known(good, tmp_path, dump):
    touch = tmp_path / "EXECUTED"
    plan = tmp_path / "p.toml"
    plan.write_text(f"""recordings = ["{dump}"]\nspp = [2]\nreplicates = 2\nsamplers = ["uniform", 'exec:touch {touch}; false']
filters = ["box", 'exec:touch {touch}; false']\n""")
    text = good("evaluate", plan, "--dry-run").out
    assert "6 of them run commands" in text and "not known" in text and "the others take about" in text
    told = good("evaluate", plan, "--dry-run", "--json").json
    assert (told["cells"], told["left"], told["left_of_unknown_time"]) == (8, 8, 6)
    text = good("evaluate", dump, "--samplers", f"exec:touch {touch}", "--filters", f"exec:touch {touch}", "--spp", 2, "--replicates", 5,
                "--dry-run").out
    assert "5 of them" in text and "about" not in text
    assert not touch.exists()


def test_counts_are_a_sampler(good, run, dump, tmp_path):
    n = np.fromfunction(lambda y, x: 2 + (x + 3 * y) % 7, (20, 24)).astype("u4")
    exr.write(tmp_path / "mine.exr", {"Y": n.astype("f4")})
    replay(good, dump, "counts:mine.exr", spp=n.sum() / n.size)
    assert np.array_equal(counts(tmp_path), n)
    replay(run, dump, "counts:mine.exr", spp=3).failed_with(1, "counts:mine.exr", "--spp")
    exr.write(tmp_path / "mine.exr", {"n": np.where(np.eye(20, 24) > 0, np.uint32(17), np.uint32(1))}, force=True)
    replay(run, dump, "counts:mine.exr", spp=16).failed_with(1, "counts:mine.exr", "outside 0 .. 16")
    exr.write(tmp_path / "turned.exr", {"n": n.T})
    replay(run, dump, "counts:turned.exr").failed_with(1, "is 20 x 24 counts, the recording 24 x 20 pieces: make it as large")
    replay(run, dump, "counts:none.exr").failed_with(3, "none.exr")
    replay(run, dump, "counts").failed_with(2, "counts:FILE.exr")
    replay(run, dump, "counts:mine.exr", "--set", "counts.x=1").failed_with(2, "x")


def test_a_replayed_selection_is_a_sampler(good, dump, tmp_path):
    good("replay", dump, "--sampler", "multiscale", "--spp", 6, "-o", "a.exr")
    good("replay", dump, "--sampler", "counts:a.exr", "--spp", 6, "-o", "b.exr")
    a, b = exr.read(tmp_path / "a.exr"), exr.read(tmp_path / "b.exr")
    assert set(a) == set(b)
    for name, plane in a.items():
        assert np.array_equal(plane, b[name]), name


def test_an_image_is_a_filter(good, run, dump, tmp_path):
    image = np.random.default_rng(1).random((3, 20, 24)).astype("f4")
    exr.write(tmp_path / "mine.exr", dict(zip("RGB", image)))
    good("reconstruct", dump, "--filter", "image:mine.exr", "-o", "i.exr")
    assert np.array_equal(exr.read(tmp_path / "i.exr")["G"], image[1])
    run("replay", dump, "--sampler", "filtered_halves", "--filter", "image:mine.exr", "--spp", 6, "-o",
        "s.exr").failed_with(2, "image:mine.exr", "gains nothing from it")
    exr.write(tmp_path / "small.exr", {"Y": image[0, 1:]})
    run("reconstruct", dump, "--filter", "image:small.exr", "-o", "j.exr").failed_with(1, "24 x 19", "24 x 20")


def test_an_ensemble_is_the_mean_of_its_parts(good, run, dump, tmp_path):
    def image(name):
        good("reconstruct", dump, "--spp", 8, "--filter", name, "-o", "i.exr", "--force")
        return np.stack([exr.read(tmp_path / "i.exr")[c] for c in "RGB"]).astype(float)
    parts = ["box", "gaussian{sigma=2}", "nl_means"]
    assert np.allclose(image(f"ensemble:{'+'.join(parts)}"), np.mean([image(p) for p in parts], axis=0), rtol=1e-5)
    # By halves: between the parts, nearer to the better one; with 2 samples the mean, which is said.
    halves = ("--set", "ensemble.weights=halves")
    good("evaluate", dump, "--filters", "box,gaussian{sigma=2},ensemble{weights=halves}:box+gaussian{sigma=2}", "--spp", 8, "-o", "out", "--no-pictures")
    with open(tmp_path / "out" / "results.csv", newline="") as file:
        errors = {}
        for row in csv.DictReader(file):
            errors.setdefault(row["filter"], []).append(float(row["mse"]))
    box, blurred, both = (np.mean(errors[name]) for name in ("box", "gaussian{sigma=2}", "ensemble{weights=halves}:box+gaussian{sigma=2}"))
    assert min(box, blurred) * 0.5 < both < 0.5 * (box + blurred)
    few = good("reconstruct", dump, "--spp", 2, "--filter", "ensemble:box+nl_means", *halves, "-o", "few.exr", "--json").json
    assert "needs 3 samples" in few["notes"][0]
    for name, words in (("ensemble:box", "2 to 4"), ("ensemble:box+box+box+box+box", "2 to 4"), ("ensemble:box+bxo", "did you mean 'box'"),
                        ("ensemble:box+ensemble:box+box", "no part"), ("ensemble:box+", "filter"), ("ensemble:", "A+B"),
                        ("ensemble:box+gaussian{sigma=x}", "sigma")):
        run("reconstruct", dump, "--spp", 2, "--filter", name, "-o", "x.exr").failed_with(2, words)


def test_replicates_of_an_image_claim_no_exactness(good, dump, tmp_path):
    exr.write(tmp_path / "mine.exr", {"Y": np.full((20, 24), 0.5, "f4")})
    arguments = ("evaluate", dump, "--filters", "box,image:mine.exr", "--spp", 4, "--reference", "holdout", "--holdout", 4)
    table = good(*arguments, "-o", "five").out
    box, image = (next(line for line in table.splitlines() if f" {name} " in line) for name in ("box", "image:mine.exr"))
    assert "uniform" in box and "better" not in image and "worse" not in image
    assert "one image" in table and "--recorded-order" in table
    entries = {e["filter"]: e for e in good(*arguments, "-o", "json", "--json").json["results"]}
    assert entries["image:mine.exr"]["one_image"] and not entries["box"]["one_image"]
    assert entries["image:mine.exr"]["ranks"]["relmse"]["against_baseline"] == "not compared"
    assert "nothing is compared" in good(*arguments, "-o", "one", "--replicates", 1, "--recorded-order").out


def test_a_filter_for_the_loop_of_a_sampler_without_one_is_an_error(run, dump, tmp_path):
    run("replay", dump, "--sampler", "multiscale", "--filter", "box", "--spp", 4, "-o", "s.exr").failed_with(
        2, "multiscale has no filter in its loop", "leave box out")
    assert not (tmp_path / "s.exr").exists()


def test_an_oracle_in_the_loop_of_a_sampler_is_refused_before_any_work(run, dump, tmp_path):
    words = ("with oracle_scale", "oracle", "leave one")
    beside = "filtered_halves{filter=beside}"
    pair = ["--samplers", f"uniform,{beside}", "--filters", "oracle_scale"]
    run("evaluate", dump, *pair, "--spp", 4, "-o", "r").failed_with(2, *words)
    run("evaluate", dump, *pair, "--spp", 4, "--dry-run").failed_with(2, *words)
    run("replay", dump, "--sampler", "filtered_halves", "--filter", "oracle_scale", "--spp", 4, "-o", "s.exr").failed_with(
        2, *words)
    (tmp_path / "p.toml").write_text(f"""recordings = ["{dump}"]\nspp = [4]\nsamplers = ["{beside}"]
filters = ["oracle_scale"]\n""")
    run("evaluate", "p.toml", "-o", "r").failed_with(2, *words)
    assert not (tmp_path / "r").exists()
    # Beside others, only the cells of the two fail, and say why.
    run("evaluate", dump, "--samplers", f"uniform,{beside}", "--filters", "box,oracle_scale", "--spp", 4,
        "--replicates", 2, "--no-pictures", "-o", "r").failed_with(1, "2 of 8 results failed", *words)
    with open(tmp_path / "r" / "results.csv", newline="") as file:
        failed = [row for row in csv.DictReader(file) if row["error"]]
    assert {(row["sampler"], row["filter"]) for row in failed} == {(beside, "oracle_scale")}


def test_a_sampler_with_a_filter_of_its_own_works_beside_an_oracle(good, run, dump, tmp_path):
    result = good("evaluate", dump, "--samplers", "filtered_halves,cross_halves", "--filters", "oracle_scale", "--spp", 8,
                  "--replicates", 1, "--no-pictures", "-o", "r").out
    assert "filtered_halves" in result and "cross_halves" in result
    for name in ("cross_halves{filter=oracle_scale}", "cross_halves{filter=no_such}"):
        run("evaluate", dump, "--samplers", name, "--filters", "box", "--spp", 4, "-o", "r2").failed_with(
            2, name.split("=")[1][:-1])
    good("replay", dump, "--sampler", "cross_halves", "--spp", 8, "-o", "s.exr")
    image = exr.read(tmp_path / "s.exr")
    assert image["n"].sum() == 8 * image["n"].size
    assert np.array_equal(image["n"], image["even.n"] + image["odd.n"])
    good("reconstruct", dump, "--selection", "s.exr", "--filter", "box", "-o", "box.exr")


def test_an_external_filter_guides_filtered_halves(good, example, dump, tmp_path):
    median = example("median.py")
    good("replay", dump, "--sampler", "filtered_halves", "--filter", median, "--spp", 8, "-o", "s.exr",
         "--set", "sampler.rounds=2")
    n = counts(tmp_path)
    assert n.sum() == 8 * n.size and n.std() > 0.5
    result = good("evaluate", dump, "--samplers", "filtered_halves{rounds=1,filter=beside}", "--filters", f"box,{median}", "--spp",
                  6, "--replicates", 1, "--no-pictures", "-o", "results").out
    assert "median" in result and "median.py" not in result


def test_methods_carry_their_presets_and_options_in_their_names(good, run, dump):
    names = "multiscale:paper,multiscale,multiscale:paper{alpha=0.3,epochs=40},uniform"
    table = good("evaluate", dump, "--samplers", names, "--filters", "directional:paper,box", "--spp", 4,
                 "--replicates", 1, "--no-pictures", "-o", "results").out
    for label in ("multiscale:paper ", "multiscale ", "multiscale:paper{alpha=0.3,epochs=40}", "directional:paper"):
        assert label in table
    run("evaluate", dump, "--samplers", "multiscale:papr", "--spp", 4, "-o", "r2").failed_with(2, "paper")
    run("evaluate", dump, "--samplers", "multiscale{alpha=0.3", "--spp", 4, "-o", "r2").failed_with(2, "brace")
    run("evaluate", dump, "--samplers", "multiscale{alhpa=0.3}", "--spp", 4, "-o", "r2").failed_with(2, "alpha")


def test_features_come_with_the_variances_of_their_means(good, script, tmp_path):
    seen = tmp_path / "seen.exr"
    command = script("f.py", answer("{c: image[c] for c in 'RGB'}") + f"import shutil; shutil.copy(sys.argv[1], {str(seen)!r})\n")
    chess = Path(__file__).resolve().parents[2] / "dumps" / "tiny" / "chess.spool"
    variance = {}
    for spp in (8, 32):
        good("reconstruct", chess, "--filter", command, "--set", "filter.features=on", "--spp", spp, "--force", "-o", "o.exr")
        image = exr.read(seen)
        assert {"albedo.R", "albedo_variance.R", "normal_variance.Y", "depth_variance.Z"} <= set(image)
        variance[spp] = image["albedo_variance.G"].mean()
    good("reconstruct", chess, "--filter", command, "--set", "filter.moments=0.25+1", "--spp", 8, "--force", "-o", "o.exr")
    image = exr.read(seen)
    assert np.allclose(image["mean_1.G"], image["G"], rtol=1e-6) and "albedo.R" not in image
    # The variance of a mean of 8 samples, and roots, whose powers are smaller.
    assert np.allclose(image["m2_1.R"] / 56, image["variance.R"], rtol=1e-3, atol=1e-9)
    assert {f"{m}_0.25.{c}" for m in ("mean", "m2", "m3", "m4") for c in "RGB"} <= set(image)
    assert (image["m4_0.25.B"] * 8 >= image["m2_0.25.B"] ** 2 * 0.999).all()
    assert 3.4 < variance[8] / variance[32] < 4.6  # a fourth with four times the samples
