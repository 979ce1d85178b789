import os
import subprocess
import sys

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))
for folder in ("dumps/mitsuba", "dumps/recording", "dumps/verify", "formats/python"):
    sys.path.insert(0, os.path.join(ROOT, folder))
RECORD = os.path.join(ROOT, "dumps", "mitsuba", "record.py")


def record(*arguments, **more):
    return subprocess.run([sys.executable, RECORD, *map(str, arguments)], capture_output=True, text=True, **more)


def check_ok(result):
    assert result.returncode == 0, result.stderr
    return result
