"""Damaged dumps to the C++ and to the numpy implementation: the same verdict, the same samples.

    SPOOL_ROUNDTRIP_TOOL=build/release/tests/formats_python/spool_roundtrip_tool \\
      python3 tests/formats_python/differential_fuzz.py --executions 1000000

Each batch of 500 damaged golden files has a generator of its own, seeded with its number, so that a share of the batches
(--first) can run on each core. What the two do not agree on is kept in build/fuzz/found.
"""
import argparse
import os
import pathlib
import subprocess
import sys
import tempfile
import zlib

from conftest import ROOT  # also says where the package spool is

import numpy as np
import spool

TOOL = os.environ.get("SPOOL_ROUNDTRIP_TOOL")
SEED, BATCH = 23, 500


def tool(verb, *paths):
    done = subprocess.run([TOOL, verb, *map(str, paths)], capture_output=True, text=True, check=True)
    return done.stdout.splitlines()


def mutated(rng, good, other):
    """One to three of the damages that files meet; half of the time with right checksums."""
    data = bytearray(good)
    for _ in range(int(rng.integers(1, 4))):
        kind, at = int(rng.integers(0, 7)), int(rng.integers(0, len(data)))
        unit = at // 64 * 64
        if kind == 0:
            data[at] ^= 1 << int(rng.integers(0, 8))
        elif kind == 1:
            data[at] = int(rng.choice([0, 1, 127, 128, 255]))
        elif kind == 2:
            del data[max(at, 1):]
        elif kind == 3:
            data[unit:unit + 64] = other[unit:unit + 64]
        elif kind == 4:
            del data[unit:unit + 64 * int(rng.integers(1, 4))]
        elif kind == 5:
            data[unit:unit] = data[unit:unit + 64]
        else:
            data[at:at + 4] = int(rng.integers(0, 2**32)).to_bytes(4, "little")
        if not data:
            data = bytearray(good[:1])
    if rng.random() < 0.5:
        for unit in range(0, len(data) - 63, 64):  # lies with right checksums reach the rules behind them
            if data[unit:unit + 4] == b"\x9eREC":
                stored = int.from_bytes(data[unit + 24:unit + 32], "little")
                if stored <= len(data) - unit - 64:
                    data[unit + 40:unit + 44] = zlib.crc32(data[unit + 64:unit + 64 + stored]).to_bytes(4, "little")
            if unit == 0 or unit == len(data) - 64 or data[unit:unit + 4] == b"\x9eREC":
                data[unit + 60:unit + 64] = zlib.crc32(data[unit:unit + 60]).to_bytes(4, "little")
    return bytes(data)


def damaged_golden_files(folder, batch, count=BATCH):
    """Paths of `count` damaged golden files, the same ones for the same batch."""
    golden = [path.read_bytes() for path in sorted((ROOT / "tests" / "golden" / "v1.0").glob("*.spool"))]
    assert len(golden) >= 64
    rng, paths = np.random.default_rng([SEED, batch]), []
    for number in range(count):
        good, other = (golden[int(i)] for i in rng.integers(0, len(golden), 2))
        paths.append(folder / f"{number}.bad")
        paths[-1].write_bytes(mutated(rng, good, other))
    return paths


def opened(path):
    """(exit code of opening, digest of all blocks as spool_roundtrip_tool.cpp defines it)."""
    try:
        with spool.open(path) as dump:
            digest = 0
            for key in sorted(dump.blocks()):
                try:
                    word = zlib.crc32(dump.block(*key).tobytes())
                except spool.SpoolError as reason:
                    word = reason.code
                digest = zlib.crc32(np.array([digest, word], "<u4").tobytes())
            return 0, digest
    except spool.SpoolError as reason:
        return reason.code, None


def differences(paths):
    """How many files open, and [(path, text)] where the two differ: exit codes of open and check, bytes of samples."""
    found, accepted = [], 0
    for path, cpp_samples, cpp_check in zip(paths, tool("samples", *paths), tool("check", *paths), strict=True):
        code, digest = opened(path)
        accepted += code == 0
        numpy_samples = f"0 {digest}" if code == 0 else str(code)
        if numpy_samples != (cpp_samples if code == 0 else cpp_samples.split()[0]):
            found.append((path, f"samples of {path.name}: numpy {numpy_samples}, C++ {cpp_samples}"))
        report = spool.check(path)
        worst = report.errors[0].code if report.errors else 0
        if worst != int(cpp_check.split()[0]):
            found.append((path, f"check of {path.name}: numpy {worst} {report}, C++ {cpp_check}"))
    return accepted, found


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--executions", type=int, default=10_000, help="damaged files, rounded up to a batch of 500")
    parser.add_argument("--first", type=int, default=0, help="number of the first batch")
    arguments = parser.parse_args()
    if TOOL is None:
        parser.error("SPOOL_ROUNDTRIP_TOOL does not name the program spool_roundtrip_tool")
    kept_in = ROOT / "build" / "fuzz" / "found"
    batches = range(arguments.first, arguments.first + -(-arguments.executions // BATCH))
    accepted, failed = 0, 0
    with tempfile.TemporaryDirectory() as folder:
        for batch in batches:
            opened_here, found = differences(damaged_golden_files(pathlib.Path(folder), batch))
            accepted += opened_here
            for path, text in found:
                kept_in.mkdir(parents=True, exist_ok=True)
                kept = kept_in / f"numpy_differential_{batch}_{path.name}"
                kept.write_bytes(path.read_bytes())
                print(f"{kept.relative_to(ROOT)}: {text}", flush=True)
                failed += 1
            if (batch + 1) % 100 == 0:
                print(f"numpy_differential: batch {batch + 1} of {batches.stop}", file=sys.stderr, flush=True)
    print(f"numpy_differential: {len(batches) * BATCH} executions, {accepted} opened, {failed} differences")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
