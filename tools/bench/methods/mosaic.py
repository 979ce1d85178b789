"""A large recording with features: mirror images of a small one beside each other, each with its samples in another order.

Neighbouring copies share their border pixels' values, as mirror images do, but not their noise.
"""

import numpy as np

import spool

LAYERS = {"radiance": ("f4", "RGB"), "albedo": ("f2", "RGB"), "normal": ("f2", "XYZ"), "depth": ("f2", "Z")}


def enlarged(values, times, samples=slice(None)):
    """[y][x][s][c] of these samples, `times` copies across and down."""
    rows = []
    for j in range(times):
        row = [np.roll(values[::-1 if j % 2 else 1, ::-1 if i % 2 else 1], 7 * i + 3 * j, axis=2)[:, :, samples] for i in range(times)]
        rows.append(np.concatenate(row, axis=1))
    return np.concatenate(rows, axis=0)


def write_mosaic(source, path, size, spp, block=16):
    with spool.open(source) as small:
        times = size // small.width
        layers = {name: small.read(name) for name in LAYERS}
    with spool.Writer(path, size, size, spp, LAYERS, block_spp=block, sample_order="exchangeable") as writer:
        for begin in range(0, spp, block):  # not all in memory at a time
            writer.write_passes(begin, {name: enlarged(values, times, slice(begin, begin + block)) for name, values in layers.items()})
