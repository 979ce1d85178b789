"""How runs end: exit codes, last words, signals, full disks; and that nothing but answers is left."""
import json
import os
import resource
import signal
import subprocess
import time

import numpy as np
import pytest

import spool
from conftest import PROGRAM, samples, write_dump
from results_comparison import cell_lines

NO_UTF8 = b"x\xff\xfe.spool"


@pytest.fixture
def dump_of_bytes(tmp_path):
    """A sound dump whose name is not UTF-8, as bytes."""
    radiance, mean = samples()
    reference = np.repeat(mean[:, :, None], 3, axis=2).astype("<f4")
    plain = write_dump(tmp_path / "plain.spool", radiance, reference=reference)
    path = os.path.join(os.fsencode(tmp_path), NO_UTF8)
    os.rename(plain, path)
    return path


def bounded_files(size):
    """For subprocess: files of at most so many bytes, as on a disk that is full."""
    def limit():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))
    return {"preexec_fn": limit, "restore_signals": False}


VERBS = {
    "info": ["info", "DUMP"],
    "info --json": ["info", "DUMP", "--json"],
    "check": ["check", "DUMP"],
    "recover": ["recover", "DUMP", "saved.spool"],
    "synth": ["synth", "scene_s", "--size", "8", "--samples", "2", "-o", "s.spool"],
    "replay": ["replay", "DUMP", "--sampler", "uniform", "--spp", "2", "-o", "n.exr"],
    "reconstruct": ["reconstruct", "DUMP", "--filter", "box", "-o", "b.exr"],
    "convert": ["convert", "DUMP", "--to", "npz", "-o", "d.npz"],
    "evaluate": ["evaluate", "DUMP", "--spp", "2", "--replicates", "2", "-o", "r", "--no-pictures"],
    "dry run": ["evaluate", "DUMP", "--spp", "2", "--replicates", "2", "--dry-run"],
    "list": ["list", "samplers"],
    "list --json": ["list", "columns", "--json"],
    "help": ["--help"],
    "version": ["--version"],
}


@pytest.mark.parametrize("verb", VERBS)
@pytest.mark.parametrize("sink", ["full", "closed"])
def test_output_that_does_not_arrive_is_a_failure(tmp_path, dump, verb, sink):
    arguments = [PROGRAM, *(str(dump) if a == "DUMP" else a for a in VERBS[verb])]
    with open("/dev/full", "w") as full:
        done = subprocess.run(arguments, cwd=tmp_path, stdout=full, stderr=subprocess.PIPE, text=True, timeout=120,
                              preexec_fn=(lambda: os.close(1)) if sink == "closed" else None)
    assert done.returncode == 3 and done.stderr.count("\n") == 1 and "stdout" in done.stderr, done.stderr


@pytest.mark.parametrize("arguments, code", [(["info", "nope"], 3), (["inof"], 2), (["info", "DUMP"], 0)])
@pytest.mark.parametrize("sink", ["full", "closed"])
def test_a_stderr_that_takes_nothing_changes_no_exit_code(tmp_path, dump, arguments, code, sink):
    with open("/dev/full", "w") as full:
        done = subprocess.run([PROGRAM, *(str(dump) if a == "DUMP" else a for a in arguments)], cwd=tmp_path,
                              stdout=subprocess.PIPE, stderr=full, timeout=60,
                              preexec_fn=(lambda: os.close(2)) if sink == "closed" else None)
    assert done.returncode == code


def test_a_file_that_is_written_does_not_become_stderr(tmp_path, dump):
    """With descriptor 2 closed, the next file that is opened would get its number."""
    whole = subprocess.run([PROGRAM, "replay", str(dump), "--sampler", "uniform", "--spp", "2", "-o", "n.exr"],
                           cwd=tmp_path, stdout=subprocess.DEVNULL, timeout=60, preexec_fn=lambda: (os.close(0), os.close(2)))
    assert whole.returncode == 0
    assert (tmp_path / "n.exr").read_bytes()[:4] == b"\x76\x2f\x31\x01"


# Every verb that prints JSON of a dump, with the place of the name in what it prints.
JSON_VERBS = [["info", "FILE"], ["check", "FILE"], ["recover", "FILE", "saved.spool"],
              ["replay", "FILE", "--sampler", "uniform", "--spp", "2", "-o", "OUT"],
              ["reconstruct", "FILE", "--filter", "box", "-o", "OUT"],
              ["convert", "FILE", "--to", "npz", "-o", "OUT"],
              ["evaluate", "FILE", "--spp", "2", "--replicates", "2", "--no-pictures", "-o", "results"],
              ["evaluate", "FILE", "--spp", "2", "--replicates", "2", "--dry-run"]]


