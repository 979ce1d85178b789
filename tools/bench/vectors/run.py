"""Every method beside Open Image Denoise, and what AVX-512 gains: tools/dev.sh bench vectors [--turns N] [--size N] [--methods REGEX] [--print].

Whole commands of every method with the program as it is and with a copy of it whose functions of several clones take the one for
AVX2 (lib/core/vector_clones.h), all methods in turns, the least CPU time of each; both images are compared. Needs a processor with AVX-512,
and SPOOL_OIDN.
Results go to docs/results/speed/vectors.csv, and a section of docs/speed.md, unless it shall only print.
"""
import json
import re
import struct
import subprocess
import sys
from pathlib import Path

from tools.bench.limited_run import run
from tools.bench.methods.mosaic import write_mosaic
from tools.bench.methods.page import machine
from tools.bench.speed_page import PAGE, parser_of, publish
from tools.report.whole_file import write_whole
from tools.study.tables import as_csv, markdown

FEATURES = Path("dumps/tiny/chess.spool")
TEST = b"\xf6\x40\x08\x04"                      # testb $4, 8(%rax): GCC's question for x86-64-v4 in a resolver; with 0 the answer is no
OIDN = "filter/oidn{prefilter=off}"
LEAST = 0.8                                     # of Open Image Denoise: what costs less is not in the table
FEATURES_TOO = ["sampler/cross_bilateral", "filter/cross_bilateral", "filter/twin_guides", OIDN]  # with features, beside those that need them


def without_avx512(program, copy):
    """A copy that takes the clones of a processor without AVX-512."""
    data = bytearray(program.read_bytes())
    (headers,), (count,) = struct.unpack_from("<Q", data, 32), struct.unpack_from("<H", data, 56)
    segments = [struct.unpack_from("<IIQQQQ", data, headers + 56 * i) for i in range(count)]
    symbols = subprocess.run(["nm", "-S", "--defined-only", program], check=True, capture_output=True, text=True).stdout
    switched = 0
    for address, size, _, name in (line.split() for line in symbols.splitlines() if len(line.split()) == 4):
        if not name.endswith(".resolver"):
            continue
        address, size = int(address, 16), int(size, 16)
        at = next(offset + address - start for kind, _, offset, start, _, length in segments if kind == 1 and start <= address < start + length)
        found = data.find(TEST, at, at + size)
        if found < 0:
            sys.exit(f"vectors: {name} asks in another way: {program} is of another compiler")
        data[found + 3], switched = 0, switched + 1
    if switched == 0:
        sys.exit(f"vectors: {program} has no clones, or no symbols")
    copy.write_bytes(data)
    copy.chmod(0o755)


def cpu_of(words):
    found = run(words)
    return found["cpu"] if found["code"] == 0 else None


def command(program, method, paths, out):
    """`method`: kind/name; `paths`: of the recording and of a selection."""
    kind, name = method.split("/")
    words = ["replay", paths[0], "--spp", 8, "--sampler", name] if kind == "sampler" else ["reconstruct", paths[0], "--selection", paths[1], "--filter", name]
    return [program, *words, "--threads", 1, "-q", "--force", "-o", out]


def measure(program, copy, folder, size, turns, wanted):
    """{(method, with features): (as it is, without), CPU seconds}."""
    plain, features = folder / f"scene_s-{size}.spool", folder / f"chess-{size}.spool"
    cpu_of([program, "synth", "scene_s", "--size", size, "--samples", 64, "-q", "--force", "-o", plain])
    if not features.exists():
        write_mosaic(FEATURES, features, size, 64)
    paths = [(path, path.with_suffix(".exr")) for path in (plain, features)]
    for path, selection in paths:
        cpu_of([program, "replay", path, "--spp", 8, "--sampler", "multiscale", "--threads", 1, "-q", "--force", "-o", selection])
    if cpu_of(command(program, OIDN, paths[0], folder / "a.exr")) is None:
        sys.exit("vectors: no Open Image Denoise, of which all times are multiples: set SPOOL_OIDN to the folder of its library")
    listed = json.loads(subprocess.run([program, "list", "--json"], check=True, capture_output=True, text=True).stdout)
    methods = [f"{kind[:-1]}/{name}" for kind in ("samplers", "filters") for name in listed[kind] if name != "oidn"]
    left = [(m, False) for m in methods + [OIDN] if m == OIDN or re.search(wanted, m)] + [(m, True) for m in FEATURES_TOO if m == OIDN or re.search(wanted, m)]
    found = {}
    for _ in range(turns):
        for method, with_features in left:
            times = cpu_of(command(program, method, paths[with_features], folder / "a.exr")), cpu_of(command(copy, method, paths[with_features], folder / "b.exr"))
            if None in times:                   # needs features, or more words
                continue
            if (folder / "a.exr").read_bytes() != (folder / "b.exr").read_bytes():
                sys.exit(f"vectors: {method}: the two programs differ")
            least = found.setdefault((method, with_features), times)
            found[method, with_features] = tuple(map(min, zip(least, times)))
            print(f"{method}: {times[0]:.2f}, {times[1]:.2f}", file=sys.stderr, flush=True)
    return found


def page(found, size, turns):
    rows = [["method", "CPU-s/MP", "times Open Image Denoise", "with AVX2 alone"]]
    for (method, features), times in sorted(found.items(), key=lambda item: item[1][0]):
        shown = [f"{seconds / least:.2f}" for seconds, least in zip(times, found[OIDN, features])]
        if float(shown[0]) < LEAST:
            continue
        rows.append([f"{method.split('/')[0]} `{method.split('/')[1]}`" + "*" * features, f"{times[0] / size**2 * 1e6:.2f}", *shown])
    return "\n\n".join([
        "## Beside Open Image Denoise, on two kinds of processor",
        f"`tools/dev.sh bench vectors`: whole commands at {size}x{size} pixels of scene S, 8 of 64 samples, one thread, with the clones for AVX-512 and with those for AVX2, "
        f"on {machine()}, the least of {turns} turns in which every method ran; the images are the same bytes. A star: on a picture with features "
        f"(`dumps/tiny/chess.spool`, mirrored), which Open Image Denoise got, too. What takes less than {LEAST} of it: "
        "[vectors.csv](results/speed/vectors.csv).", markdown(rows[0], rows[1:])])


def main():
    parser = parser_of(__doc__, "docs/")
    parser.add_argument("--turns", type=int, default=2)
    parser.add_argument("--size", type=int, default=512)
    parser.add_argument("--methods", default=".*", help="a regular expression, e.g. filter/")
    options = parser.parse_args()
    program, folder = options.build.resolve() / "spool", options.build.resolve() / "vectors"
    folder.mkdir(exist_ok=True)
    copy = folder / "spool"
    without_avx512(program, copy)
    found = measure(program, copy, folder, options.size, options.turns, options.methods)
    publish("vectors", page(found, options.size, options.turns), options)
    if not options.print:
        write_whole(PAGE.parent / "results/speed/vectors.csv", as_csv(("method", "features", "with AVX-512, CPU-s", "without, CPU-s"), (
            (method, int(features), f"{whole:.3f}", f"{without:.3f}") for (method, features), (whole, without) in found.items())))


if __name__ == "__main__":
    main()
