"""tools/dev.sh: what its usage names is there, what it calls is defined, and what is fetched is pinned by hash."""
import fcntl
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

TREE = Path(__file__).resolve().parents[2]
SCRIPT = TREE / "tools" / "dev.sh"
TEXT = SCRIPT.read_text()
CASES = TEXT[TEXT.rindex('case "${1:-help}" in'):]


def verbs_of_cases():
    return {verb for names in re.findall(r"^  (\w[\w |]*)\)", CASES, re.M) for verb in names.split(" | ")}


def test_every_verb_calls_a_function_that_is_defined():
    functions = re.search(r"^  (\w[\w |]*)\)\n    \"\$@\" ;;", CASES, re.M)[1].split(" | ")
    called = {*functions, *re.findall(r"^  \w+\) (\w+) \"\$\{@:2\}\"", CASES, re.M)}
    defined = set(re.findall(r"^(\w+)\(\) \{", TEXT, re.M))
    assert len(called) > 8 and called <= defined


def test_every_verb_of_the_usage_is_a_case():
    usage = subprocess.run([SCRIPT, "help"], capture_output=True, text=True, check=True).stdout
    verbs = set(re.findall(r"^  (\w+) ", usage, re.M))
    assert len(verbs) > 10 and verbs <= verbs_of_cases()


def copy_of_the_script(tmp_path):
    script = tmp_path / "tools/dev.sh"
    script.parent.mkdir()
    script.write_text(TEXT)
    script.chmod(0o755)
    (tmp_path / "build").mkdir()
    return script, lambda: sorted(path.relative_to(tmp_path) for path in tmp_path.rglob("*"))


@pytest.mark.parametrize("verb", sorted(verbs_of_cases() - {"help"}))
def test_a_verb_that_is_asked_for_help_does_nothing(verb, tmp_path):
    script, files = copy_of_the_script(tmp_path)
    before = files()
    asked = subprocess.run([script, verb, "--help"], capture_output=True, text=True, timeout=60, check=False)
    assert asked.stdout.startswith(f"  {verb} ") and files() == before, asked.stderr


@pytest.mark.parametrize("arguments", ["clean all", "docs --strict", "package --root", "package --clean-root x", "lint --al", "setup all x",
                                       "strangers x", "bits x", "addon -x", "wheel no-such-python"])
def test_a_verb_with_an_unknown_argument_does_nothing(arguments, tmp_path):
    script, files = copy_of_the_script(tmp_path)
    before = files()
    asked = subprocess.run([script, *arguments.split()], capture_output=True, text=True, timeout=60, check=False)
    assert asked.returncode == 1 and files() == before, asked.stderr
    assert re.fullmatch(f"dev.sh: {arguments.split()[0]}: .*\n", asked.stderr)


def one_line(done):
    assert done.returncode == 1 and re.fullmatch(r"dev.sh: .*\n", done.stderr), done.stdout + done.stderr
    return done.stderr


@pytest.mark.parametrize("verb", ["docs", "lint", "mutate", "strangers"])
def test_what_asks_git_for_its_files_needs_a_clone(verb, tmp_path):
    script, files = copy_of_the_script(tmp_path)
    before = files()
    done = subprocess.run([script, verb], capture_output=True, text=True, timeout=60, check=False)
    assert "git clone" in one_line(done) and files() == before


@pytest.mark.parametrize("folder", [".", "build", "build/release"])
def test_a_tree_of_another_owner_is_left_as_it_is(folder, tmp_path):
    """Root may write everywhere: somebody else asks."""
    if os.geteuid() == 0 and not shutil.which("setpriv"):
        pytest.skip("root, and no setpriv")
    # A name with blanks and letters beyond ASCII, where others may look.
    with tempfile.TemporaryDirectory(prefix="spool tree \u00e4 ") as place:
        place = Path(place)
        script, files = copy_of_the_script(place)
        (place / "build/release").mkdir()
        for path in [place, *place.rglob("*")]:
            path.chmod(0o777)
        (place / folder).chmod(0o555)
        before = files()
        other = ["setpriv", "--reuid=65534", "--regid=65534", "--clear-groups"] if os.geteuid() == 0 else []
        done = subprocess.run([*other, script, "build"], capture_output=True, text=True, timeout=60, check=False)
        assert "not writable" in one_line(done) and "spool tree \u00e4" in done.stderr and files() == before
        (place / folder).chmod(0o777)


