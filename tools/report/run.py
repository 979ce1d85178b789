"""Runs one script of this package: run.py report|figure|live_page|show_page ARGUMENTS.

Packages are looked for beside this one, in the tree and where it is installed, and never in the current folder,
which may hold files of any name.
"""

import importlib
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

if __name__ == "__main__":
    sys.dont_write_bytecode = True
    sys.path[:1] = [str(ROOT), str(ROOT / "formats" / "python")]
    try:
        sys.exit(importlib.import_module(f"tools.report.{sys.argv.pop(1)}").main())
    except ImportError as error:  # of numpy or matplotlib
        print(error, file=sys.stderr)
        sys.exit(20)  # not an exit code of spool: another Python may do
