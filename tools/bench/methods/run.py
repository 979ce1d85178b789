"""Time and memory of every sampler and filter: tools/dev.sh bench methods [--sizes 512,1024,2048,4096] [--print].

Scene S with 64 samples a pixel at each size (16 at 4096), budget 8 spp; the recordings are made once, in the build folder (18 GB
for all sizes). Methods that need features run on copies of a small recording that has some. In the library; tools/dev.sh bench vectors
has the whole commands. Sizes and numbers of threads take turns, and of the turns the least counts: what else a machine does only ever
adds. A method is left out at a size where a run would take longer than --longest, by the size before. What was measured is kept in methods.json of the build
folder; tables are written into docs/speed.md, unless they shall only be printed.
"""
import json
import re
import subprocess
import sys
from pathlib import Path

from tools.bench.limited_run import run
from tools.bench.methods.mosaic import write_mosaic
from tools.bench.methods.page import JUDGED, LARGE, YARDSTICK, growth_rows, page
from tools.bench.speed_page import PAGE, parser_of, publish
from tools.report.whole_file import write_whole
from tools.study.tables import as_csv

BUDGET = 8
WARMED = 5.0                                   # seconds; a longer run maps the recording's pages at no cost that counts
SAMPLES, LARGE_SAMPLES = 64, 16
FEATURES = Path("dumps/tiny/chess.spool")      # for methods that require features, which scene S has not


def samples_at(size):
    return LARGE_SAMPLES if size >= LARGE else SAMPLES


class Methods:
    """Measures, and keeps the least of each figure under (size, threads): {method: figures}."""

    def __init__(self, build, longest, wanted, threads, kept):
        self.build, self.longest, self.wanted, self.kept, self.results = build, longest, re.compile(wanted), kept, build / "methods.json"
        self.threads = threads
        self.folder = build / "pools"
        self.folder.mkdir(exist_ok=True)
        listed = subprocess.run([self.program(), FEATURES, "--threads=1", "--benchmark_list_tests=true"], check=True, stdout=subprocess.PIPE,
                                text=True).stdout
        self.names = [re.sub("/t1/.*", "", line) for line in listed.split()]

    def program(self):
        return self.build / "tools" / "bench" / "methods" / "bench_methods"

    def recording(self, size, features):
        path = self.folder / (f"{FEATURES.stem}-{size}.spool" if features else f"scene_s-{size}-{samples_at(size)}.spool")
        if not path.exists() and features:
            write_mosaic(FEATURES, path, size, samples_at(size))
        elif not path.exists():
            subprocess.run([self.build / "spool", "synth", "scene_s", "--size", str(size), "--samples", str(samples_at(size)), "--quiet", "-o",
                            path], check=True)
        with open(path, "rb") as stream:       # into memory, if it fits: the disk is not what is measured
            while stream.read(1 << 24):
                pass
        return path

    def least(self, size, threads, method, now):
        before = self.kept.setdefault((size, threads), {}).setdefault(method, now)
        self.kept[size, threads][method] = {
            key: value if isinstance(value, (str, bool)) else min(value, before.get(key, value)) for key, value in now.items()}
        keep(self.results, self.kept)

    def expected(self, method, size, sizes):
        """Seconds of a run, by a smaller picture; 0 where there is none."""
        smaller = [s for s in sizes if s < size and method in self.kept.get((s, 1), {})]
        found = self.kept[max(smaller), 1][method] if smaller else {}
        return found.get("cpu", found.get("expected", 0)) * (size / max(smaller)) ** 2 if smaller else 0

    def affordable(self, method, size, sizes):
        """False where a run would take too long; that is kept, too."""
        expected = self.expected(method, size, sizes)
        if expected > self.longest:
            self.kept.setdefault((size, 1), {})[method] = {"expected": expected}
        return expected <= self.longest

    def library(self, size, threads, methods, features, warm):
        """One process; the methods that were refused without features. warm: a run before the clock's maps the recording's pages."""
        if not methods:
            return []
        which = "^(" + "|".join(map(re.escape, methods)) + ")/t"
        done = subprocess.run([self.program(), self.recording(size, features), f"--spp={BUDGET}", f"--threads={threads}", "--benchmark_min_time=0.2",
                               *(["--benchmark_min_warmup_time=0.01"] if warm else []), f"--benchmark_filter={which}", "--benchmark_format=json"],
                              check=True, stdout=subprocess.PIPE, text=True)
        refused = []
        for found in json.loads(done.stdout)["benchmarks"]:
            method = "/".join(found["name"].split("/")[:2])
            if found.get("error_occurred"):
                refused.append(method)
            else:
                self.least(size, threads, method, {"cpu": found["cpu_time"] / 1e3, "wall": found["real_time"] / 1e3, "heap": found["heap_per_pixel"],
                                                   "features": features})
        return refused

    def yardstick(self):
        """The whole command of Open Image Denoise, of which the targets are multiples; none where it is not here."""
        command = [self.build / "spool", "reconstruct", self.recording(JUDGED, False), "--spp", BUDGET, "--filter", "oidn{prefilter=off}", "--threads", 1,
                   "-q", "--force", "-o", self.folder / "oidn.exr"]
        found = run(command)
        if found["code"] == 0:
            self.least(JUDGED, 1, YARDSTICK, {"command": min(found["cpu"], run(command)["cpu"])})

    def measure(self, size, sizes):
        say = lambda what: print(f"{size}: {what}", file=sys.stderr, flush=True)
        methods = [m for m in self.names if self.wanted.search(m) and self.affordable(m, size, sizes)]
        quick = [m for m in methods if self.expected(m, size, sizes) < WARMED]
        for threads in self.threads:
            say(f"threads {threads}")
            for chosen, warm in ((quick, True), ([m for m in methods if m not in quick], False)):
                self.library(size, threads, self.library(size, threads, chosen, False, warm), True, warm)