def test_a_build_of_a_tree_elsewhere_is_named(tmp_path):
    script, _ = copy_of_the_script(tmp_path)
    (tmp_path / "CMakeLists.txt").write_text("cmake_minimum_required(VERSION 3.25)\nproject(x NONE)\n")
    (tmp_path / "CMakePresets.json").write_text((TREE / "CMakePresets.json").read_text())
    (tmp_path / "build/release").mkdir()
    (tmp_path / "build/release/CMakeCache.txt").write_text(
        f"CMAKE_HOME_DIRECTORY:INTERNAL={tmp_path}/elsewhere\nCMAKE_CACHEFILE_DIR:INTERNAL={tmp_path}/elsewhere/build\n")
    done = subprocess.run([script, "build"], capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 1 and done.stderr.splitlines()[-1].startswith("dev.sh: build/release cannot be configured")


def test_a_python_that_pip_could_not_make_is_named(tmp_path):
    script, _ = copy_of_the_script(tmp_path)
    (tmp_path / "tools/requirements").mkdir()
    (tmp_path / "tools/requirements/lock.txt").write_text((TREE / "tools/requirements/lock.txt").read_text())
    unreachable = {**os.environ, "XDG_CACHE_HOME": str(tmp_path / "cache"), "PIP_INDEX_URL": "http://127.0.0.1:1", "PIP_RETRIES": "0"}
    done = subprocess.run([script, "lock"], capture_output=True, text=True, timeout=300, env=unreachable, check=False)
    last = done.stderr.splitlines()[-1]
    assert done.returncode == 1 and last.startswith("dev.sh: lock: ") and str(tmp_path / "cache/spool/lock-venv") in last, done.stderr


def test_a_name_of_a_file_is_meant_where_the_caller_is(tmp_path):
    for arguments, name in ([], "spool_recorder.zip"), (["a b.zip"], "a b.zip"):
        made = subprocess.run([SCRIPT, "addon", *arguments], cwd=tmp_path, capture_output=True, text=True, timeout=60, check=True)
        assert made.stdout == f"{tmp_path / name}\n" and (tmp_path / name).is_file() and not (TREE / name).exists()


def test_it_finds_its_tree_by_a_link_with_a_cdpath_and_without_a_home(tmp_path):
    """Where it took the link's folder for the tree, `clean` removed the build there."""
    (tmp_path / "bin").mkdir()
    (tmp_path / "tools").mkdir()
    (tmp_path / "bin/dev").symlink_to(SCRIPT)
    bare = {name: value for name, value in os.environ.items() if name not in ("HOME", "XDG_CACHE_HOME")} | {"CDPATH": f"{tmp_path}:."}
    for script, folder in ("bin/dev", tmp_path), ("tools/dev.sh", TREE):
        made = subprocess.run([script, "addon", tmp_path / "made.zip"], cwd=folder, env=bare, capture_output=True, text=True, timeout=60, check=False)
        assert (made.returncode, made.stdout, made.stderr) == (0, f"{tmp_path}/made.zip\n", "")


def test_two_runs_do_not_make_one_python_at_once(tmp_path):
    script, _ = copy_of_the_script(tmp_path)
    shutil.copytree(TREE / "tools/requirements", tmp_path / "tools/requirements")
    (tmp_path / "cache/spool").mkdir(parents=True)
    unreachable = {**os.environ, "XDG_CACHE_HOME": str(tmp_path / "cache"), "PIP_INDEX_URL": "http://127.0.0.1:1", "PIP_RETRIES": "0"}
    with open(tmp_path / "cache/spool/lock-venv.lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        second = subprocess.Popen([script, "lock"], env=unreachable, stderr=subprocess.PIPE, text=True)
        assert "another run is at work on" in second.stderr.readline() and not (tmp_path / "cache/spool/lock-venv").exists()
    assert "== a Python in" in second.communicate(timeout=300)[1]


LOCKS = [*TREE.glob("tools/requirements/*.txt"), TREE / "dumps/mitsuba/requirements.txt"]


def function_of(name):
    return re.search(rf"^{name}\(\) \{{.*?^\}}", TEXT, re.M | re.S)[0]


def test_pip_installs_nothing_without_a_hash():
    calls = re.findall(r"pip (?:install|wheel|download)[^\n]*", TEXT)
    assert len(calls) == 3
    for call in calls:
        assert "--require-hashes" in call or "--no-deps --no-index" in call or "--no-deps --no-build-isolation" in call, call
    used = re.findall(r"(?:setup_venv|install_locked) .*", TEXT.replace("\\\n", " "))
    assert {file.stem for file in LOCKS} - {"requirements"} <= set(" ".join(used).split())


@pytest.mark.parametrize("lock", LOCKS, ids=lambda file: file.parent.name + "/" + file.name)
def test_a_lock_file_pins_all_that_it_was_made_from(lock):
    pinned = {}
    for entry in re.split(r"\n(?=\S)", lock.read_text().strip()):
        name, version, rest = re.match(r"([\w.-]+)==([\w.]+)(.*)$", entry, re.S).groups()
        assert re.search(r"--hash=sha256:[0-9a-f]{64}", rest), entry
        pinned.setdefault(name.replace("_", "-").lower(), set()).add(version)
    for line in lock.with_suffix(".in").read_text().split():
        name, _, version = line.partition("==")
        found = pinned[re.match(r"[\w-]+", name)[0].lower()]
        assert not version or "*" in version or any((one + ".").startswith(version + ".") for one in found), line


@pytest.mark.parametrize("workflow", sorted((TREE / ".github/workflows").glob("*.yml")), ids=lambda file: file.name)
def test_actions_are_pinned_by_commit(workflow):
    used = re.findall(r"uses: (.*)", workflow.read_text())
    assert used and all(re.fullmatch(r"[\w./-]+@[0-9a-f]{40}  # v[\d.]+", one) for one in used)


def test_an_archive_of_npm_is_the_one_that_was_pinned(tmp_path):
    npm = tmp_path / "bin/npm"
    npm.parent.mkdir()
    npm.write_text("#!/bin/sh\nprintf other >name-1.0.tgz\n")
    npm.chmod(0o755)
    functions = function_of("fetch_npm") + "\ndie() { echo \"$*\" >&2; exit 1; }\n"

    def fetch(digest):
        return subprocess.run(["bash", "-ec", functions + f"fetch_npm name 1.0 {digest}"], cwd=tmp_path, text=True,
                              capture_output=True, env={"PATH": f"{npm.parent}:/usr/bin:/bin"}, check=False)
    refused = fetch("0" * 64)
    assert refused.returncode == 1 and "sha256 differs" in refused.stderr and not (tmp_path / "name-1.0.tgz").exists()
    right = subprocess.run(["sha256sum"], input="other", text=True, capture_output=True, check=True).stdout.split()[0]
    assert fetch(right).returncode == 0 and (tmp_path / "name-1.0.tgz").exists()
    npm.unlink()
    assert fetch(right).returncode == 0  # what is there is checked, and not fetched again
    assert "fetch_npm" in function_of("docs") and len(re.findall("npm pack", TEXT)) == 1


@pytest.mark.parametrize("subject", sorted(path.parent.name for path in (TREE / "tools/bench").glob("*/run.py")))
@pytest.mark.parametrize("more, code", [(["--help"], 0), (["--no-such-option"], 2)])
def test_a_benchmark_that_is_asked_for_help_or_for_nonsense_measures_nothing(subject, more, code, tmp_path):
    """The folder of the build is empty: what measured would fail otherwise."""
    found = subprocess.run([sys.executable, "-m", f"tools.bench.{subject}.run", tmp_path, *more], cwd=TREE, capture_output=True, text=True,
                           timeout=60, env={**os.environ, "PYTHONPATH": str(TREE / "formats/python")}, check=False)
    assert found.returncode == code and "usage: run.py [-h]" in found.stdout + found.stderr, found.stderr
