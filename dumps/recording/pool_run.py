"""Records one pool with its recorder, passes its progress on, and compares the result with what is pinned."""
import os
import re
import subprocess
import sys
import time

from pool_pins import differences
from progress import duration

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))
_STEP = re.compile(r"^(pool|passes|reference) (\d+) of (\d+), ")


class Pace:
    """Time left: what is to do, in CPU seconds as estimated, times the wall time that what is done took of it."""

    def __init__(self, seconds):
        self.seconds, self.started, self.done_at_start = seconds, time.monotonic(), None
        self.whole = 0.0

    def left(self, number, share):
        """share: of the pool `number` that is done; the first call with one above 0 says where this run began."""
        to_do = sum(self.seconds[number:]) - share * (self.seconds[number] if number < len(self.seconds) else 0)
        done = self.whole + share * self.seconds[number]
        if share and self.done_at_start is None:
            self.done_at_start, self.started = done, time.monotonic()
        gained = done - (self.done_at_start or 0)
        pace = (time.monotonic() - self.started) / gained if self.done_at_start is not None and gained > 0 else 1 / (os.cpu_count() or 1)
        return to_do * pace

    def finished(self, number):
        self.whole += self.seconds[number]


def command_of(pool, out, scenes):
    python = os.environ.get("SPOOL_MITSUBA_PYTHON", os.path.join(
        os.environ.get("XDG_CACHE_HOME", os.path.expanduser("~/.cache")), "spool", "mitsuba-venv", "bin", "python"))
    scene, arguments = (text.replace("{scenes}", scenes) for text in [pool["scene"]]), [
        text.replace("{scenes}", scenes) for text in pool["arguments"]]
    start = [os.path.join(ROOT, "dumps", "record.sh")] if pool["renderer"] == "Cycles" else [
        python, os.path.join(ROOT, "dumps", "mitsuba", "record.py")]
    return [*start, *scene, *arguments, "--size", "%dx%d" % tuple(pool["size"]), "--samples", str(pool["samples"]),
            "--reference", str(pool["reference"]), *(["--compress"] if pool["renderer"] == "Cycles" else []), "-o", out]


def share_done(pool, label, done, total):
    """Of all samples, from a line of progress: the reference comes after the pool."""
    whole = pool["samples"] + pool["reference"]
    if label == "reference":
        return (pool["samples"] + pool["reference"] * done / total) / whole
    return pool["samples"] * done / total / whole


def run_pool(pool, out, scenes, left):
    """Whether it was recorded and is what is pinned. left: share done -> seconds to go of all pools."""
    process = subprocess.Popen(command_of(pool, out, scenes), cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    try:
        for line in process.stdout:
            step, tail = _STEP.match(line), ""
            if step:
                tail = ", %s in all" % duration(left(share_done(pool, step[1], int(step[2]), int(step[3]))))
            print("%s: %s%s" % (pool["name"], line.rstrip("\n"), tail), flush=True)
        code = process.wait()
    except KeyboardInterrupt:
        process.terminate()
        process.wait()
        raise
    if code:
        print("%s: the recorder ended with %d" % (pool["name"], code), file=sys.stderr)
        return False
    found = differences(pool.get("pinned"), out)
    for text in found:
        print("%s: %s" % (pool["name"], text), file=sys.stderr)
    return not found
