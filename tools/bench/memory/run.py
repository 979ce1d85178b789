"""A recording larger than the memory that its reader may have: tools/dev.sh bench memory [--size N] [--samples N] [--print].

The samples are `--times` (8) times as many bytes as the process may hold. Each command runs with all memory it wants, in a control
group of that limit (as root on Linux; the cache of the file counts there), and under `ulimit -v`; beside them `cat` of the same file.
Once with the file in a file system of memory, which costs nothing but copying, and once from the disk with nothing of it in
the cache. Images must be the same bytes. Writes a section of docs/speed.md, unless it shall only print.
"""
import contextlib
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

import spool
from tools.bench.limited_run import control_group, run_or_end, status
from tools.bench.speed_page import parser_of, publish, turns_text
from tools.study.tables import markdown

METHODS = {"uniform": "replay", "multiscale{tile=64}": "replay", "box": "reconstruct", "gaussian": "reconstruct", "directional": "reconstruct"}
MB = 1e6
SECONDS = 2.0                                   # target: times the run in memory


def write_recording(path, side, samples):
    """A picture with an edge and a gradient, exponential noise; no film positions, plain floats."""
    random, block = np.random.default_rng(1), 16
    y, x = np.mgrid[:side, :side] / side
    mean = (0.2 + x + 2.0 * (x + 2 * y > 1.3))[:, :, None, None] * np.array([1.0, 0.8, 0.6])
    with spool.Writer(path, side, side, samples, {"radiance": ("f4", "RGB")}, block_spp=block, sample_order="exchangeable", force=True) as writer:
        for begin in range(0, samples, block):
            noise = random.exponential(1, (side, side, block, 1))
            writer.write_passes(begin, {"radiance": (mean * noise).astype("f4")})


def forget(path):
    """Out of the cache, so that a control group pays for what it reads."""
    with open(path, "rb") as stream:
        os.fsync(stream.fileno())
        os.posix_fadvise(stream.fileno(), 0, 0, os.POSIX_FADV_DONTNEED)


def least(turns):
    """Of some runs the least time and the most memory."""
    return {key: of(turn[key] for turn in turns) for key, of in (("wall", min), ("cpu", min), ("resident", max), ("read", max))}


class Bench:
    def __init__(self, options):
        self.spool, self.turns, self.share = options.build.resolve() / "spool", options.turns, options.taken
        self.samples, self.threads = options.samples, options.threads

    def addresses(self):
        """What the program and its libraries take of addresses before they do anything."""
        most = 0
        with subprocess.Popen([self.spool, "list"], stdout=subprocess.DEVNULL) as process:
            while process.poll() is None:
                most = max(most, 1024 * status(process.pid, "VmPeak"))
        return most

    def command(self, path, method, out):
        verb = METHODS[method]
        return [self.spool, verb, path, "--sampler" if verb == "replay" else "--filter", method, "--spp", int(self.samples * self.share),
                "--threads", self.threads, "-q", "--force", "-o", out]

    def measure(self, path, folder, limit, addresses, cold):
        """{method: {"all" | "group" | "ulimit": figures}}; `cat` is a method, too."""
        found = {}
        for method in ["cat", *METHODS]:
            ways = {"all": (None, None), "group": (limit, None), **({"ulimit": (None, addresses)} if method != "cat" else {})}
            images, runs = {}, {way: [] for way in ways}
            for _ in range(self.turns):
                for way, (most, limited) in ways.items():
                    with control_group(most) if most else contextlib.nullcontext() as group:
                        if most and group is None:
                            continue
                        if cold:
                            forget(path)
                        out = folder / "image.exr"
                        command = ["cat", path] if method == "cat" else self.command(path, method, out)
                        runs[way].append(run_or_end("memory", command, group, limited))
                    if method != "cat":
                        images[way] = out.read_bytes()
            if len(set(images.values())) > 1:
                sys.exit(f"memory: {method}: another image with less memory")
            found[method] = {way: least(turns) for way, turns in runs.items() if turns}
            print(method, found[method], file=sys.stderr, flush=True)
        return found


def told(value):
    return f"{value:.2f}" if value <= SECONDS else f"**{value:.2f}**"


def rows(found, size, limit):
    lines = []
    for method, ways in found.items():
        base = ways["all"]
        cells = [f"`{method}`", f"{base['cpu']:.2f}, {base['wall']:.2f}"]
        for way in ("group", "ulimit"):
            if way not in ways:
                cells += ["", "", ""]
                continue
            now = ways[way]
            held = f"{now['resident'] / MB:.0f}"
            cells += [f"{told(now['cpu'] / base['cpu'])}, {told(now['wall'] / base['wall'])}", held if now["resident"] <= limit else f"**{held}**", f"{now['read'] / size:.2f}"]
        lines.append(cells)
    return lines


def table(found, size, limit, where):
    head = [where, "in memory: CPU-s, wall s", "control group: times CPU, times wall", "MB resident", "times file read",
            "`ulimit -v`: times CPU, times wall", "MB resident", "times file read"]
    return markdown(head, rows(found, size, limit))


def summary(found, where):
    """The most of every method but `cat`, over its run in memory."""
    most = {way: max(ways[way]["cpu"] / ways["all"]["cpu"] for method, ways in found.items() if method != "cat" and way in ways)
            for way in ("group", "ulimit") if any(way in ways for ways in found.values())}
    said = [f"{most[way]:.2f} times the CPU time {name}" for way, name in (("group", "in a control group"), ("ulimit", "under `ulimit -v`")) if way in most]
    return f"With the file {where}: at most {' and '.join(said)}."


def main():
    parser = parser_of(__doc__)
    parser.add_argument("--size", type=int, default=384, help="pixels a side")
    parser.add_argument("--samples", type=int, default=1024, help="a pixel")
    parser.add_argument("--times", type=float, default=8, help="bytes of samples in bytes that a process may hold")
    parser.add_argument("--taken", type=float, default=0.5, help="share of the samples that a method takes")
    parser.add_argument("--turns", type=int, default=2)
    parser.add_argument("--threads", type=int, default=1)
    options = parser.parse_args()
    bench = Bench(options)
    idle = bench.addresses()
    tables = []
    for where, parent in (("in memory", "/dev/shm"), ("on disk", options.build)):
        with tempfile.TemporaryDirectory(dir=parent, prefix="spool_memory_") as name:
            folder = Path(name)
            path = folder / "long.spool"
            write_recording(path, options.size, options.samples)
            size = path.stat().st_size
            limit = size / options.times
            found = bench.measure(path, folder, limit, int(limit + idle), where == "on disk")
            tables.append(summary(found, where) if where == "in memory" else table(found, size, limit, f"file {where}"))
    text = "\n\n".join([
        "## A recording larger than memory",
        f"`tools/dev.sh bench memory`: {options.size}x{options.size} pixels with {options.samples} samples, {size / 1e9:.2f} GB of plain floats; "
        f"a process may have {limit / MB:.0f} MB, {options.times:g} times less: in a control group, where the cache of the file counts, or as "
        f"`ulimit -v` on top of the {idle / MB:.0f} MB of addresses that the program takes before it does anything. A method takes "
        f"{options.taken:g} of the samples, {options.threads} thread{'s' if options.threads > 1 else ''}; images are the same bytes in every case. Resident "
        f"memory is that of the program, its libraries and what it maps, at its most. The least time of {turns_text(options.turns)}; bold: beyond {SECONDS:g} times the run in memory.",
        *tables])
    publish("memory", text, options)


if __name__ == "__main__":
    main()
