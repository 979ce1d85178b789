"""How time and memory grow, up to the largest recordings: tools/dev.sh bench limits [--largest 4096] [--print].

Each row is a process of its own: CPU seconds, and the most memory it held itself (anonymous pages; a recording that is
mapped from its file is not counted, as the system can take it back). Recordings of noise over edges are made in the build folder and removed: 4 GB of disk at once. As root on Linux, the recording that is larger than
memory is read inside a control group whose limit it exceeds. Writes docs/limits.md, unless it shall only print.
"""
import argparse
import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

import spool

ROOT = Path(__file__).resolve().parents[3]

PAGE = ROOT / "docs" / "limits.md"
GROUPS = Path("/sys/fs/cgroup/memory")     # version 1; version 2 has memory.max in /sys/fs/cgroup
MB = 1e6
TEXT = """# Limits

How time and memory grow with pixels and samples, measured up to what one machine holds, and what happens beyond.
Written by `tools/dev.sh bench limits`; the source is `tools/bench/limits`.

| what | limit | what happens there |
|---|---|---|
| width, height | 65536 each, 2^28 pixels together | `synth`, `pack` and the recorders refuse before work; a file that says more is refused at opening |
| samples a pixel | 65536 | the same |
| layers, blocks, records | `formats/spool.md`, section 6 | the same |
| budget | the samples recorded, less those held out | the program refuses before work, the library stops there and says so |
| memory | 130 to 420 bytes a pixel by method (in its value, `memory`), 12 bytes a sample of radiance that cannot be mapped (half floats, compressed), 8 bytes a sample of film positions that cannot and that a method asks for | `replay`, `reconstruct` and `evaluate` compare what a recording needs with what is free, what control groups and `ulimit -v` and `-d` leave, and `SPOOL_MEMORY` (bytes), and read it block by block, or refuse before work; pictures, views and quarter pixels are estimated roughly |
| disk | 12 bytes a sample in f32, 6 in f16 | recorders and `synth` stop with exit code 3; what was written can be recovered |

A recording in f32 without compression is mapped, others are decoded into memory, while that and the work fit. A larger one is
read block by block ([decision 0091](decisions.md#0091-a-recording-larger-than-memory-is-read-block-by-block)): statistics go tile by tile and through the blocks of
a tile in their order. What that costs beside the same in memory: [speed.md](speed.md#a-recording-larger-than-memory).

A sampler that comes back to a tile in steps is cheap while the samples of one tile fit (64 x 64 pixels of 1024 samples: 50 MB), and
reads again and again where they do not: under `ulimit -v` the program's own address space counts, too. `multistage` reads the
file four to six times. A method that takes single samples from all over the picture (replicates, `multiscale` without tiles at many
samples) reads blocks as often as they leave what is kept. `tests/tools/test_memory.py` runs the same on 74 MB in 9 MB.

Time grows with pixels and, much slower, with samples; memory with pixels only: a machine of 24 GB holds 4096x4096 with every method. Layers recorded beside radiance (half floats here) cost those methods that ask for them, and the others
nothing.

"""


def anonymous_memory(process):
    """Bytes that the process holds besides files; 0 once it has ended."""
    try:
        for line in Path(f"/proc/{process}/status").read_text(encoding="ascii").splitlines():
            if line.startswith("RssAnon:"):
                return int(line.split()[1]) * 1024
    except (FileNotFoundError, ProcessLookupError):
        pass
    return 0


def run(*command, group=None, environment=None):
    """Exit code, CPU seconds, most anonymous bytes, last line of standard error."""
    def enter():
        if group:
            (group / "cgroup.procs").write_text(str(os.getpid()), encoding="ascii")

    process = subprocess.Popen([str(c) for c in command], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                               preexec_fn=enter, env={**os.environ, **(environment or {})})
    anonymous = 0
    while True:
        ended, status, usage = os.wait4(process.pid, os.WNOHANG)
        if ended:
            break
        anonymous = max(anonymous, anonymous_memory(process.pid))
        time.sleep(0.005)
    process.returncode = os.waitstatus_to_exitcode(status)
    said = process.stderr.read().strip().splitlines()
    return process.returncode, usage.ru_utime + usage.ru_stime, anonymous, said[-1] if said else ""


