"""The lint rule for words finds a word in prose, and only there."""
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
RULE = """import sys
from pathlib import Path
from lint_rules import words
print(*words.check([Path(name) for name in sys.argv[1:]]), sep="\\n")
"""


def found(folder, name, text):
    (folder / name).write_text(text, encoding="utf-8")
    done = subprocess.run([sys.executable, "-c", RULE, name], cwd=folder, env={"PYTHONPATH": str(ROOT / "tools")}, capture_output=True, text=True, check=True)
    return done.stdout.strip()


@pytest.mark.parametrize("name, text", [
    ("a.cpp", "int a = 1;  // nobody reads it\n"), ("a.h", 'constexpr const char* kHelp = "what a file tells of it";\n'), ("a.py", '"""A dump of samples."""\n'),
    ("a.py", "x = 1  # told before\n"), ("a.in", "The file speaks of two samples.\n"), ("a.js", "// Whoever asks first\n")])
def test_a_word_in_prose_is_found_with_its_line(tmp_path, name, text):
    assert found(tmp_path, name, "\n" + text).startswith(f"{name}:2: '")


@pytest.mark.parametrize("name, text", [
    ("a.cpp", '#include "tools/batch/dump_identity.h"\nint told = dump.size();\nreturn fail("dump");\n'), ("a.py", "told = dump(1)\n"),
    ("a.in", "Give `dump` and [dumps/tiny](dumps/tiny/README.md):\n\n    spool info dump\n\n```\nnobody\n```\n")])
def test_names_and_code_are_left_alone(tmp_path, name, text):
    assert found(tmp_path, name, text) == ""


@pytest.mark.parametrize("before, number, there", [("docs/decisions.md, ", "0031", False), ("decision ", "7", True), ("decision ", "70", True),
                                                   ("docs/decisions.md, ", "0070", True), ("decision ", "159", False)])
def test_a_decision_that_is_not_on_the_page_is_found(tmp_path, before, number, there):
    (tmp_path / "docs").mkdir()
    (tmp_path / "docs/decisions.md").write_text("### 0070 Intervals\n")
    (tmp_path / "a.h").write_text(f"// {before}{number}\n")
    rule = "from pathlib import Path; from lint_rules import pages; print(*pages.missing_decisions([Path('a.h')]))"
    done = subprocess.run([sys.executable, "-c", rule], cwd=tmp_path, env={"PYTHONPATH": str(ROOT / "tools")}, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == ("" if there else f"a.h:1: docs/decisions.md has no decision {number}")


@pytest.mark.parametrize("name, there", [("kernels/scale_ladder", True), ("lib/kernels/scale_ladder.h", True), ("kernels/", True), ("kernels/film", False),
                                         ("lib/kernels/film.h", False), ("tools/kernels/film", True)])
def test_a_source_that_is_not_in_the_library_is_found(tmp_path, name, there):
    (tmp_path / "lib/kernels").mkdir(parents=True)
    (tmp_path / "lib/kernels/scale_ladder.h").write_text("")
    (tmp_path / "README.md").write_text(f"both, with `{name}`\n")
    rule = "from pathlib import Path; from lint_rules import pages; print(*pages.missing_sources([Path('README.md')]))"
    done = subprocess.run([sys.executable, "-c", rule], cwd=tmp_path, env={"PYTHONPATH": str(ROOT / "tools")}, capture_output=True, text=True, check=True)
    assert bool(done.stdout.strip()) != there