@pytest.mark.parametrize("arguments", JSON_VERBS, ids=lambda a: " ".join(a[:1] + a[-1:]))
@pytest.mark.parametrize("as_json", [True, False])
def test_names_that_are_not_utf_8_are_escaped(tmp_path, dump_of_bytes, arguments, as_json):
    words = [dump_of_bytes if a == "FILE" else b"o\xff.out" if a == "OUT" else a.encode() for a in arguments]
    done = subprocess.run([PROGRAM.encode(), *words, *([b"--json"] if as_json else [])], cwd=tmp_path,
                          capture_output=True, timeout=120)
    assert done.returncode == 0 and done.stderr == b"", done.stderr
    text = done.stdout.decode("utf-8")
    if as_json:
        json.loads(text)
    if arguments[0] in ("info", "check"):
        assert ("x\\\\xff\\\\xfe" if as_json else "x\\xff\\xfe") in text


def test_the_plan_of_such_a_dump_can_be_read_again(tmp_path, dump_of_bytes):
    def evaluate(what):
        return subprocess.run([PROGRAM.encode(), b"evaluate", what, b"-o", b"results", b"--no-pictures", b"-q"],
                              cwd=tmp_path, capture_output=True, timeout=120)
    first = subprocess.run([PROGRAM.encode(), b"evaluate", dump_of_bytes, b"--spp", b"2", b"--replicates", b"2", b"-o",
                            b"results", b"--no-pictures", b"-q"], cwd=tmp_path, capture_output=True, timeout=120)
    assert first.returncode == 0, first.stderr
    plan = (tmp_path / "results" / "plan.toml").read_text(encoding="utf-8")
    assert "%FF%FE" in plan
    cells = cell_lines(tmp_path / "results")
    again = evaluate(b"results/plan.toml")
    assert again.returncode == 0, again.stderr
    assert cell_lines(tmp_path / "results") == cells


def test_the_plan_of_methods_of_such_names_can_be_read_again(dump, tmp_path):
    def call(*words):
        done = subprocess.run([PROGRAM.encode(), *words], cwd=tmp_path, capture_output=True, timeout=120)
        assert done.returncode == 0, done.stderr
    bytes_of_dump = str(dump).encode()
    call(b"replay", bytes_of_dump, b"--sampler", b"uniform", b"--spp", b"2", b"-o", b"n\xff %41.exr")
    call(b"reconstruct", bytes_of_dump, b"--filter", b"box", b"-o", b"file:i.exr")
    command = b"exec:cp $1 $2 # \xff"
    call(b"evaluate", bytes_of_dump, b"--samplers", b"uniform,counts:n\xff %41.exr", b"--filters", b"box,image:file:i.exr," + command,
         b"--spp", b"2", b"--replicates", b"2", b"-o", b"a", b"--no-pictures", b"-q")
    call(b"evaluate", b"a/plan.toml", b"-o", b"b", b"--no-pictures", b"-q")
    assert (tmp_path / "a" / "plan.toml").read_text(encoding="utf-8") == (tmp_path / "b" / "plan.toml").read_text()
    names = [{row.split(b",")[1] + row.split(b",")[2] for row in (tmp_path / folder / "results.csv").read_bytes().splitlines()}
             for folder in "ab"]
    assert names[0] == names[1] and len(names[0]) == 7


@pytest.mark.parametrize("seed", ["-1", "99999999999999999999", "1.5", "x"])
def test_seeds_are_numbers_that_a_plan_can_hold(run, dump, tmp_path, seed):
    for arguments in (["synth", "scene_s", f"--seed={seed}", "-o", "s.spool"],
                      ["replay", dump, "--sampler", "uniform", "--spp", 2, f"--seed={seed}", "-o", "n.exr"],
                      ["evaluate", dump, "--spp", 2, f"--seed={seed}", "-o", "r"]):
        run(*arguments).failed_with(2, "seed", seed)
    (tmp_path / "p.toml").write_text(f'recordings = ["scene.spool"]\nspp = [2]\nsamplers = ["uniform"]\n'
                                     f'filters = ["box"]\nseed = {seed if seed != "x" else chr(34) + "x" + chr(34)}\n')
    run("evaluate", "p.toml", "--dry-run").failed_with(2, "p.toml")


def test_a_large_seed_comes_back_from_the_plan(good, dump, tmp_path):
    good("evaluate", dump, "--spp", 2, "--seed", 2**62, "--replicates", 2, "--no-pictures", "-o", "r")
    good("evaluate", "r/plan.toml", "-o", "r", "--no-pictures")
    assert len(cell_lines(tmp_path / "r")) == 2