class Limits:
    def __init__(self, build):
        self.spool, self.folder = build / "spool", build / "limits"
        self.folder.mkdir(exist_ok=True)
        self.rows = []

    def add(self, what, verb, result, pixels, samples):
        code, cpu, anonymous, said = result
        if code != 0:
            sys.exit(f"limits: {what}, {verb}: exit code {code}: {said}")
        row = (what, verb, f"{cpu:.2f}", f"{cpu / samples * 1e9:.0f}", f"{anonymous / MB:.0f}", f"{anonymous / pixels:.0f}")
        self.rows.append(row)
        print("| " + " | ".join(row) + " |", file=sys.stderr, flush=True)

    def recording(self, width, height, spp, layers=()):
        """Exponential noise over an edge in each tile; every block is another part of one piece of noise.

        `layers` are recorded beside radiance, in half floats."""
        path = self.folder / "noise.spool"
        noise = np.random.default_rng(1).exponential(size=2 ** 21).astype(np.float32)
        channels = {"radiance": (np.float32, "RGB"), **{name: (np.float16, parts) for name, parts in layers}}
        with spool.Writer(path, width, height, spp, channels, block_spp=min(spp, 64), force=True) as writer:
            for begin in range(0, spp, min(spp, 64)):
                for tile in range(writer.geometry.tile_count("sample")):
                    begins = (tile * 7919 + begin * 104729) % (noise.size // 2)
                    for name, (dtype, parts) in channels.items():
                        shape = writer.geometry.block_shape("sample", len(parts), tile, begin)
                        block = np.resize(noise[begins:begins + noise.size // 2], shape)
                        y, x = np.mgrid[:shape[1], :shape[2]]
                        block = block * np.where(x + 2 * y > 70, 1.0, 0.3)[..., None]
                        writer.write_block(name, tile, begin, block.astype(dtype))
        return path

    def replay(self, what, path, pixels, budget):
        """Image of sample counts, made with `multiscale`."""
        selection = self.folder / "selection.exr"
        self.add(what, "`replay`, multiscale", run(self.spool, "replay", path, "--sampler", "multiscale", "--spp", budget, "-q",
                                                   "--force", "-o", selection), pixels, pixels * budget)
        return selection

    def reconstruct(self, what, path, selection, filter, pixels, budget):
        self.add(what, f"`reconstruct`, {filter}",
                 run(self.spool, "reconstruct", path, "--selection", selection, "--filter", filter, "-q", "--force", "-o",
                     self.folder / "i.exr"), pixels, pixels * budget)

    def measure(self, width, height, spp, budget):
        path, what = self.recording(width, height, spp), f"{width}x{height}, {budget} of {spp}"
        selection = self.replay(what, path, width * height, budget)
        self.reconstruct(what, path, selection, "directional", width * height, budget)
        return path

    def measure_channels(self, side):
        """What is recorded beside radiance costs the methods that ask for it, and no other."""
        few = [("albedo", "RGB"), ("normal", "XYZ"), ("depth", "Z")]
        many = few + [(f"light{number}", "RGB") for number in range(12)]
        for layers in ((), few, many):
            path = self.recording(side, side, 8, layers)
            what = f"{side}x{side}, 4 of 8, {3 + sum(len(parts) for _, parts in layers)} channels"
            selection = self.replay(what, path, side * side, 4)
            if layers:
                self.reconstruct(what, path, selection, "cross_bilateral", side * side, 4)

    def beyond_memory(self, width, height, spp, limit):
        """A recording larger than the memory that its reader may have."""
        path = self.recording(width, height, spp)
        group = GROUPS / "spool_limits"
        try:
            group.mkdir(exist_ok=True)
            (group / "memory.limit_in_bytes").write_text(str(limit), encoding="ascii")
        except OSError as problem:
            path.unlink()
            return f"A recording beyond memory was not measured here: no control group ({problem})."
        os.posix_fadvise(os.open(path, os.O_RDONLY), 0, 0, os.POSIX_FADV_DONTNEED)
        what = f"{width}x{height}, all of {spp}, in {limit / MB:.0f} MB"
        size = path.stat().st_size
        self.add(what, "`reconstruct`, box", run(self.spool, "reconstruct", path, "--filter", "box", "-q", "--force", "-o",
                                                 self.folder / "i.exr", group=group), width * height, width * height * spp)
        path.unlink()
        return (f"The last recording has {size / 1e9:.1f} GB and was read by a process that could have {limit / 1e9:.2f} GB in "
                "all, the cache of the file included (control group).")

    def refusal(self, path, pixels):
        began = time.monotonic()
        code, _, anonymous, said = run(self.spool, "replay", path, "--sampler", "multiscale", "--spp", 1, "--force", "-o",
                                            self.folder / "no.exr", environment={"SPOOL_MEMORY": str(pixels * 300)})
        if code != 1 or "GB of memory" not in said:
            sys.exit(f"limits: not refused: exit code {code}: {said}")
        said = said.replace(str(path), path.name)
        return (f"Refused after {time.monotonic() - began:.2f} s and {anonymous / MB:.0f} MB, with exit code 1, when only "
                f"{pixels * 300 / 1e9:.3g} GB are free:\n\n    {said}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=Path)
    parser.add_argument("--largest", type=int, default=4096, help="pixels along the side of the largest square")
    parser.add_argument("--print", action="store_true", help="leave docs/limits.md alone")
    options = parser.parse_args()
    limits = Limits(options.build)
    side = options.largest
    for spp, budget in ((64, 4), (64, 32)):
        limits.measure(side // 8, side // 8, spp, budget)
    for divisor in (8, 4, 2, 1):
        path = limits.measure(side // divisor, side // divisor, 8, 4)
    told = [limits.refusal(path, side * side)]
    limits.measure(65536, max(1, side // 256), 8, 4)
    limits.measure(side // 64, side // 64, 65536, 8192)
    limits.measure_channels(side // 4)
    told.insert(0, limits.beyond_memory(side // 4, side // 4, 1024, side * side // 16 * 9800))
    head = ("recording", "step", "CPU-s", "ns a sample", "own memory, MB", "bytes a pixel")
    table = ["| " + " | ".join(head) + " |", "|---" * len(head) + "|", *("| " + " | ".join(r) + " |" for r in limits.rows)]
    text = TEXT + "\n".join(table) + "\n\n" + "\n\n".join(told) + "\n"
    print(text)
    if not options.print:
        PAGE.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
