#!/usr/bin/env python3
"""The recordings that dumps/CATALOG.toml lists.

    python3 dumps/catalogue.py                      what there is
    python3 dumps/catalogue.py --command chess      the command that made the small recording
    python3 dumps/catalogue.py --full chess ...     the arguments of the full one; later options win
    python3 dumps/catalogue.py --measure            writes sizes, hashes and previews anew (needs numpy)
"""
import argparse
import hashlib
import os
import re
import shlex
import sys

import tomllib

sys.path.insert(0, os.path.abspath(os.path.join(__file__, "..", "..")))
sys.path.insert(1, os.path.join(sys.path[0], "formats", "python"))

from dumps.pool_run import RECORDERS, cache
from dumps.recording.failure import guarded, one_line

HERE = os.path.dirname(os.path.abspath(__file__))
PATH = os.path.join(HERE, "CATALOG.toml")
MEASURED = ("bytes", "sha256", "size", "samples", "seconds")


def catalogue():
    with open(PATH, "rb") as stream:
        return tomllib.load(stream)


def small_command(entry):
    packing = ["--compress"] if entry["renderer"] == "Cycles" else []
    return shlex.join([RECORDERS[entry["renderer"]], *entry["arguments"], "--size", str(entry["size"][0]), "--samples", str(entry["samples"]),
                       "--reference", str(entry["reference"]), *packing, "-o", "dumps/" + entry["file"]])


def full_arguments(entry, full, more):
    """What is not said in `more` is as the catalogue says. `{scenes}` is where dumps/pools.py looks for scenes by others."""
    entry = {**entry, "arguments": [text.replace("{scenes}", cache("SPOOL_SCENES", "scenes")) for text in entry["arguments"]]}
    out = [RECORDERS[entry["renderer"]], *entry["arguments"], *more]
    for option, value in full.items():
        if "--" + option not in more:
            out += ["--" + option, str(value)]
    if "-o" not in more and "--out" not in more:
        out += ["-o", entry["name"] + ".spool"]
    if entry["renderer"] == "Cycles" and "--compress" not in more:
        out.append("--compress")
    return out


def measure(entry):
    """{key of MEASURED: value} of the file, and its preview as rows of 8-bit RGB."""
    import spool
    path = os.path.join(HERE, entry["file"])
    with open(path, "rb") as stream:
        digest = hashlib.sha256(stream.read()).hexdigest()
    with spool.open(path) as dump:
        all_samples = dump.width * dump.height * (dump.spp + dump.meta["reference"]["samples"])
        found = {"bytes": os.path.getsize(path), "sha256": digest, "size": [dump.width, dump.height],
                 "samples": dump.spp, "seconds": round(dump.meta["cost_per_sample"] * all_samples)}
        return found, preview(dump.pixel("reference"))


def preview(image):
    """Linear RGB [y][x][c] -> uint8, three dots a pixel, the brightest twentieth left to burn out."""
    import numpy as np
    image = np.maximum(image.astype(np.float64), 0)
    white = np.quantile(image.max(axis=2), 0.95)
    light = np.clip(image / max(white, 1e-9), 0, 1)
    light = np.where(light < 0.0031308, 12.92 * light, 1.055 * np.maximum(light, 1e-9) ** (1 / 2.4) - 0.055)
    return np.repeat(np.repeat((light * 255 + 0.5).astype(np.uint8), 3, axis=0), 3, axis=1)


def png_bytes(rgb):
    import struct
    import zlib
    height, width, _ = rgb.shape

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = b"".join(b"\0" + rgb[y].tobytes() for y in range(height))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)) + \
        chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b"")


def write_measured():
    with open(PATH, encoding="utf-8") as stream:
        text = stream.read()
    head, *parts = text.split("[[recording]]\n")
    entries = catalogue()["recording"]
    for i, entry in enumerate(entries):
        found, picture = measure(entry)
        lines = [line for line in parts[i].rstrip("\n").split("\n") if not re.match(r"(%s) = " % "|".join(MEASURED), line)]
        lines += ["%s = %s" % (key, '"%s"' % value if isinstance(value, str) else value) for key, value in found.items()]
        parts[i] = "\n".join(lines) + ("\n\n" if i + 1 < len(entries) else "\n")
        with open(os.path.join(HERE, entry["preview"]), "wb") as stream:
            stream.write(png_bytes(picture))
    with open(PATH, "w", encoding="utf-8") as stream:
        stream.write("[[recording]]\n".join([head, *parts]))


def listed(entry):
    return "%-16s %-8s %4d x %-4d %3d samples, reference %5d, %4.1f MB, %4d s of CPU, needs %s\n%16s %s" % (
        entry["name"], entry["renderer"], *entry["size"], entry["samples"], entry["reference"], entry["bytes"] / 1e6,
        entry["seconds"], ", ".join(entry["needs"]) or "nothing more", "", entry["what"])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--names", action="store_true")
    parser.add_argument("--command", metavar="NAME")
    parser.add_argument("--full", nargs=argparse.REMAINDER, metavar="NAME")
    parser.add_argument("--measure", action="store_true")
    options = parser.parse_args()
    if options.measure:
        write_measured()
        return 0
    found = catalogue()
    entries = {entry["name"]: entry for entry in found["recording"]}
    if options.names:
        print(", ".join(entries))
        return 0
    wanted = options.command or (options.full or [None])[0]
    if wanted is None:
        print("\n".join(listed(entry) for entry in found["recording"]))
        return 0
    if wanted not in entries:
        print(one_line("catalogue: '%s' is not in it: use %s" % (wanted, ", ".join(entries))), file=sys.stderr)
        return 2
    entry = entries[wanted]
    if options.command:
        print(small_command(entry))
    else:
        print("\n".join(full_arguments(entry, found["full"], options.full[1:])))
    return 0


if __name__ == "__main__":
    sys.exit(guarded(main, "catalogue"))