def read_kept(path):
    return {(size, threads): methods for size, threads, methods in json.loads(path.read_text(encoding="utf-8"))}


def keep(path, kept):
    path.write_text(json.dumps([[*kind, methods] for kind, methods in kept.items()], indent=1), encoding="utf-8")


def main():
    parser = parser_of(__doc__)
    parser.add_argument("--sizes", default="512,1024,2048,4096", help="pixels along a side")
    parser.add_argument("--turns", type=int, default=1)
    parser.add_argument("--threads", default="1,2", help="1: on a machine that others use, two say nothing")
    parser.add_argument("--longest", type=float, default=60, help="seconds; what would take longer at a size is left out there")
    parser.add_argument("--methods", default=".*", help="a regular expression, e.g. filter/")
    parser.add_argument("--add", action="store_true", help="keep what was measured last, of which the least counts too")
    parser.add_argument("--again", action="store_true", help="keep what was measured last, except of --methods at --sizes")
    parser.add_argument("--kept", action="store_true", help="measure nothing: tables of what was measured last")
    options = parser.parse_args()
    results = options.build / "methods.json"
    kept = read_kept(results) if options.kept or options.add or options.again else {}
    sizes = sorted(int(size) for size in options.sizes.split(","))
    if options.again:
        kept = {kind: {m: found for m, found in methods.items() if kind[0] not in sizes or not re.search(options.methods, m)}
                for kind, methods in kept.items()}
    if not options.kept:
        bench = Methods(options.build.resolve(), options.longest, options.methods, [int(n) for n in options.threads.split(",")], kept)
        bench.yardstick()
        for _ in range(options.turns):
            for size in sizes:
                bench.measure(size, sorted({kind[0] for kind in kept} | set(sizes)))
    publish("methods", page(kept), options)
    if not options.print:
        head, *rows = growth_rows(kept)
        write_whole(PAGE.parent / "results/speed/sizes.csv", as_csv(head, rows))


if __name__ == "__main__":
    main()
