"""How time and memory grow, up to the largest recordings: tools/dev.sh bench limits [--largest 4096] [--print].

Each row is a process of its own: CPU seconds, and the most memory it held itself (anonymous pages; a recording that is
mapped from its file is not counted, as the system can take it back). Recordings of noise over edges are made in the build folder and removed: 4 GB of disk at once. As root on Linux, the recording that is larger than
memory is read inside a control group whose limit it exceeds. Writes the table of docs/limits.md, unless it shall only print.
"""
import os
import sys

import numpy as np

import spool
from tools.bench.limited_run import control_group, run, run_or_end
from tools.bench.speed_page import ROOT, parser_of, publish
from tools.study.tables import markdown

MB = 1e6


class Limits:
    def __init__(self, build):
        self.spool, self.folder = build / "spool", build / "limits"
        self.folder.mkdir(exist_ok=True)
        self.rows = []

    def add(self, what, verb, words, pixels, samples, group=None):
        result = run_or_end("limits", [self.spool, *words, "-q", "--force"], group)
        cpu, own = result["cpu"], result["anonymous"]
        row = (what, verb, f"{cpu:.2f}", f"{cpu / samples * 1e9:.0f}", f"{own / MB:.0f}", f"{own / pixels:.0f}")
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
        self.add(what, "`replay`, multiscale", ["replay", path, "--sampler", "multiscale", "--spp", budget, "-o", selection], pixels, pixels * budget)
        return selection

    def reconstruct(self, what, path, selection, filter, pixels, budget):
        self.add(what, f"`reconstruct`, {filter}", ["reconstruct", path, "--selection", selection, "--filter", filter, "-o", self.folder / "i.exr"],
                 pixels, pixels * budget)

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
        os.posix_fadvise(os.open(path, os.O_RDONLY), 0, 0, os.POSIX_FADV_DONTNEED)
        what, size = f"{width}x{height}, all of {spp}, in {limit / MB:.0f} MB", path.stat().st_size
        with control_group(limit) as group:
            if group:
                self.add(what, "`reconstruct`, box", ["reconstruct", path, "--filter", "box", "-o", self.folder / "i.exr"],
                         width * height, width * height * spp, group)
        path.unlink()
        if not group:
            return "A recording beyond memory was not measured here: no control group."
        return (f"The last recording has {size / 1e9:.1f} GB and was read by a process that could have {limit / 1e9:.2f} GB in "
                "all, the cache of the file included (control group); most of its own memory are blocks that it keeps.")

    def refusal(self, path, pixels):
        done = run([self.spool, "replay", path, "--sampler", "multiscale", "--spp", 1, "--force", "-o", self.folder / "no.exr"],
                   environment={"SPOOL_MEMORY": str(pixels * 100)})
        if done["code"] != 1 or "GB of memory" not in done["told"]:
            sys.exit(f"limits: not refused: exit code {done['code']}: {done['told']}")
        return (f"Refused after {done['wall']:.2f} s and {done['anonymous'] / MB:.0f} MB, with exit code 1, when only "
                f"{pixels * 100 / 1e9:.3g} GB are free:\n\n    {done['told'].replace(str(path), path.name)}")


def main():
    parser = parser_of(__doc__, "docs/limits.md")
    parser.add_argument("--largest", type=int, default=4096, help="pixels along the side of the largest square")
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
    publish("limits", "\n\n".join([markdown(head, limits.rows), *told]), options, ROOT / "docs" / "limits.md")


if __name__ == "__main__":
    main()
