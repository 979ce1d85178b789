"""The command `spool` of the wheel: becomes the program that lies in the package, which reports with this Python."""
import importlib.util
import os
import sys


def main():
    package = os.path.dirname(importlib.util.find_spec("spool").origin)
    os.environ.setdefault("SPOOL_PYTHON", sys.executable)
    os.execv(os.path.join(package, "bin", "spool"), ["spool", *sys.argv[1:]])
