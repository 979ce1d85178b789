"""Strict reader of complete `.spool` files.

Ordinary reads go through the file; `block` hands out a read-only view of a mapping, so the file must not be cut while
such a view is alive.
"""
import os

import numpy as np

from . import channel, meta
from . import record_layout as layout
from .arguments import flag, text, whole
from .block_table import BlockTable
from .error import SpoolError
from .geometry import Geometry, groups_of
from .record_file import RecordFile

_STRIP = 4  # rows that are interleaved at once: what is written stays in a core's cache


def open(path):
    """Opens a complete file; SpoolError when it is NAME.partial, or anything is not as the specification says."""
    dump = Dump(path)
    if dump.path.endswith(".partial"):
        with dump:
            raise dump._records.error("incomplete", "its writer never gave it its name (.partial)")
    return dump


def _again(kind, place, uuid):
    dump = kind(place)
    if dump.uuid == uuid:
        return dump
    with dump:
        raise dump._records.error("usage", "is another recording than the one that was pickled: open it anew")


class Dump:
    """One open file.

    width, height, spp, tile_size, block_spp: ints; sample_order: "renderer" or "exchangeable"; channels: list of
    Channel; layers: {name: Layer}; meta: the merged JSON of all meta records; meta_records: their texts; uuid;
    complete: every tile has all samples of every group.
    """

    def __init__(self, path):
        self._records = RecordFile(path)
        self.path, self.uuid = self._records.path, self._records.uuid
        self._place = os.path.abspath(self.path)
        try:
            self._open_geometry()
            self._table = BlockTable(self._records, self.geometry, self._groups)
            self.complete = self._table.complete
            self.meta, self.meta_records = self._read_meta()
        except SpoolError as reason:
            self.close()
            if reason.message.startswith(self.path + ": "):
                raise
            raise self._records.error(reason.kind, reason.message) from None
        self._verified = set()

    def __repr__(self):
        return f"<spool.Dump {self.path}: {self.width} x {self.height} pixels, {self.spp} samples each, {', '.join(self.layers)}>"

    def __reduce__(self):  # the same file, opened in another process
        return _again, (type(self), self._place, self.uuid)

    def close(self):
        """The file; views that `block` handed out stay."""
        self._records.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def read(self, layer, x0=0, y0=0, x1=None, y1=None, first=0, count=None):
        """Samples [first, first + count) of the pixels [x0, x1) x [y0, y1) -> [y][x][s][c] in the layer's dtype."""
        layer = self._layer(layer, "sample")
        channels = slice(layer.first, layer.first + len(layer.components))
        x0, y0, first = whole("x0", x0), whole("y0", y0), whole("first", first)
        x1, y1 = self.width if x1 is None else whole("x1", x1), self.height if y1 is None else whole("y1", y1)
        count = self.spp - first if count is None else whole("count", count)
        if not (0 <= x0 < x1 <= self.width and 0 <= y0 < y1 <= self.height
                and 0 <= first and 1 <= count <= self.spp - first):
            raise self._records.error("usage", f"pixels {x0},{y0} to {x1},{y1}, samples {first} to {first + count}: "
                                             f"the file has {self.width}x{self.height} pixels, {self.spp} samples")
        size = self.tile_size
        columns = range(x0 // size, (x1 - 1) // size + 1)
        tiles = [ty * self.geometry.tiles_x + tx for ty in range(y0 // size, (y1 - 1) // size + 1) for tx in columns]
        begins = range(first // self.block_spp * self.block_spp, first + count, self.block_spp)
        # Memory is asked for only when the file is known to hold what will fill it.
        rows = [self._row(layer.group, tile, begin) for tile in tiles for begin in begins]
        out = np.empty((y1 - y0, x1 - x0, count, len(layer.components)), layer.dtype)
        # One for all blocks: touching fresh memory takes longer than reading into it.
        scratch = bytearray(int(self._records.entries["stored_bytes"][rows].max()))
        for tile in tiles:
            tx0, ty0, tx1, ty1 = self.geometry.rectangle(tile)
            cx0, cy0, cx1, cy1 = max(tx0, x0), max(ty0, y0), min(tx1, x1), min(ty1, y1)
            for begin in begins:
                block = self._load(self._row(layer.group, tile, begin), scratch)
                s0, s1 = max(begin, first), min(begin + block.shape[3], first + count)
                part = block[channels, cy0 - ty0:cy1 - ty0, cx0 - tx0:cx1 - tx0, s0 - begin:s1 - begin]
                target = out[cy0 - y0:cy1 - y0, cx0 - x0:cx1 - x0, s0 - first:s1 - first]
                for y in range(0, part.shape[1], _STRIP):
                    for number, plane in enumerate(part):  # long runs, where a transposed copy goes three values at a time
                        target[y:y + _STRIP, ..., number] = plane[y:y + _STRIP]
        return out

    def pixel(self, layer):
        """A layer of scope pixel -> [y][x][c]."""
        layer = self._layer(layer, "pixel")
        channels = slice(layer.first, layer.first + len(layer.components))
        rows = [self._row(layer.group, tile, 0) for tile in range(self.geometry.tile_count("pixel"))]
        out = np.empty((self.height, self.width, len(layer.components)), layer.dtype)
        for tile, row in enumerate(rows):
            x0, y0, x1, y1 = self.geometry.rectangle(tile)
            out[y0:y1, x0:x1] = self._load(row)[channels, :, :, 0].transpose(1, 2, 0)
        return out

    def passes(self, layer):
        """A layer of scope pass -> [s][c]."""
        layer = self._layer(layer, "pass")
        channels = slice(layer.first, layer.first + len(layer.components))
        rows = [self._row(layer.group, 0, begin) for begin in range(0, self.spp, self.block_spp)]
        return np.concatenate([self._load(row)[channels, 0, 0].T for row in rows])

    def block(self, group, tile, begin, copy=False):
        """One DATA record -> read-only [c][y][x][s]: a view of the file when it is stored raw and no copy is wanted, else decoded.

        A view is lost with its file: when that is cut meanwhile, touching the view ends the process (SIGBUS). A copy is
        read and verified at once.
        """
        if isinstance(group, str):
            group = self._layer(group).group
        row = self._row(whole("group", group), whole("tile", tile), whole("begin", begin))
        entry = self._records.entries[row]
        if flag("copy", copy) or int(entry["codec"]) != layout.CODEC_NONE:
            return self._load(row)
        if row not in self._verified:
            self._records.payload(row)  # mapped bytes are verified once, before the view is handed out
            self._verified.add(row)
        return self._shaped(row, self._records.mapped(row))

    def has_block(self, group, tile, begin):
        return self._table.find(whole("group", group), whole("tile", tile), whole("begin", begin)) is not None

    def blocks(self):
        """(group, tile, first sample) of every DATA record, in file order."""
        entries = self._records.entries[self._table.rows]
        return list(zip(entries["group"].tolist(), entries["tile"].tolist(), entries["sample_begin"].tolist()))

    @property
    def index(self):
        """Entries of all records but the index, as the file holds them."""
        return self._records.entries

    @property
    def footer(self):
        return self._records.foot

    @property
    def record_count(self):
        """All records, the index included."""
        return len(self._records.entries) + 1

    def every_record(self):
        """(record number, (group, tile, first sample) or None) of every record but the index, in file order."""
        keys = dict(zip(self._table.rows.tolist(), self.blocks()))
        return [(row, keys.get(row)) for row in range(len(self._records.entries))]

    def verify(self, row):
        """Payload CRC, decoding and pad bytes of one record."""
        self._load(row) if self._records.names[row] == b"DATA" else self._records.payload(row)
        if self._records.pad(row).strip(b"\0"):
            raise self._records.error("damaged", f"pad bytes are not zero (record {row})")

    def _open_geometry(self):
        records = self._records
        if records.names[:2].tolist() != [b"IMAG", b"CHAN"] or np.isin(
                records.names[2:], (b"IMAG", b"CHAN", b"INDX")).any():
            raise records.error("damaged", "IMAG and CHAN are not records 0 and 1 alone")
        if int(records.entries[0]["raw_bytes"]) != 64:
            raise records.error("damaged", "IMAG is not 64 bytes")
        entries, odd = divmod(int(records.entries[1]["raw_bytes"]), 64)
        if odd or entries > layout.MAX_CHANNELS:
            raise records.error("damaged", "CHAN is not at most 64 entries of 64 bytes")
        payloads = records.payload(0), records.payload(1)
        self.geometry = geometry = Geometry.decode(payloads[0], records.newer_minor)
        if entries != geometry.channel_count:
            raise records.error("invalid", f"IMAG says {geometry.channel_count} channels, CHAN has {entries}")
        self.channels = channel.decode(payloads[1], geometry.group_count, records.newer_minor)
        self.layers = channel.layers_of(self.channels)
        self._groups = groups_of(self.channels)
        geometry.validate_groups(self._groups)
        self.width, self.height, self.spp = geometry.width, geometry.height, geometry.spp
        self.tile_size, self.block_spp = geometry.tile_size, geometry.block_spp
        self.sample_order = layout.SAMPLE_ORDERS[geometry.sample_order]

    def _read_meta(self):
        merged, texts = {}, []
        rows = np.flatnonzero(self._records.names == b"meta").tolist()
        sizes = self._records.entries["raw_bytes"][rows]
        if len(rows) > layout.MAX_META_RECORDS:
            raise self._records.error("damaged", f"{len(rows)} meta records are more than {layout.MAX_META_RECORDS}")
        if ((sizes < layout.MIN_META_BYTES) | (sizes > layout.MAX_META_BYTES)).any():
            raise self._records.error("damaged", "a meta record is smaller than 2 bytes or larger than 1 MiB")
        for row in rows:
            payload = self._records.payload(row)
            try:
                merged.update(meta.decode(payload))
            except SpoolError as reason:
                raise self._records.error(reason.kind, f"{reason.message} (record {row})") from None
            texts.append(payload.decode("utf-8"))
        return merged, texts

    def _layer(self, name, scope=None):
        if text("layer", name) not in self.layers:
            raise self._records.error("usage", f"no layer {name}: it has {', '.join(self.layers)}")
        layer = self.layers[name]
        if scope is not None and layer.scope != scope:
            call = {"sample": "read", "pixel": "pixel", "pass": "passes"}[layer.scope]
            raise self._records.error("usage", f"layer {name} has scope {layer.scope}: use {call}()")
        return layer

    def _row(self, group, tile, begin):
        row = self._table.find(group, tile, begin)
        if row is None:
            raise self._records.error("absent", f"nothing recorded (group {group}, tile {tile}, sample {begin})")
        return row

    def _load(self, row, scratch=None):
        dtype = self._groups[int(self._records.entries[row]["group"])][1]
        return self._shaped(row, np.frombuffer(self._records.payload(row, dtype.itemsize, scratch), np.uint8))

    def _shaped(self, row, data):
        entry = self._records.entries[row]
        scope, dtype, channels = self._groups[int(entry["group"])]
        shape = self.geometry.block_shape(scope, channels, int(entry["tile"]), int(entry["sample_begin"]))
        block = data.view(dtype).reshape(shape)
        block.flags.writeable = False
        return block
