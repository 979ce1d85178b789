#!/usr/bin/env python3
"""Rewrites dumps in place so that they are small: one block for all samples of a tile, packed with patience.

    python3 dumps/tiny/squeeze.py dumps/tiny/*.spool

Samples, metadata and uuid stay the same; the bytes of the file do not.
"""
import os
import sys

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "..", "formats", "python"))

import spool  # noqa: E402

LEVEL = 19               # of zstd; reading is as fast as with level 3


def squeeze(path):
    temporary = path + ".squeezed"
    with spool.open(path) as dump:
        with spool.Writer(temporary, dump.width, dump.height, dump.spp, channels=dump.channels,
                          tile_size=dump.tile_size, block_spp=dump.spp, sample_order=dump.sample_order,
                          uuid=dump.uuid.bytes, compress=LEVEL, force=True) as writer:
            for record in dump.meta_records:
                writer.write_meta(record)
            parts = {}
            for group, tile, begin in dump.blocks():
                parts.setdefault((group, tile), []).append((begin, dump.block(group, tile, begin)))
            for (group, tile), blocks in sorted(parts.items()):
                blocks.sort(key=lambda part: part[0])
                writer.write_block(group, tile, 0, np.concatenate([block for _, block in blocks], axis=-1))
    os.replace(temporary, path)
    return os.path.getsize(path)


for name in sys.argv[1:]:
    print("%s %d bytes" % (name, squeeze(name)))
