"""`spool evaluate` on a plan, for the scripts that write pages from its results."""
import subprocess
import sys
from pathlib import Path


def evaluate(program, plan, folder, threads, *more):
    """Goes on where it stopped. Exit code 1 means cells that failed, which the results name; another ends the script."""
    finished = subprocess.run([program, "evaluate", plan, "-o", folder, "--threads", threads, *more], stdout=subprocess.DEVNULL)
    if finished.returncode not in (0, 1):
        sys.exit(f"{Path(sys.argv[0]).stem}: {plan} stopped with exit code {finished.returncode}; the same command goes on")
