"""A scene that a script outside of dumps/scenes builds, from files in a folder of its own."""
import hashlib
from pathlib import Path

import pytest
from conftest import Folder, one_line, record

SCENES = Path(__file__).resolve().parents[2] / "dumps" / "scenes"
BUILD = """
import bpy
from model.stage import add_camera, add_lamp, start_scene
from model.shapes import add_block
from model.materials import plain

def build(find):
    size = float(open(find("size.txt")).read())
    scene = start_scene((0.1, 0.1, 0.1), (0.5, 0.5, 0.5), 1)
    add_block("block", (size, size, size), (0, 0, 0), plain("grey", (0.5, 0.5, 0.5)))
    add_camera((4, -4, 3), (0, 0, 0), 40)
    return scene
"""


def written(folder, text, size="1"):
    (folder / "files").mkdir(exist_ok=True)
    (folder / "files/size.txt").write_text(size)
    (folder / "block.py").write_text(text)
    return folder / "block.py"


def test_its_identity_covers_the_files_it_finds(tmp_path):
    found = {}
    for size in ("1", "2"):
        done = record("--scene", written(tmp_path, BUILD, size), "--files", tmp_path / "files", "--size", "16", "--samples", "1",
                      "-o", tmp_path / f"passes{size}")
        assert done.returncode == 0, done.stderr
        found[size] = Folder(tmp_path / f"passes{size}").recording["scene"]
    assert found["1"]["name"] == found["2"]["name"] == "block.py" and found["1"]["sha256"] != found["2"]["sha256"]
    assert found["1"]["sha256"] != hashlib.sha256(BUILD.encode()).hexdigest()


def test_a_scene_of_the_tree_may_be_given_by_its_path(tmp_path):
    done = record("--scene", SCENES / "balls.py", "--dry-run", "--size", "16", "--samples", "1", "-o", tmp_path / "passes")
    assert done.returncode == 0 and "scene balls.py" in done.stdout, done.stderr


@pytest.mark.parametrize("text, files, code, words", [
    (BUILD, None, 2, "its file 'size.txt' is not there: give the folder with --files"),
    ("x = 1", None, 2, "has no function build(find)"),
    ("def build(find):\n    return 3", None, 1, "build() returned no scene"),
    ("def build(find):\n    return [][1]", None, 1, "build() failed: IndexError"),
    ("def build(find:", None, 1, "cannot be loaded: SyntaxError"),
    ("import sys; sys.exit(0)", None, 1, "cannot be loaded: SystemExit"),
    (BUILD, "nowhere", 2, "--files nowhere: no such folder"),
])
def test_what_is_wrong_in_it_is_one_line(tmp_path, text, files, code, words):
    done = record("--scene", written(tmp_path, text), *(("--files", files) if files else ()), "-o", tmp_path / "passes")
    assert done.returncode == code and words in one_line(done.stderr), done.stderr


def test_files_belong_to_a_script(tmp_path):
    done = record("--scene", "chess", "--files", tmp_path, "-o", tmp_path / "passes")
    assert done.returncode == 2 and "only a .py scene finds files there" in one_line(done.stderr)
