#!/usr/bin/env python3
"""The recordings of full size that dumps/POOLS.toml lists.

    python3 dumps/pools.py                       what there is, what is here already, and what the rest will take
    tools/dev.sh record NAME... | --all          records what is not there yet, one after the other
    python3 dumps/pools.py --table               what is pinned, one line a recording
    python3 dumps/pools.py --pin NAME...         writes hashes, sizes and versions of finished recordings into POOLS.toml

They lie in $SPOOL_RECORDINGS (~/.cache/spool/recordings). Scenes by others are looked for in $SPOOL_SCENES
(~/.cache/spool/scenes): a clone of each repository under its own name. Stop at any time; the same command goes on.
Exit codes: 0 done, 1 a recording failed or is not what POOLS.toml says, 2 wrong use, 3 the system refused.
"""
import os
import shutil
import signal
import sys
from argparse import RawDescriptionHelpFormatter
from functools import partial

import tomllib

sys.path.insert(0, os.path.abspath(os.path.join(__file__, "..", "..")))
sys.path.insert(1, os.path.join(sys.path[0], "formats", "python"))

from dumps.pool_run import Pace, cache, run_pool
from dumps.recording.command_line import Parser
from dumps.recording.failure import guarded, io_failure, module_failure, scene_failure, usage_failure
from dumps.recording.progress import duration
from dumps.recording.progress import size as size_text
from dumps.recording.recordings import names
from dumps.recording.whole_files import lock

PATH = os.path.join(os.path.dirname(os.path.abspath(__file__)), "POOLS.toml")
BYTES = {"Cycles": 90, "Mitsuba": 100}       # a sample and pixel, at the peak: passes or chunks, and the recording beside them


def read_pools(path):
    try:
        with open(path, "rb") as stream:
            pools = tomllib.load(stream)["pool"]
    except OSError as error:
        raise io_failure("%s: %s" % (path, error.strerror))
    except (tomllib.TOMLDecodeError, KeyError) as error:
        raise usage_failure("%s: not a list of pools (%s)" % (path, error))
    return {pool["name"]: pool for pool in pools}


def seconds_of(pool):
    """CPU seconds of the whole recording where that is pinned, else of all its samples."""
    if "pinned" in pool:
        return pool["pinned"]["cpu_seconds"]
    return pool["size"][0] * pool["size"][1] * (pool["samples"] + pool["reference"]) * pool["cost"] * 1e-6


