"""One version everywhere, and a release only from a tree that is ready."""
import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

TREE = Path(__file__).resolve().parents[2]


def version():
    return re.search(r"^project\(spool VERSION ([\d.]+)", (TREE / "CMakeLists.txt").read_text(), re.M)[1]


def test_the_program_and_the_citation_say_the_project_s_version(good):
    assert good("--version").out == f"spool {version()}\n"
    assert f"\nversion: {version()}\n" in (TREE / "CITATION.cff").read_text()
    assert re.search(rf"^## {re.escape(version())} - \d{{4}}-\d\d-\d\d$", (TREE / "CHANGELOG.md").read_text(), re.M)


@pytest.fixture
def copy(tmp_path):
    """A repository of what a release looks at."""
    for name in ("CMakeLists.txt", "CITATION.cff", "CHANGELOG.md", "tools/release.sh"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes((TREE / name).read_bytes())
    (tmp_path / "tools/release.sh").chmod(0o755)
    git(tmp_path, "init", "-q")
    commit(tmp_path)
    return tmp_path


def git(folder, *words):
    identity = {f"GIT_{who}_{what}": "x@example.invalid" for who in ("AUTHOR", "COMMITTER") for what in ("NAME", "EMAIL")}
    subprocess.run(["git", *words], cwd=folder, check=True, capture_output=True,
                   env={**os.environ, **identity, "GIT_CONFIG_GLOBAL": "/dev/null"})


def commit(folder):
    git(folder, "add", "-A")
    git(folder, "commit", "-q", "-m", "x")


def check(folder):
    done = subprocess.run([str(folder / "tools/release.sh"), "--check"], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout + done.stderr


def test_a_whole_tree_is_ready(copy):
    assert check(copy) == (0, f"ready: {version()}\n")


def test_a_tree_without_git_is_not_ready(copy):
    """As the source archive of a release is; also where it lies in another repository."""
    (copy / "tree").mkdir()
    for name in ("CMakeLists.txt", "CITATION.cff", "CHANGELOG.md", "tools"):
        (copy / name).rename(copy / "tree" / name)
    for _ in range(2):
        code, text = check(copy / "tree")
        assert code == 1 and re.fullmatch(r"release.sh: .* is no git clone .*\n", text)
        shutil.rmtree(copy / ".git", ignore_errors=True)


def replace(file, old, new):
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new, 1))


@pytest.mark.parametrize("spoil, words", [
    (lambda tree: (tree / "stray").touch(), "git does not know"),
    (lambda tree: replace(tree / "CMakeLists.txt", version(), "9.9.9"), "changes"),
    (lambda tree: (replace(tree / "CMakeLists.txt", version(), "9.9.9"), commit(tree)), "CITATION.cff"),
    (lambda tree: (replace(tree / "CHANGELOG.md", f"## {version()} - ", "## 0.0 - "), commit(tree)), "CHANGELOG.md"),
    (lambda tree: git(tree, "tag", f"v{version()}"), "tagged already"),
])
def test_what_is_not_ready_is_refused_in_one_line(copy, spoil, words):
    spoil(copy)
    code, said = check(copy)
    assert code == 1 and words in said and len(said.splitlines()) == 1
