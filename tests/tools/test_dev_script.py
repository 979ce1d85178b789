"""tools/dev.sh: what its usage names is there, and what it calls is defined."""
import re
import subprocess
from pathlib import Path

SCRIPT = Path(__file__).resolve().parents[2] / "tools" / "dev.sh"
TEXT = SCRIPT.read_text()
CASES = TEXT[TEXT.rindex('case "${1:-help}" in'):]


def test_every_verb_calls_a_function_that_is_defined():
    called = set(re.findall(r"^  \w+\) shift; (\w+) ", CASES, re.M))
    defined = set(re.findall(r"^(\w+)\(\) \{", TEXT, re.M))
    assert len(called) > 8 and called <= defined


def test_every_verb_of_the_usage_is_a_case():
    usage = subprocess.run([SCRIPT, "help"], capture_output=True, text=True, check=True).stdout
    verbs = set(re.findall(r"^  (\w+) ", usage, re.M))
    assert len(verbs) > 10 and verbs <= set(re.findall(r"^  (\w+)\) ", CASES, re.M))
