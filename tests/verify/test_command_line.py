"""verify.py as a program: its exit codes are what a script goes by."""
import os
import subprocess
import sys

import numpy as np
import pytest

import spool
from conftest import ROOT

VERIFY = os.path.join(ROOT, "dumps", "verify", "verify.py")


def run(*arguments, python=(), script=VERIFY):
    return subprocess.run([sys.executable, *python, script, *map(str, arguments)], capture_output=True, text=True)


def one_line(text, name="verify"):
    assert text.count("\n") == 1 and text.startswith(name + ": "), text
    return text


@pytest.mark.parametrize("name", ["verify", "compare"])
def test_a_python_without_numpy_is_one_line_and_not_a_claim_that_fails(name):
    done = run("nowhere.spool", "other.spool", python=("-S", "-E"), script=VERIFY.replace("verify.py", name + ".py"))
    assert done.returncode == 3 and "no numpy, which reads a recording: apt-get install python3-numpy" in one_line(done.stderr, name)


@pytest.mark.parametrize("arguments, words", [((), "required: recording"), (("a", "--nope"), "unrecognized arguments: --nope")])
def test_wrong_use_is_one_line(arguments, words):
    done = run(*arguments)
    assert done.returncode == 2 and words in one_line(done.stderr) and done.stdout == ""


def test_help_names_the_exit_codes_and_a_claim_that_fails_is_1(tmp_path):
    assert "Exit codes: 0 no claim fails, 1 a claim fails" in run("--help").stdout
    with spool.Writer(tmp_path / "same.spool", 16, 16, 16, {"radiance": ("f4", "RGB")}) as writer:
        writer.write_passes(0, {"radiance": np.full((16, 16, 16, 3), 0.5, "f4")})
    done = run(tmp_path / "same.spool")
    assert done.returncode == 1 and "samples differ" in done.stdout


def test_an_error_nobody_expected_is_no_claim_that_fails(tmp_path, monkeypatch, capsys):
    from dumps.verify import verify
    monkeypatch.setattr(verify, "verify", lambda path: np.empty(1 << 55))
    monkeypatch.setattr(sys, "argv", ["verify.py", str(tmp_path / "big.spool")])
    assert verify.main() == 3
    told = one_line(capsys.readouterr().err)
    assert "big.spool: the samples could not be tested: " in told and "emory" in told


@pytest.mark.parametrize("harm", ["film", "reference_variance"])
def test_what_no_number_can_be_given_for_fails_and_is_kept(tmp_path, harm, monkeypatch):
    for module in ("save", "writer"):
        monkeypatch.setattr(f"spool.{module}.check_judges", lambda *_: None)  # as a writer that does not look has it
    rng = np.random.default_rng(1)
    layers = {"film": rng.random((8, 8, 16, 2)).astype("f4"), "reference": rng.random((8, 8, 3)).astype("f4"),
              "reference_variance": np.full((8, 8, 3), 0.01, "f4")}
    layers[harm][0, 0] = np.nan
    spool.write(tmp_path / "odd.spool", rng.random((8, 8, 16, 3)).astype("f4"), sample_order="exchangeable", **layers)
    done = run(tmp_path / "odd.spool", "--write")
    assert done.returncode == 1 and "FAILS" in done.stdout and "= nan" not in done.stdout, done.stdout + done.stderr
    assert {"film": "are not finite", "reference_variance": "reference variance finite"}[harm] in done.stdout
    with spool.open(tmp_path / "odd.spool") as dump:
        assert dump.meta["verification"]["holds"] is False
