"""Time and memory of every sampler and filter: tools/dev.sh bench methods [--sizes 512,1024,2048] [--print].

Scene S with 64 samples a pixel at each size, budget 8 spp; the recordings are made once, in the build folder
(1.4 GB at 1024x1024). Sizes and numbers of threads take turns, and of the turns the least CPU time and the least wall
time count: what else a machine does only ever adds. What was measured is kept
in methods.json of the build folder; tables are written into docs/speed.md, unless they shall only be printed.
"""
import argparse
import json
import os
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from mosaic import write_mosaic  # noqa: E402
from speed_page import replace_section  # noqa: E402

SAMPLES, BUDGET = 64, 8
JUDGED = 1024                                  # pixels along a side of the picture that the targets speak of
SECONDS = {"sampler/multiscale": 1.5, "filter/directional": 0.5}
PAIRS = {("sampler/greedy_error", "filter/greedy_selection"): 5.0}
# For methods that want features, which scene S has not: copies of a small dump, and the key of what is measured on it.
FEATURES, MOSAIC_SIZE, MOSAIC = Path("dumps/tiny/chess.spool"), 512, 0
OTHERS, BYTES, TWO_THREADS, LARGE = 10.0, 300, 1.8, 1.1


def recording(build, size):
    path = build / "pools" / f"scene_s-{size}.spool"
    if not path.exists():
        path.parent.mkdir(exist_ok=True)
        subprocess.run([build / "spool", "synth", "scene_s", "--size", str(size), "--samples", str(SAMPLES), "--quiet",
                        "-o", path], check=True)
    with open(path, "rb") as stream:           # into memory, if it fits: the disk is not what is measured
        while stream.read(1 << 24):
            pass
    return path


def mosaic(build):
    path = build / "pools" / f"{FEATURES.stem}-{MOSAIC_SIZE}.spool"
    if not path.exists():
        path.parent.mkdir(exist_ok=True)
        write_mosaic(FEATURES, path, MOSAIC_SIZE)
    return path


def turn(build, path, threads, which):
    """{method: {cpu, wall, heap}} of one process; seconds and bytes a pixel."""
    done = subprocess.run([build / "tools" / "bench" / "methods" / "bench_methods", path, f"--spp={BUDGET}",
                           f"--threads={threads}", "--benchmark_min_time=0.2", f"--benchmark_filter={which}",
                           "--benchmark_format=json"], check=True, stdout=subprocess.PIPE, text=True)
    found = {}
    for run in json.loads(done.stdout)["benchmarks"]:
        method = "/".join(run["name"].split("/")[:2])
        if run.get("error_occurred"):
            found[method] = {"refused": run["error_message"]}
        else:
            found[method] = {"cpu": run["cpu_time"] / 1e3, "wall": run["real_time"] / 1e3, "heap": run["heap_per_pixel"]}
    return found


def measure(build, sizes, turns, which, best, results):
    """Adds to {(size, threads): {method: least of each figure}}, and keeps it."""
    paths = {size: recording(build, size) for size in sizes}
    paths[MOSAIC] = mosaic(build)
    kinds = [(size, threads) for size in paths for threads in ((1, 2) if size == JUDGED else (1,))]
    for kind in kinds:
        best.setdefault(kind, {})
    for _ in range(turns):
        for kind in kinds:
            print(f"{kind[0] or 'mosaic'}, threads {kind[1]}", file=sys.stderr, flush=True)
            for method, now in turn(build, paths[kind[0]], kind[1], which).items():
                least = best[kind].setdefault(method, now)
                best[kind][method] = {key: now[key] if key == "refused" else min(least[key], now[key]) for key in now}
            keep(results, best)


def read_kept(path):
    kept = json.loads(path.read_text(encoding="utf-8"))
    return {(size, threads): methods for size, threads, methods in kept if size != 64}  # 64: before there was a mosaic


def keep(path, best):
    path.write_text(json.dumps([[*kind, methods] for kind, methods in best.items()], indent=1), encoding="utf-8")


def told(value, digits, holds):
    return f"{value:.{digits}f}" if holds else f"**{value:.{digits}f}**"


