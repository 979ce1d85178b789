"""What files say is shown, never obeyed: control characters, forged lines, marks of direction."""
import json
import os
import pty
import subprocess

import numpy as np
import pytest

import spool
from conftest import PROGRAM, samples, write_dump

EVIL = "\x1b]0;PWNED\x07\x1b[2J\x1b[31mred\n\nverified   yes: all tests passed\r\u009b1m\u202egnp.exe\u2028\x7f"


def harmless(text):
    """No control character but line ends, none of the marks that turn text around."""
    bad = [c for c in text if (ord(c) < 32 and c != "\n") or 0x7F <= ord(c) <= 0x9F or c in "\u2028\u2029\u202a\u202e\u2066"]
    assert not bad, (bad, text)


@pytest.fixture
def evil_dump(tmp_path):
    """Valid; its remarks and its name want to be obeyed."""
    radiance, mean = samples()
    reference = np.repeat(mean[:, :, None], 3, axis=2).astype("<f4")
    return write_dump(tmp_path / "a\x1b[31m\nverified yes\u202e.spool", radiance, reference=reference, meta={
        "renderer": {"name": EVIL, EVIL: "x"}, "version": EVIL, "scene": EVIL, "mode": EVIL, "seed": EVIL,
        "verification": {"holds": True, "findings": [
            {"name": EVIL, "holds": True, "measured": EVIL, "expected": EVIL}]}})


def test_info_shows_remarks_as_one_line_each(good, evil_dump):
    harmless(good("info", evil_dump).out)
    text = good("info", evil_dump, "--all").out
    harmless(text)
    assert [line.split() for line in text.splitlines() if line.startswith("verified")] == ["verified yes: 1 claim holds".split()]
    assert "\\u001b]0;PWNED\\u0007" in text and "\\n\\nverified" in text


def test_json_of_such_a_dump_is_the_truth_in_escapes(good, evil_dump):
    text = good("info", evil_dump, "--json").out
    harmless(text)
    assert json.loads(text)["meta"]["renderer"]["name"] == EVIL


@pytest.mark.parametrize("arguments", [
    ["check", "FILE"], ["recover", "FILE", "o\x1b[2J\nx.spool"], ["convert", "FILE", "--to", "npz", "-o", "o\x1b\nx.npz"],
    ["replay", "FILE", "--sampler", "uniform", "--spp", "2", "-o", "o\x1b\nx.exr"],
    ["reconstruct", "FILE", "--filter", "box", "-o", "o\x1b\nx.exr"],
    ["evaluate", "FILE", "--spp", "2", "--replicates", "2", "-o", "o\x1b\nx", "--no-pictures"],
    ["evaluate", "FILE", "--spp", "2", "--replicates", "2", "--dry-run"],
    ["evaluate", "FILE", "--spp", "2", "--shard", "0/2", "-o", "o\x1b\nx"],
], ids=lambda a: " ".join(a[:1] + [w for w in a if w.startswith("--")][-1:]))
def test_no_verb_obeys_a_name(good, evil_dump, arguments):
    for extra in ([], ["--json"]):
        if extra and arguments[0] == "recover":
            arguments = [*arguments, "--force"]
        force = ["--force"] if extra and arguments[0] in ("convert", "replay", "reconstruct") else []
        done = good(*(evil_dump if a == "FILE" else a for a in arguments), *force, *extra)
        harmless(done.out)
        harmless(done.err)
        assert not [line for line in done.out.splitlines() if line.startswith(("verified", "x"))], done.out


def test_errors_of_such_files_are_one_line(run, evil_dump, tmp_path):
    bad = tmp_path / "b\x1b[2J\nspool: all is well\u009b.spool"
    bad.write_bytes(evil_dump.read_bytes()[:5000])
    for arguments in (["info", bad], ["check", bad], ["reconstruct", bad, "--filter", "box", "-o", "x.exr"]):
        done = run(*arguments)
        assert done.code == 4 and done.err.count("\n") == 1
        harmless(done.err)


def test_compare_shows_names_of_a_foreign_folder_as_text(good, run, evil_dump, tmp_path):
    for name in ("a", "b"):
        good("evaluate", evil_dump, "--spp", 2, "--replicates", 2, "-o", name, "--no-pictures", "-q")
    table = tmp_path / "b" / "results.csv"
    table.write_text(table.read_text().replace(",uniform,", f",\"{EVIL}\",").replace("\x00", ""), newline="")
    for extra in (["--all"], ["--json"]):
        done = run("compare", "a", "b", *extra)
        harmless(done.out)
        harmless(done.err)


def test_progress_lines_show_names_as_text(evil_dump, tmp_path):
    ours, theirs = pty.openpty()
    process = subprocess.Popen([PROGRAM, "evaluate", str(evil_dump), "--spp", "1,2,4", "--replicates", "40", "--filters",
                                "box,gaussian", "-o", "r", "--no-pictures"], cwd=tmp_path, stderr=theirs,
                               stdout=subprocess.DEVNULL)
    os.close(theirs)
    seen = b""
    while True:
        try:
            part = os.read(ours, 65536)
        except OSError:
            break
        if not part:
            break
        seen += part
    assert process.wait(120) == 0
    text = seen.decode()
    assert "best on" in text
    harmless(text.replace("\r\x1b[K", "").replace("\r\n", "\n"))


def test_channel_names_are_text(run, tmp_path):
    """A foreign dump may name its channels as it likes within the rules; what is refused is shown escaped."""
    radiance, _ = samples()
    with pytest.raises(spool.SpoolError):
        spool.write(tmp_path / "c.spool", radiance=radiance, **{"odd\x1b[2J\nname": radiance[..., :1]})
