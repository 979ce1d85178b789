"""An installed Spool in a folder of its own, and programs run with nothing else of this machine's Spool in sight."""
import os
import shutil
import subprocess
from pathlib import Path

import pytest

TREE = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ["SPOOL_BUILD"])
CMAKE = os.environ.get("SPOOL_CMAKE", "cmake")


def run(*words, folder=None, **environment):
    """Runs a program that must succeed; its output."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith(("SPOOL", "PYTHONPATH"))}
    done = subprocess.run([str(word) for word in words], cwd=folder, env={**kept, **environment},
                          text=True, capture_output=True, timeout=600, check=False)
    assert done.returncode == 0, "\n".join([*map(str, words), done.stdout[-4000:], done.stderr[-4000:]])
    return done.stdout


@pytest.fixture(scope="session")
def prefix(tmp_path_factory):
    """`cmake --install` of the build, moved afterwards: nothing may remember where it was installed."""
    folder = tmp_path_factory.mktemp("install")
    run(CMAKE, "--install", BUILD, "--prefix", folder / "first")
    return (folder / "first").rename(folder / "prefix")


def configure(source, folder, *definitions):
    return run(CMAKE, "-G", "Ninja", "-S", source, "-B", folder, f"-DCMAKE_CXX_COMPILER_LAUNCHER={shutil.which('ccache') or ''}",
               f"-DCMAKE_CXX_FLAGS={os.environ.get('SPOOL_CXX_FLAGS', '')}",
               f"-DCMAKE_BUILD_TYPE={os.environ.get('SPOOL_BUILD_TYPE', 'Release')}", *definitions)