def row(method, best, sizes):
    one, two = (best.get((JUDGED, threads), {}).get(method) for threads in (1, 2))
    if one is None or "refused" in one:
        return None
    limit = SECONDS.get(method, OTHERS)
    cells = [f"`{method.split('/')[1]}`", told(one["cpu"], 3, one["cpu"] <= limit), f"{limit:g}",
             told(one["heap"], 0, one["heap"] <= BYTES)]
    if two:
        speedup = one["wall"] / two["wall"]
        cells.append(told(speedup, 2, speedup >= TWO_THREADS))
    pixels = {size: best[size, 1][method]["cpu"] / size ** 2 for size in sizes if method in best[size, 1]}
    cells += [f"{pixels[size] * 1e6:.3f}" if size in pixels else "" for size in sizes]
    growth = pixels[sizes[-1]] / pixels[sizes[0]] if {sizes[0], sizes[-1]} <= set(pixels) else None
    cells.append("" if growth is None else told(growth, 2, growth <= LARGE))
    return "| " + " | ".join(cells) + " |"


def table(kind, best, sizes):
    names = [method for method in best[JUDGED, 1] if method.startswith(kind + "/")]
    head = [kind, "CPU-s", "target", "bytes/pixel", *(["2 threads, times faster"] if best.get((JUDGED, 2)) else []), *(f"us/pixel at {s}" for s in sizes),
            f"{sizes[-1]} / {sizes[0]}"]
    rows = [line for line in (row(name, best, sizes) for name in names) if line]
    return "\n".join(["| " + " | ".join(head) + " |", "|---" * len(head) + "|", *rows])


def machine():
    with open("/proc/cpuinfo", encoding="utf-8") as stream:
        model = next((line.split(":")[1].strip() for line in stream if line.startswith("model name")), "unknown")
    return f"{model}, {os.cpu_count()} cores"


def page(best, sizes):
    text = [f"CPU seconds of one thread at {JUDGED}x{JUDGED} pixels, {BUDGET} spp of {SAMPLES}, scene S; filters get the",
            f"selection of `multiscale`. {machine()}; least of some turns. A bold figure misses its target: the seconds",
            f"named, {BYTES} bytes a pixel beside the mapped recording (for a filter with all that it reads), {TWO_THREADS} times faster",
            f"on two threads, {LARGE} times the cost of a pixel at the largest size.", ""]
    for kind in ("sampler", "filter"):
        text += [table(kind, best, sizes), ""]
    for pair, limit in PAIRS.items():
        if all(method in best[JUDGED, 1] for method in pair):
            both = sum(best[JUDGED, 1][method]["cpu"] for method in pair)
            text.append(f"`{pair[0].split('/')[1]}` with `{pair[1].split('/')[1]}`: {both:.2f} CPU-s together, target {limit:g}.")
    text.append("")
    for method, found in best[JUDGED, 1].items():
        other = best.get((MOSAIC, 1), {}).get(method)
        if "refused" in found and other and "refused" not in other:
            text.append(f"`{method}` needs features, which scene S has not. On {MOSAIC_SIZE}x{MOSAIC_SIZE} pixels of copies of "
                        f"`{FEATURES}`: {other['cpu'] / MOSAIC_SIZE ** 2 * 1e6:.2f} us/pixel, so "
                        f"{other['cpu'] * (JUDGED / MOSAIC_SIZE) ** 2:.1f} CPU-s "
                        f"at {JUDGED}x{JUDGED} (target {SECONDS.get(method, OTHERS):g}); {other['heap']:.0f} bytes/pixel.")
    return "\n".join(text)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=Path)
    parser.add_argument("--sizes", default="512,1024,2048", help="pixels along a side")
    parser.add_argument("--turns", type=int, default=3)
    parser.add_argument("--methods", default=".*", help="a regular expression, e.g. filter/")
    parser.add_argument("--print", action="store_true", help="leave docs/speed.md alone")
    parser.add_argument("--add", action="store_true", help="keep what was measured last, of which the least counts too")
    parser.add_argument("--kept", action="store_true", help="measure nothing: tables of what was measured last")
    options = parser.parse_args()
    results = options.build / "methods.json"
    best = read_kept(results) if options.kept or options.add else {}
    if not options.kept:
        measure(options.build, [int(size) for size in options.sizes.split(",")], options.turns, options.methods, best,
                results)
    if (JUDGED, 1) not in best:
        parser.error(f"{JUDGED} must be among the sizes: the targets speak of it")
    text = page(best, sorted({size for size, _ in best} - {MOSAIC}))
    print(text)
    if not options.print:
        replace_section("methods", text)


if __name__ == "__main__":
    main()
