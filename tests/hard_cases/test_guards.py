"""No silent clamps: every guard is counted and documented, everything that looks like a clamp is named."""
import re
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs/hard_cases.md").read_text(encoding="utf-8")
GUARDS = re.findall(r'X\((k\w+),\s*"(\w+)",', (ROOT / "lib/core/guards.h").read_text(encoding="utf-8"))
KINDS = tomllib.loads((Path(__file__).parent / "clamps.toml").read_text(encoding="utf-8"))["kind"]

# What a clamp looks like: a bound with a decimal point or a named constant, a small literal, a test for finite values.
CLAMP = re.compile(r"std::(max|min|clamp)\s*(<\w+>)?\s*\([^;]*(\d\.\d|k[A-Z]\w+)|[^\w.]\d(\.\d+)?e-\d+\b|"
                   r"std::is(finite|nan)\(|0x1p-\d+|<=? *0\.0f? *\?|\bk(Least|Smallest|Epsilon)\w*")
NOT_ONE = re.compile(r"(number|integer)_option|kSumChunk|kChunk|kBand|kRows|kColumns|kLanes|kFar|kTile(Width|Height)?\b|kMost(Channels|Features)|result_table|tv_nsec|format_number")
# Pictures for people, foreign files, whose doors say what they refuse, and scenes, whose formulas have clamps in them.
SKIPPED = ("lib/image_io/", "lib/exchange/", "lib/synthetic/", "lib/core/guards", "lib/core/option_table")


def sources():
    for path in sorted((ROOT / "lib").rglob("*")):
        name = str(path.relative_to(ROOT))
        if path.suffix in (".h", ".cpp") and not name.startswith(SKIPPED):
            yield name, path.read_text(encoding="utf-8")


def suspicious_lines():
    for name, text in sources():
        for number, line in enumerate(text.splitlines(), 1):
            code = line.split("//")[0]
            if CLAMP.search(code) and not NOT_ONE.search(code):
                yield name, number, line


@pytest.mark.parametrize("identifier, name", GUARDS)
def test_guard_is_counted_somewhere_and_documented(identifier, name):
    users = [path for path, text in sources() if f"Guard::{identifier}" in text]
    assert users, f"{identifier} is never counted: count it or remove it"
    row = next((line for line in PAGE.splitlines() if line.startswith(f"| `{name}`")), None)
    assert row, f"docs/hard_cases.md has no row for {name}"
    listed = re.findall(r"`(lib/[\w/]+\.(?:cpp|h))`", row)
    assert listed and set(listed) <= set(users), f"docs/hard_cases.md, {name}: it is counted in {users}"


def test_every_clamp_is_a_guard_or_named():
    named = {}
    for kind in KINDS:
        for place in kind["places"]:
            named.setdefault(place[0], []).append(place[1])
    unnamed = [f"{name}:{number}: {line.strip()}" for name, number, line in suspicious_lines()
               if not any(code in line for code in named.get(name, []))]
    assert not unnamed, ("count it as a guard (lib/core/guards.h), or say in tests/hard_cases/clamps.toml why not:\n"
                         + "\n".join(unnamed))


def test_the_list_names_what_is_there():
    texts = dict(sources())
    for kind in KINDS:
        for place in kind["places"]:
            assert place[1] in texts.get(place[0], ""), f"clamps.toml: {place[0]} has no {place[1]!r}"
            if len(place) == 3:
                identifier = next(i for i, name in GUARDS if name == place[2])
                assert f"Guard::{identifier}" in texts[place[0]] or place[0].endswith((".h", "sanitise.cpp", "sanitise.h"))


def test_the_page_names_tests_that_exist():
    """`Suite.Name` or `file.py::name` in docs/hard_cases.md."""
    suites = "\n".join(path.read_text(encoding="utf-8") for path in (ROOT / "tests").rglob("*_test.cpp"))
    known = {f"{a}.{b}" for a, b in re.findall(r"(?:TEST|TEST_P|TEST_F|RC_GTEST_PROP)\(\s*(\w+),\s*(\w+)", suites)}
    for suite, name in re.findall(r"`([A-Z]\w+)\.(\w+)`", PAGE):
        assert f"{suite}.{name}" in known, f"docs/hard_cases.md: there is no test {suite}.{name}"
    for file, name in re.findall(r"`(tests/[\w/]+\.py)::(\w+)`", PAGE):
        assert f"def {name}(" in (ROOT / file).read_text(encoding="utf-8"), f"{file} has no {name}"
    for file in re.findall(r"`((?:tests|tools|docs)/[\w/]+\.(?:h|cpp|py|toml|md|sh))`", PAGE):
        assert (ROOT / file).exists(), f"docs/hard_cases.md: there is no {file}"


def test_every_case_of_the_table_is_on_the_page():
    table = (Path(__file__).parent / "hard_case_table.cpp").read_text(encoding="utf-8")
    for case in re.findall(r'(?:add|constant|firefly|noise|heavy)\(\s*"([\w-]+)"', table):
        assert case == "size_" or f"`{case}`" in PAGE, f"docs/hard_cases.md does not say what {case} is"
