"""Records one pool with its recorder, passes its progress on, and compares the result with what is pinned."""
import os
import re
import subprocess
import sys
import time

from dumps.pool_pins import differences
from dumps.recording.progress import duration

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), ".."))
RECORDERS = {"Cycles": "dumps/record.sh", "Mitsuba": "dumps/mitsuba/record.py"}
_STEP = re.compile(r"^(pool|passes|reference) (\d+) of (\d+), ")


class Pace:
    """Time left: what is to do, in CPU seconds as estimated, times the wall time that a second of what is done took."""

    def __init__(self, seconds):
        """seconds: of each pool."""
        self.seconds, self.started = seconds, time.monotonic()

    def left(self, number, share):
        """share: of pool `number` that is done, those before it being done. Of a pool that was begun earlier the recorder counts
        only what was missing, so that the time left is a little high until that pool is done."""
        done = sum(self.seconds[:number]) + share * self.seconds[number]
        pace = (time.monotonic() - self.started) / done if done > 0 else 1 / (os.cpu_count() or 1)
        return (sum(self.seconds) - done) * pace


def cache(variable, name):
    """What the user chose, or a path in the cache."""
    return os.environ.get(variable) or os.path.join(os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache"), "spool", name)


def command_of(pool, out, scenes):
    """The recorder with the scene and what its samples depend on. `{scenes}` stands for the folder of scenes by others."""
    arguments = [pool["scene"], *pool["arguments"], "--size", "%dx%d" % tuple(pool["size"]), "--samples", str(pool["samples"]),
                 *(["--recordings", str(pool["recordings"])] if "recordings" in pool else []), "--reference", str(pool["reference"])]
    command = [os.path.join(ROOT, RECORDERS[pool["renderer"]]), *(text.replace("{scenes}", scenes) for text in arguments), "-o", out]
    if pool["renderer"] == "Cycles":
        return [*command, "--compress"]
    pinned = ["--scene-sha256", pool["scene_sha256"]] if "scene_sha256" in pool else []
    return [cache("SPOOL_MITSUBA_PYTHON", "mitsuba-venv/bin/python"), *command, *pinned]


def share_done(pool, label, done, total):
    """Of all samples, from a line of progress: the reference comes after the pool."""
    whole = pool["samples"] + pool["reference"]
    if label == "reference":
        return (pool["samples"] + pool["reference"] * done / total) / whole
    return pool["samples"] * done / total / whole


def run_pool(pool, out, files, scenes, left):
    """files: what becomes of out. Whether it was recorded and is what is pinned. left: share done -> seconds to go of all pools."""
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
    found = differences(pool.get("scene_sha256"), pool.get("pinned"), files)
    for text in found:
        print("%s: %s" % (pool["name"], text), file=sys.stderr)
    return not found
