"""Small and random files for the tests."""
import numpy as np

import spool

DTYPES = ("<f2", "<f4", "<u4")


def tiny(path, compress=False):
    """About 3 KB: two tiles, two blocks, a pixel and a pass group, meta."""
    rng = np.random.default_rng(7)
    radiance = rng.random((3, 9, 3, 3)).astype("f4")
    if compress:
        radiance = np.round(radiance)
    spool.write(path, radiance, film=rng.random((3, 2)), scope={"film": "pass"}, reference=radiance.mean(axis=2),
                meta={"seed": 7}, tile_size=8, block_spp=2, uuid=bytes(range(16)), compress=compress, force=True)
    return open(path, "rb").read()


def random_channels(rng):
    """Group 0 and up to three groups of one to three layers each, any dtype and scope."""
    radiance = rng.choice(DTYPES[:2])
    channels = [spool.Channel(f"radiance.{c}", 0, radiance, 1) for c in "RGB"]
    for group in range(1, int(rng.integers(1, 5))):
        dtype, scope = rng.choice(DTYPES), str(rng.choice(["sample", "pixel", "pass"]))
        for layer in range(int(rng.integers(1, 4))):
            channels += [spool.Channel(f"l{group}_{layer}.{'ABCD'[c]}", group, dtype, int(rng.integers(0, 10)), scope)
                         for c in range(int(rng.integers(1, 5)))]
    return [channel._replace(dtype=np.dtype(str(channel.dtype))) for channel in channels]


def random_file(path, rng, compress, complete=True):
    """Any geometry, blocks in random order, any bit pattern. Returns ({key: block}, channels, uuid)."""
    channels = random_channels(rng)
    width, height = (int(value) for value in rng.integers(1, 40, 2))
    spp, block_spp = (int(value) for value in rng.integers(1, 12, 2))
    writer = spool.Writer(path, width, height, spp, channels=channels, tile_size=int(rng.choice([8, 16, 256])),
                          block_spp=block_spp, sample_order=str(rng.choice(["renderer", "exchangeable"])),
                          meta={"n": 1} if rng.random() < 0.5 else None, uuid=rng.bytes(16), compress=compress, force=True)
    keys = [(group, tile, block * block_spp)
            for group, (scope, _, _) in enumerate(writer._groups)
            for tile in range(writer.geometry.tile_count(scope)) for block in range(writer.geometry.block_count(scope))]
    rng.shuffle(keys)
    if not complete:
        keys = keys[:int(rng.integers(0, len(keys) + 1))]
    blocks = {}
    with writer:
        for group, tile, begin in keys:
            scope, dtype, count = writer._groups[group]
            shape = writer.geometry.block_shape(scope, count, tile, begin)
            bits = rng.integers(0, 256, int(np.prod(shape)) * dtype.itemsize, dtype=np.uint8)
            if rng.random() < 0.5:
                bits &= 1  # compressible
            blocks[group, tile, begin] = bits.view(dtype).reshape(shape)
            writer.write_block(group, tile, begin, blocks[group, tile, begin])
            if rng.random() < 0.05:
                writer.write_meta('{"text": "\u00e4"}')
    return blocks, channels, writer.uuid
