"""Runs the recorder as a user does: Blender in a process of its own."""
import json
import os
import pathlib
import shutil
import subprocess
import tempfile

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
RECORD = ROOT / "dumps" / "cycles" / "record.py"


def command(*options):
    """BLENDER may name another Blender, or a Python that has the module bpy."""
    program = os.environ.get("BLENDER", "blender")
    if "python" in os.path.basename(program):
        return [program, str(RECORD), *map(str, options)]
    return [program, "-b", "--factory-startup", "-P", str(RECORD), "--python-exit-code", "3", "--",
            *map(str, options)]


def record(*options, **more):
    """One run of the recorder, which leaves nothing in the temporary folder of the system."""
    with tempfile.TemporaryDirectory() as temporary:
        done = subprocess.run(command(*options), capture_output=True, text=True, timeout=280,
                              env={**os.environ, "TMPDIR": temporary}, **more)
        assert os.listdir(temporary) == []
    return done


def one_line(text):
    lines = [line for line in text.splitlines() if line.startswith("record:")]
    assert len(lines) == 1, text
    return lines[0]


class Folder:
    def __init__(self, path):
        self.path = pathlib.Path(path)
        self.recording = json.loads((self.path / "manifest.json").read_text())["recording"]
        lines = (self.path / "passes.jsonl").read_text().splitlines()
        self.entries = [json.loads(line) for line in lines]
        self.names = [c["name"] for c in self.recording["channels"]]

    def files(self):
        return {p.name: p.read_bytes() for p in sorted(self.path.glob("*.f32"))}

    def planes(self, name):
        """float[channel][y][x] of one file."""
        import numpy
        from dumps.cycles import packed_pass
        line = next(entry for entry in self.entries if entry["file"] == name)
        width, height = self.recording["width"], self.recording["height"]
        planes = len(self.names) if line["kind"] == "pass" else 3
        raw = packed_pass.unpack((self.path / name).read_bytes(), line, width, height, planes)
        return numpy.frombuffer(raw, "<f4").reshape(planes, height, width)

    def plane(self, name, channel):
        return self.planes(name)[self.names.index(channel)]


def pytest_collection_modifyitems(config, items):
    config.wants_blender = [i for i in items if i.fspath.basename not in ("test_seeds.py", "test_packed_pass.py", "test_tiny.py")]
    if blender_missing():
        for item in config.wants_blender:
            item.add_marker(pytest.mark.skip(reason=blender_missing()))


def pytest_sessionfinish(session, exitstatus):
    """Said aloud: exit code 77 is reported as skipped, not as passed."""
    if blender_missing() and exitstatus == 0 and session.config.wants_blender:
        print("\n" + blender_missing())
        session.exitstatus = 77


def blender_missing():
    program = os.environ.get("BLENDER", "blender")
    return "" if shutil.which(program) else \
        "NOT TESTED: no %s; apt-get install blender python3-numpy" % program


SMALL = ("--scene", "chess", "--size", "16", "--samples", "4", "--reference", "16")


@pytest.fixture(scope="session")
def recorded(tmp_path_factory):
    """One small recording that several tests look at."""
    path = tmp_path_factory.mktemp("recorded") / "passes"
    done = record(*SMALL, "--mode", "shift", "-o", path)
    assert done.returncode == 0, done.stderr
    return Folder(path)
