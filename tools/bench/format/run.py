"""What it costs to keep samples: tools/dev.sh bench format [RECORDING...] [--turns N] [--copies N] [--print].

.spool against memcpy of the same bytes and against OpenEXR (deep; one flat image per sample), all in one thread and in
memory, with the samples of recordings stacked on top of each other; then the 6.4 GB of 4096 x 4096 pixels with 64 half
samples. CPU time, the least of some turns that take turns. Writes docs/format_speed.md and its table, unless it shall only print.
"""
import json
import os
import subprocess
import tempfile
from pathlib import Path

from tools.bench.speed_page import ROOT, parser_of, publish
from tools.report.whole_file import write_whole
from tools.study.tables import as_csv, markdown

RECORDINGS = ["balls", "caustic", "chess", "table"]  # Cycles; the same layers in each
READS, WRITES, OPENS_MS, BLOCK_MS, RSS_MB = 3.0, 5.0, 50.0, 2.0, 1024  # targets


def rate(bytes_, seconds):
    return f"{bytes_ / seconds / 1e9:.2f}"


def times(run):
    """Rows of one set of samples."""
    kinds, deep = run["kinds"], run["kinds"]["deep EXR zips"]
    return [[run["samples"], name, rate(run["bytes"], kind["write"]), f"{deep['write'] / kind['write']:.1f}", rate(run["bytes"], kind["read"]),
             f"{deep['read'] / kind['read']:.1f}", *([f"{run['bytes'] / run['count']:.1f}", ""] if name == "memcpy" else
                                                     [f"{kind['bytes'] / run['count']:.2f}", f"{kind['bytes'] / deep['bytes']:.2f}"])]
            for name, kind in kinds.items()]


def verdicts(runs, large):
    def row(what, target, values, good):
        return [what, target, ", ".join(values), "yes" if good else "**no**"]
    zstd = [run["kinds"]["spool compressed"] for run in runs]
    raw = [run["kinds"]["spool raw"] for run in runs]
    deep = [run["kinds"]["deep EXR zips"] for run in runs]
    reads = [d["read"] / z["read"] for d, z in zip(deep, zstd)]
    writes = [d["write"] / r["write"] for d, r in zip(deep, raw)]
    packed = [d["write"] / z["write"] for d, z in zip(deep, zstd)]
    sizes = [z["bytes"] / d["bytes"] for d, z in zip(deep, zstd)]
    mapped = [run["plain_sum"] / run["mapped"] for run in runs]
    threads = min(8, os.cpu_count())
    opened = large["open_cpu_ms"] / threads
    rows = [["", "target", "measured, by set of samples", "met"],
            row("mapped radiance against memory", "0.8", [f"{x:.2f}" for x in mapped], min(mapped) >= 0.8),
            row("compressed reading against deep EXR", "3", [f"{x:.1f}" for x in reads], min(reads) >= READS),
            row("writing (raw, the default) against deep EXR", "5", [f"{x:.1f}" for x in writes], min(writes) >= WRITES),
            row("compressed writing against deep EXR", "5", [f"{x:.1f}" for x in packed], min(packed) >= WRITES),
            row("compressed size against deep EXR", "1", [f"{x:.2f}" for x in sizes], max(sizes) <= 1),
            row("opening 6.4 GB", "50 ms", [f"{opened:.0f} ms a thread ({large['open_cpu_ms']:.0f} ms of CPU in "
                                            f"{threads} threads)"], opened <= OPENS_MS),
            row("a block of it, warm", "2 ms", [f"{large['block_read_ms']:.2f} ms read, "
                                                f"{large['block_mapped_ms']:.3f} ms mapped"],
                large["block_read_ms"] <= BLOCK_MS),
            row("memory for all of that", "1 GiB", [f"{large['peak_rss_mb']} MiB"], large["peak_rss_mb"] < RSS_MB)]
    return markdown(rows[0], rows[1:])


def main():
    parser = parser_of(__doc__, "docs/format_speed.md")
    parser.add_argument("recordings", nargs="*", type=Path)
    parser.add_argument("--turns", type=int, default=5)
    parser.add_argument("--copies", type=int, default=8, help="how often the recordings are stacked: more than fits a cache")
    chosen = parser.parse_args()
    programs = chosen.build / "tools" / "bench" / "format"
    recordings = chosen.recordings or [ROOT / "dumps" / "tiny" / f"{name}.spool" for name in RECORDINGS]
    memory = "/dev/shm" if os.access("/dev/shm", os.W_OK) else None
    with tempfile.TemporaryDirectory(dir=memory) as folder:
        done = subprocess.run([programs / "bench_format", str(chosen.turns), folder, *recordings * chosen.copies],
                              check=True, stdout=subprocess.PIPE)
    runs = json.loads(done.stdout)
    with tempfile.TemporaryDirectory(dir=chosen.build) as folder:
        done = subprocess.run([programs / "bench_format_large", "4096", Path(folder) / "large.spool"], check=True,
                              stdout=subprocess.PIPE)
    large = json.loads(done.stdout)
    names = ", ".join(path.stem for path in recordings)
    text = (f"Recordings {names}, stacked {chosen.copies} times: {runs[0]['count'] / 1e6:.1f} million samples. "
            f"{chosen.turns} turns.\n\n{verdicts(runs, large)}\n\nEvery rate: [format_speed.csv](results/format_speed.csv).")
    publish("format", text, chosen, ROOT / "docs" / "format_speed.md")
    header = ["samples", "kind", "write GB/s", "write x deep EXR", "read GB/s", "read x deep EXR", "bytes a sample", "bytes of deep EXR"]
    if not chosen.print:
        write_whole(ROOT / "docs/results/format_speed.csv", as_csv(header, (row for run in runs for row in times(run))))


if __name__ == "__main__":
    main()
