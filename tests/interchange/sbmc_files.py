"""Writes SBMC tiles from the layout alone, with lz4's own frames."""
import struct

import lz4.frame
import numpy as np

ZERO_PDF = np.float32(np.log(1e-8) / 30)


def frame(data):
    packed = lz4.frame.compress(data, block_size=lz4.frame.BLOCKSIZE_MAX64KB, block_linked=True, store_size=False)
    return struct.pack("<i", len(packed)) + packed


def scene(rng, width, height, spp, scaled=True):
    """Physical values [y][x][s][c], and image planes [15][y][x] twice."""
    shape = (height, width, spp)
    draw = lambda *c: rng.random(shape + c, np.float32)
    return {"diffuse": draw(3), "specular": draw(3), "film": draw(2), "lens": draw(2) - np.float32(0.5), "time": draw(), "normal": draw(3) - np.float32(0.5),
            "normal_ns": draw(3), "depth": draw() * 20, "depth_ns": draw() * 20, "visibility": draw(), "hit": (draw() > 0.2).astype("f4"),
            "albedo": draw(3), "albedo_ns": draw(3), "flags": rng.integers(0, 32, shape + (6,)).astype("u2"),
            "means": rng.random((15, height, width), np.float32), "variances": rng.random((15, height, width), np.float32)}


def tile(made, x, y, ts, *, aperture=0.5, radius=3.0, scaled=True, version=20190401, header=(), shift=(0, 0)):
    height, width, spp = made["depth"].shape
    k = np.float32(10 * radius) if scaled else np.float32(1)
    words = [version, ts, width, height, spp, 4096, 27, 30, 6]
    numbers = [2.0 / k, aperture / k, 0.4, radius]
    data = bytearray(struct.pack("<9i4f2i", *words, *numbers, x, y))
    for offset, value in header:
        struct.pack_into("<i", data, offset, value)
    cut = (slice(y, y + ts), slice(x, x + ts))
    image = np.concatenate([made["means"][(slice(None), *cut)], made["variances"][(slice(None), *cut)]])
    out = bytes(data) + frame(np.ascontiguousarray(image, "<f4").tobytes())
    for s in range(spp):
        at = lambda name: made[name][(*cut, s)]
        planes = [at("film")[..., c] + np.float32(shift[c]) for c in range(2)]
        planes += [at("lens")[..., c] * np.float32(aperture / k) for c in range(2)] + [at("time")]
        planes += [at(name)[..., c] for name in ("diffuse", "specular") for c in range(3)]
        planes += [-at(name)[..., c] for name in ("normal", "normal_ns") for c in range(3)]
        planes += [at("depth") / k, at("depth_ns") / k, at("visibility"), at("hit")]
        planes += [at(name)[..., c] for name in ("albedo", "albedo_ns") for c in range(3)]
        pdf = np.full((ts, ts), ZERO_PDF if scaled else 0, np.float32)
        planes += [pdf] * 24 + [np.zeros((ts, ts), np.float32)] * 12
        flags = np.ascontiguousarray(at("flags").transpose(2, 0, 1), "<u2")
        out += frame(np.stack(planes).astype("<f4").tobytes() + flags.tobytes())
    return out


def write_set(folder, made, ts, **options):
    folder.mkdir()
    height, width = made["depth"].shape[:2]
    for y in range(0, height, ts):
        for x in range(0, width, ts):
            (folder / f"{x:04}_{y:04}.bin").write_bytes(tile(made, x, y, ts, **options))
    return folder