def samples_of(pool):
    count = pool.get("recordings", 1)
    return "%d of %d" % (count, pool["samples"] // count) if count > 1 else str(pool["samples"])


def file_of(pool, folder):
    """What --output names; files_of: what the recorder makes of that name."""
    return os.path.join(folder, pool["name"] + ".spool")


def files_of(pool, folder):
    return names(file_of(pool, folder), pool.get("recordings", 1))


def missing_source(pool, scenes):
    """How to get what the pool needs and is not there, or None."""
    source = pool.get("source")
    name = source and source["repository"].rsplit("/", 1)[1]
    if not source or os.path.isdir(os.path.join(scenes, name)):
        return None
    place = os.path.join(scenes, name)
    return "needs a scene by others (%s): git clone %s %s && git -C %s checkout %s" % (
        source["licence"], source["repository"], place, place, source["commit"])


def state(pool, folder):
    path = file_of(pool, folder)
    if all(map(os.path.exists, files_of(pool, folder))):
        return "here"
    return "begun" if os.path.isdir(path + ".passes") or os.path.isdir(path + ".recording") else ""


def show(pools, folder, scenes):
    print("recordings in %s, scenes by others in %s" % (folder, scenes))
    for pool in pools.values():
        print("%-24s %-8s %4d x %-4d %9s samples, reference %5d, %12s of CPU, %s" % (
            pool["name"], pool["renderer"], *pool["size"], samples_of(pool), pool["reference"], duration(seconds_of(pool)),
            state(pool, folder) or missing_source(pool, scenes) or "to do"))
    print("to do: %s of CPU" % duration(sum(seconds_of(pool) for pool in pools.values() if state(pool, folder) != "here")))


def held_of(claims):
    """"16 hold, 2 not known": 16 of 18."""
    counts = {words.split(" ", 1)[1]: int(words.split(" ", 1)[0]) for words in claims.split(", ")}
    return "all %d" % counts["hold"] if set(counts) == {"hold"} else "%d of %d" % (counts.get("hold", 0), sum(counts.values()))


def table(pools):
    """As Markdown: each recording, what it costs, and how many claims of verification hold."""
    lines = ["| recording | pixels | samples | reference | CPU, min:s | size | claims that hold |", "|---" * 7 + "|"]
    for pool in pools.values():
        pin = pool.get("pinned", {})
        found = ("%d:%02d" % divmod(pin["cpu_seconds"], 60), size_text(pin["bytes"]), held_of(pin["claims"])) if pin else ["–"] * 3
        lines.append("| `%s` | %dx%d | %s | %d | %s | %s | %s |" % (pool["name"], *pool["size"], samples_of(pool), pool["reference"], *found))
    print("\n".join(lines))


def need_reader():
    """What a finished recording is read by and compared with its pin: said before hours of rendering, not after."""
    try:
        import zstandard  # noqa: F401

        import spool  # noqa: F401
    except ImportError as error:
        raise module_failure(error, "compares a recording with what is pinned", "dumps/pools.py")


def record(chosen, folder, scenes):
    """Names of the pools that failed."""
    need_reader()
    os.makedirs(folder, exist_ok=True)
    kept = lock(folder, "another run records here")  # noqa: F841 - until this function ends
    failed, left = [], []
    for pool in chosen:
        missing = missing_source(pool, scenes)
        if state(pool, folder) == "here":
            print("%s: here already" % pool["name"])
        elif missing:
            print("%s: %s" % (pool["name"], missing), file=sys.stderr)
            failed.append(pool["name"])
        else:
            left.append(pool)
    pace = Pace([seconds_of(pool) for pool in left])
    for number, pool in enumerate(left):
        need = pool["size"][0] * pool["size"][1] * pool["samples"] * BYTES[pool["renderer"]]
        free = shutil.disk_usage(folder).free
        if need > free:
            raise io_failure("%s: %s needs %s, %s are free: make room or set SPOOL_RECORDINGS" % (
                folder, pool["name"], size_text(need), size_text(free)))
        print("%s (%d of %d), about %s left in all" % (pool["name"], number + 1, len(left), duration(pace.left(number, 0))),
              flush=True)
        if not run_pool(pool, file_of(pool, folder), files_of(pool, folder), scenes, partial(pace.left, number)):
            failed.append(pool["name"])
    return failed


def parse():
    parser = Parser(description=__doc__, formatter_class=RawDescriptionHelpFormatter)
    parser.add_argument("--record", nargs="+", metavar="NAME")
    parser.add_argument("--all", action="store_true", help="record all")
    parser.add_argument("--pin", nargs="+", metavar="NAME")
    parser.add_argument("--table", action="store_true", help="what is pinned, as Markdown")
    parser.add_argument("--pools", default=PATH, help="another list")
    return parser.parse_args()


def main():
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    options = parse()
    pools = read_pools(options.pools)
    folder, scenes = map(os.path.abspath, (cache("SPOOL_RECORDINGS", "recordings"), cache("SPOOL_SCENES", "scenes")))
    chosen = list(pools) if options.all else options.record or options.pin or []
    for name in chosen:
        if name not in pools:
            raise usage_failure("'%s' is not in %s: use %s" % (name, options.pools, ", ".join(pools)))
    if options.table:
        table(pools)
    elif options.pin:
        need_reader()
        absent = [(path, name) for name in chosen for path in files_of(pools[name], folder) if not os.path.exists(path)]
        if absent:
            raise usage_failure("%s: no such recording: --record %s" % absent[0])
        from dumps.pool_pins import pin
        pin(options.pools, {name: files_of(pools[name], folder) for name in chosen})
    elif chosen:
        os.nice(10)
        failed = record([pools[name] for name in chosen], folder, scenes)
        if failed:
            raise scene_failure("not recorded, or not what POOLS.toml says: %s" % ", ".join(failed))
    else:
        show(pools, folder, scenes)


if __name__ == "__main__":
    sys.exit(guarded(main, "pools", resumable=True))