def test_plans_that_are_no_files_or_far_too_large_get_an_answer_at_once(run, dump, tmp_path):
    begin = time.monotonic()
    os.mkfifo(tmp_path / "fifo.toml")
    run("evaluate", "fifo.toml", "--dry-run").failed_with(2, "fifo.toml", "regular file")
    methods = 'samplers = ["uniform"]\nfilters = ["box"]\nrecordings = ["scene.spool"]\n'
    budgets = ", ".join(f"{1 + i * 1e-5:.5f}" for i in range(300000))
    (tmp_path / "many.toml").write_text(f"{methods}spp = [{budgets}]\n")
    run("evaluate", "many.toml", "--dry-run").failed_with(2, "many.toml:4", "300000 budgets")
    values = ", ".join(str(0.001 * i) for i in range(1, 1000))
    swept = f"[[filter]]\nname = 'nl_means'\nk = [{values}]\nalpha = [{values}]\n"
    (tmp_path / "swept.toml").write_text(methods.replace('filters = ["box"]\n', "") + "spp = [2]\n" + swept)
    run("evaluate", "swept.toml", "--dry-run").failed_with(2, "swept.toml")
    with open(tmp_path / "huge.toml", "w") as file:
        file.truncate(64 << 20)
    run("evaluate", "huge.toml", "--dry-run").failed_with(2, "huge.toml", "MiB")
    assert time.monotonic() - begin < 20


def test_a_png_is_a_png_or_refused(good, run, dump, tmp_path):
    good("reconstruct", dump, "--filter", "box", "-o", "x.png")
    good("reconstruct", dump, "--filter", "box", "-o", "x.exr", "--pictures", "pictures")
    assert (tmp_path / "x.png").read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    assert (tmp_path / "x.exr").read_bytes()[:4] == b"\x76\x2f\x31\x01"
    import OpenImageIO
    picture = OpenImageIO.ImageBuf(str(tmp_path / "x.png"))
    assert (picture.spec().width, picture.spec().height, picture.spec().nchannels) == (24, 20, 3)
    mean = spool.open(dump).read("radiance").mean(axis=2)
    reference = spool.open(dump).pixel("reference").astype(float)
    luminance = reference @ [0.2126, 0.7152, 0.0722]
    exposed = np.clip(mean * 0.18 / np.exp(np.mean(np.log(luminance + 1e-4))), 0, 1)
    encoded = np.where(exposed <= 0.0031308, 12.92 * exposed, 1.055 * exposed ** (1 / 2.4) - 0.055)
    assert np.abs(picture.get_pixels("float") - encoded).max() < 1.5 / 255
    run("reconstruct", dump, "--filter", "box", "--layers", "-o", "y.png").failed_with(2, "y.png", "layers")
    run("reconstruct", dump, "--filter", "box", "-o", "y.JPG").failed_with(2, "y.JPG", ".exr")
    run("replay", dump, "--sampler", "uniform", "--spp", 2, "-o", "n.png").failed_with(2, "n.png", ".exr")
    run("metrics", "x.exr", "x.exr", "--error-map", "e.tiff").failed_with(2, "e.tiff", ".exr")


def test_pictures_of_no_views_are_said_to_be_none(run, dump):
    run("replay", dump, "--sampler", "uniform", "--spp", 2, "-o", "n.exr", "--pictures", "p").failed_with(2, "--views")


def test_recover_ends_with_4_wherever_samples_are_gone(run, dump, tmp_path):
    """Also where the cut fell between two records, which leaves no trace of damage."""
    data = dump.read_bytes()
    first = data.index(b"DATA") // 64 * 64
    codes = set()
    for size in range(first, len(data), 64 * 5):
        (tmp_path / "cut.spool").write_bytes(data[:size])
        finished = run("recover", "cut.spool", "saved.spool", "--force")
        whole = run("check", "saved.spool").code == 0
        assert finished.code == (0 if whole else 4), (size, finished.err)
        codes.add(finished.code)
    (tmp_path / "cut.spool").write_bytes(data[:first])
    run("recover", "cut.spool", "saved.spool", "--force").failed_with(4, "0 of 16 blocks kept", "cut off")
    assert codes <= {0, 4} and 4 in codes


def started(process, path):
    deadline = time.monotonic() + 60
    while process.poll() is None and not list(path.glob("*.partial")):
        assert time.monotonic() < deadline
        time.sleep(0.01)


@pytest.fixture(scope="session")
def archive(tmp_path_factory):
    path = tmp_path_factory.mktemp("npz") / "a.npz"
    np.savez(path, radiance=np.ones((256, 256, 64, 3), "f4"))
    return path


LONG = {"synth": ["synth", "heavy_tail", "--size", "512", "--samples", "256", "-o", "out/big.spool"],
        "pack": ["pack", "--from", "npz", "ARCHIVE", "--set", "import.layout=HWSC", "--compress", "-o", "out/big.spool"]}
