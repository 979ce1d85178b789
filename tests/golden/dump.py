"""Small dumps with known values: what the golden files hold."""
import struct
import zlib

import zstandard

from container import Container, Record

F16, F32, U32 = 1, 2, 3
SAMPLE, PIXEL, PASS = 0, 1, 2
FORMAT = {F16: "e", F32: "f", U32: "I"}
SIZE = {F16: 2, F32: 4, U32: 4}

# Bit patterns that a careless copy changes: NaN with payload, signalling NaN, -0, subnormal, infinities, largest.
SPECIAL = {F32: (0x7FC01234, 0x7F800001, 0x80000000, 0x00000001, 0x7F800000, 0xFF800000, 0x7F7FFFFF),
           F16: (0x7E12, 0x7C01, 0x8000, 0x0001, 0x7C00, 0xFC00, 0x7BFF)}

RADIANCE = [("radiance.R", 0, F32, 1, SAMPLE), ("radiance.G", 0, F32, 1, SAMPLE), ("radiance.B", 0, F32, 1, SAMPLE)]


def radiance(dtype=F32):
    return [(name, group, dtype, semantic, scope) for name, group, _, semantic, scope in RADIANCE]


def all_groups(dtype=F32):
    return radiance(dtype) + [
        ("albedo.R", 1, F16, 2, SAMPLE), ("albedo.G", 1, F16, 2, SAMPLE), ("albedo.B", 1, F16, 2, SAMPLE),
        ("depth.Z", 1, F16, 5, SAMPLE), ("film.X", 2, F32, 6, PASS), ("film.Y", 2, F32, 6, PASS),
        ("reference.R", 3, F32, 1, PIXEL), ("reference.G", 3, F32, 1, PIXEL), ("reference.B", 3, F32, 1, PIXEL),
        ("path.flags", 4, U32, 9, SAMPLE)]


def shuffled(raw, size):
    return b"".join(raw[k::size] for k in range(size))


class Dump:
    """width .. sample_order as IMAG; channels: (name, group, dtype, semantic, scope). Values follow from their place."""

    def __init__(self, width=9, height=5, tile_size=8, spp=3, block_spp=2, sample_order=1, channels=None, special=False):
        self.width, self.height, self.tile_size, self.spp, self.block_spp = width, height, tile_size, spp, block_spp
        self.sample_order, self.special = sample_order, special
        self.channels = channels or radiance()
        self.groups = self.channels[-1][1] + 1
        self.tiles_x, self.tiles_y = -(-width // tile_size), -(-height // tile_size)

    def value_bits(self, channel, x, y, s):
        """The stored bits of one value."""
        dtype = self.channels[channel][2]
        if self.special and dtype != U32:
            patterns = SPECIAL[dtype]
            return patterns[(x + 3 * y + 5 * s + channel) % len(patterns)]
        if dtype == U32:
            return x | y << 8 | s << 16 | channel << 24
        plain = (x + 2 * y + 4 * s + 8 * (channel % 8)) / 8  # exact in half and float
        return int.from_bytes(struct.pack("<" + FORMAT[dtype], plain), "little")

    def keys(self):
        """(group, tile, begin, count) of every block, group by group."""
        for group in range(self.groups):
            scope = self.members(group)[0][1][4]
            for tile in range(1 if scope == PASS else self.tiles_x * self.tiles_y):
                if scope == PIXEL:
                    yield group, tile, 0, 1
                    continue
                for begin in range(0, self.spp, self.block_spp):
                    yield group, tile, begin, min(self.block_spp, self.spp - begin)

    def members(self, group):
        return [(number, channel) for number, channel in enumerate(self.channels) if channel[1] == group]

    def raw(self, key):
        group, tile, begin, count = key
        members = self.members(group)
        dtype, scope = members[0][1][2], members[0][1][4]
        x0, y0 = tile % self.tiles_x * self.tile_size, tile // self.tiles_x * self.tile_size
        x1, y1 = min(self.width, x0 + self.tile_size), min(self.height, y0 + self.tile_size)
        if scope == PASS:
            x1, y1 = x0 + 1, y0 + 1
        return b"".join(self.value_bits(number, x, y, s).to_bytes(SIZE[dtype], "little") for number, _ in members
                        for y in range(y0, y1) for x in range(x0, x1) for s in range(begin, begin + count))

    def block(self, key, codec="none"):
        group, tile, begin, count = key
        raw = self.raw(key)
        place = dict(raw=len(raw), group=group, tile=tile, begin=begin, count=count)
        size = SIZE[self.members(group)[0][1][2]]
        packed = zstandard.ZstdCompressor(level=3, write_checksum=True, write_content_size=True).compress(
            shuffled(raw, size) if codec == "zstd-shuffle" else raw)
        if codec == "none" or len(packed) >= len(raw):
            return Record(b"DATA", raw, **place)
        return Record(b"DATA", packed, codec=1, filter=1 if codec == "zstd-shuffle" else 0, **place)

    def imag(self):
        return Record(b"IMAG", struct.pack("<10I24x", self.width, self.height, self.tile_size, self.spp, self.block_spp,
                                           self.groups, len(self.channels), 0, 0, self.sample_order))

    def chan(self):
        return Record(b"CHAN", b"".join(struct.pack("<32s4H24x", name.encode(), group, dtype, semantic, scope)
                                        for name, group, dtype, semantic, scope in self.channels))

    def container(self, codec="none", meta=(), keys=None):
        """codec: a name, or a function of the block number; keys: the blocks to store, in order."""
        every = list(self.keys())
        chosen = every if keys is None else keys
        pick = codec if callable(codec) else lambda number: codec
        records = [self.imag(), self.chan()] + [Record(b"meta", text.encode()) for text in meta]
        records += [self.block(key, pick(number)) for number, key in enumerate(chosen)]
        return Container(records, complete=len(chosen) == len(every))

    def expected(self, container):
        """What a reader must find, as JSON."""
        blocks = [{"group": r.group, "tile": r.tile, "sample_begin": r.begin, "sample_count": r.count, "codec": r.codec,
                   "filter": r.filter, "bytes": r.raw,
                   "crc32": zlib.crc32(self.raw((r.group, r.tile, r.begin, r.count)))}
                  for r in container.records if r.type == b"DATA"]
        return {"width": self.width, "height": self.height, "tile_size": self.tile_size, "spp": self.spp,
                "block_spp": self.block_spp, "sample_order": self.sample_order, "uuid": container.uuid.hex(),
                "channels": [list(channel) for channel in self.channels], "complete": bool(container.flags & 1),
                "meta": [r.payload.decode() for r in container.records if r.type == b"meta"], "blocks": blocks,
                "records": len(container.records) + 1}
