"""No value that a function is handed ends the process or is taken for something else: each is a SpoolError of one line."""
import inspect
import json
import os
import pathlib
import subprocess
import sys

import pytest

import argument_cases
import spool
from conftest import LONGEST_RUN


@pytest.mark.parametrize("name", argument_cases.FUNCTIONS)
def test_every_parameter(name, tmp_path):
    script = pathlib.Path(argument_cases.__file__)
    done = subprocess.run([sys.executable, script, name], capture_output=True, text=True, timeout=4 * LONGEST_RUN,
                          env={**os.environ, "TMPDIR": str(tmp_path)})
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    assert done.returncode == 0, (lines[-1:], done.returncode, done.stderr[-2000:])
    wrong = []
    for case, answer in zip(lines[::2], lines[1::2]):
        if (answer is None) != case["right"]:
            wrong.append((case, answer))
        elif answer is not None:
            kind, line = answer
            if kind != "SpoolError" or "\n" in line or not 0 < len(line) < 5000:
                wrong.append((case, kind, line[:200]))
    assert not wrong, "\n".join(map(str, wrong))
    assert len(lines) == 2 * len(argument_cases.WRONG) * len(argument_cases.FUNCTIONS[name][1])


def test_every_public_function_and_parameter_has_its_cases():
    cases = {name: set(parameters) for name, (_, parameters, _) in argument_cases.FUNCTIONS.items()}
    assert set(spool.__all__) == argument_cases.NOT_CALLED | (set(cases) & set(spool.__all__))
    missing = [f"{name}({parameter})" for name in set(cases) & set(spool.__all__)
               for parameter in inspect.signature(getattr(spool, name)).parameters
               if parameter not in cases[name] and parameter not in argument_cases.ELSEWHERE]
    assert not missing


class Number(float):
    """As a number of numpy 2, which is a float and has a spelling of its own."""

    def __repr__(self):
        return "np.float64(0.5)"


def test_a_float_of_another_kind_is_a_number():
    plan = {"recordings": [argument_cases.RECORDING], "samplers": [{"name": "multiscale", "alpha": [Number(0.5)]}], "filters": ["box"],
            "spp": [Number(4.0)], "replicates": 1}
    assert spool.evaluate(plan).rows[0]["spp"] == 4
    half = spool.replay(argument_cases.RECORDING, "multiscale", Number(4.0), alpha=Number(0.5))
    assert (half.counts == spool.replay(argument_cases.RECORDING, "multiscale", 4, alpha=0.5).counts).all()