SHORT = {"synth": ["synth", "heavy_tail", "--size", "64", "--samples", "16", "-o", "out/big.spool"],
         "pack": ["pack", "--from", "npz", "ARCHIVE", "--set", "import.layout=HWSC", "-o", "out/big.spool"]}


@pytest.mark.parametrize("verb", LONG)
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT])
def test_an_interrupted_dump_leaves_nothing_and_says_so(tmp_path, archive, verb, number):
    (tmp_path / "out").mkdir()
    command = [PROGRAM, *(str(archive) if a == "ARCHIVE" else a for a in LONG[verb])]
    process = subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
    started(process, tmp_path / "out")
    process.send_signal(number)
    error = process.communicate(timeout=30)[1]
    assert process.returncode == 128 + number, error
    assert error.count("\n") == 1 and "nothing is kept of" in error and "big.spool" in error
    assert not list((tmp_path / "out").iterdir())


@pytest.mark.parametrize("verb", SHORT)
def test_a_dump_that_found_the_disk_full_can_be_made_by_the_same_command(run, tmp_path, archive, verb):
    (tmp_path / "out").mkdir()
    command = [str(archive) if a == "ARCHIVE" else a for a in SHORT[verb]]
    full = run(*command, **bounded_files(100_000))
    full.failed_with(3, "free some space")
    assert not list((tmp_path / "out").iterdir()), "nothing stands in the way"
    assert run(*command).code == 0
    assert run("check", "out/big.spool").code == 0


@pytest.mark.parametrize("arguments", [
    ["replay", "DUMP", "--sampler", "uniform", "--spp", "2", "-o", "out/n.exr"],
    ["reconstruct", "DUMP", "--filter", "box", "-o", "out/b.exr"],
    ["reconstruct", "DUMP", "--filter", "box", "-o", "out/b.png"],
    ["convert", "DUMP", "--to", "npz", "-o", "out/d.npz"],
    ["convert", "DUMP", "--to", "deep-exr", "-o", "out/d.exr"],
    ["convert", "DUMP", "--to", "bcd", "-o", "out/d"],
    ["recover", "DUMP", "out/d.spool"],
    ["evaluate", "DUMP", "--spp", "2", "--replicates", "2", "-o", "out/r", "--no-pictures"],
], ids=" ".join)
def test_a_full_disk_leaves_no_half_file_of_any_verb(run, dump, tmp_path, arguments):
    (tmp_path / "out").mkdir()
    command = [str(dump) if a == "DUMP" else a for a in arguments]
    finished = run(*command, **bounded_files(200))
    assert finished.code == 3 and finished.err.count("\n") == 1, finished.err
    assert not [p for p in (tmp_path / "out").rglob("*") if p.is_file()]
    assert run(*command).code == 0


def test_an_export_onto_a_full_disk_is_an_error_of_the_disk(run, dump):
    command = ["evaluate", dump, "--spp", 2, "--replicates", 2, "--export-inputs", "inputs"]
    run(*command, **bounded_files(4000)).failed_with(3, "--export-inputs: ")
    assert run(*command).code == 0


def test_devices_are_not_replaced(run, tmp_path):
    """A --force that renames a file onto /dev/null would break the machine."""
    os.mkfifo(tmp_path / "pipe.spool")
    run("synth", "scene_s", "--size", 8, "--samples", 2, "--force", "-o", "pipe.spool").failed_with(2, "pipe.spool")
    os.mkfifo(tmp_path / "n.npz")
    run("synth", "scene_s", "--size", 8, "--samples", 2, "-o", "s.spool")
    run("convert", "s.spool", "--to", "npz", "--force", "-o", "n.npz").failed_with(2, "n.npz")
    assert (tmp_path / "n.npz").is_fifo() and (tmp_path / "pipe.spool").is_fifo()


def test_error_lines_have_an_end(run, dump, tmp_path):
    long = "n" * 60000
    finished = run("replay", dump, "--sampler", long, "--spp", 2, "-o", "n.exr")
    assert finished.code == 2 and len(finished.err) < 5000 and "bytes ..." in finished.err


def test_an_import_of_a_file_that_is_none_does_not_show_its_bytes(run, tmp_path):
    (tmp_path / "secret.bin").write_bytes(b"root:x:0:0:" + bytes(200))
    (tmp_path / "list.txt").write_text("secret.bin\n")
    finished = run("pack", "--from", "sbmc", "list.txt", "-o", "o.spool")
    finished.failed_with(1, "secret.bin", "version")
    assert str(int.from_bytes(b"root", "little")) not in finished.err
