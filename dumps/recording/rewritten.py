"""A recording once more with the same samples and identifier, packed with patience."""
import os

import numpy as np

import spool

LEVEL = 19               # of zstd; reading is as fast as with level 3


def rewrite(path, out, meta=None, pixel_layers=None, block_spp=None, level=LEVEL):
    """Blocks of `block_spp` samples (as they are, or all of a tile where that is 0). meta: a dict, added. pixel_layers: {name: [y][x][c]}
    in the place of those of that name. Returns the bytes of `out`, which is replaced."""
    replaced = pixel_layers or {}
    with spool.open(path) as dump:
        gone = {dump.layers[name].group for name in replaced}
        block_spp = dump.spp if block_spp == 0 else block_spp or dump.block_spp
        with spool.Writer(out, dump.width, dump.height, dump.spp, channels=dump.channels, tile_size=dump.tile_size, block_spp=block_spp,
                          sample_order=dump.sample_order, uuid=dump.uuid.bytes, compress=level, force=True) as writer:
            for record in dump.meta_records:
                writer.write_meta(record)
            if meta:
                writer.write_meta(meta)
            parts = {}
            for group, tile, begin in dump.blocks():
                if group not in gone:
                    parts.setdefault((group, tile, begin // block_spp), []).append(begin)
            for (group, tile, part), begins in sorted(parts.items()):
                blocks = [dump.block(group, tile, begin) for begin in sorted(begins)]
                writer.write_block(group, tile, part * block_spp, np.concatenate(blocks, axis=-1))
            for name, array in replaced.items():
                writer.write_pixel(name, array)
    return os.path.getsize(out)
