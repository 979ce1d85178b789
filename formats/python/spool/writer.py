"""Streaming writer of `.spool` files: IMAG and CHAN at once, then blocks in any order, then the index and the footer.

Memory: one block; `write_passes` keeps at most `block_spp` passes. One thread per writer.
"""
import os
import uuid as uuid_module
from collections.abc import Iterable

import numpy as np

from . import channel, chunk_codec
from . import meta as meta_json
from . import record_layout as layout
from .arguments import choice, convert, flag, mapping, text, whole, wrong
from .arguments import path as path_of
from .error import SpoolError
from .geometry import Geometry, groups_of
from .partial_file import PartialFile
from .record_bytes import footer, record
from .reference_check import check_judges


class Writer:
    """`layers` is {name: (dtype, components[, scope])}, each a group of its own, radiance first; a list of Channel in
    `channels` says more (several layers in a group, semantics). `sample_order`: "renderer" or "exchangeable".
    `compress`: False, True, or the level of zstd that True stands for.

    Used with `with`: leaving the block normally finishes the file, an exception leaves NAME.partial behind.
    """

    def __init__(self, path, width, height, spp, layers=None, *, channels=None, tile_size=64, block_spp=16,
                 sample_order="renderer", meta=None, uuid=None, compress=False, force=False):
        if (layers is None) == (channels is None):
            raise SpoolError("usage", f"{path}: give either layers or channels")
        self.path = path_of("path", path)
        self._file, self._finished = None, False
        try:
            flag("force", force)
            self._compress = compress if isinstance(compress, (bool, np.bool_)) else chunk_codec.level(compress)
            sizes = [whole(name, value) for name, value in (("width", width), ("height", height), ("tile_size", tile_size),
                                                            ("spp", spp), ("block_spp", block_spp))]
            self.channels = _checked(channels if channels is not None else channel.channels_of(layers))
            choice("sample_order", sample_order, layout.SAMPLE_ORDERS)
            group_count = 1 + max((entry.group for entry in self.channels), default=0)
            self.geometry = Geometry(*sizes, group_count, len(self.channels),
                                     sample_order=layout.SAMPLE_ORDERS.index(sample_order))
            self.geometry.validate()
            channel.validate(self.channels, group_count)
            self._groups = groups_of(self.channels)
            self.geometry.validate_groups(self._groups)
            payload = None if meta is None else meta_json.encode(meta)
        except SpoolError as reason:
            raise SpoolError("usage", f"{self.path}: {reason.message}") from None
        self.layers = channel.layers_of(self.channels)
        self.uuid = uuid_module.UUID(bytes=os.urandom(16)) if uuid is None else _uuid(uuid)
        self._dump_id = int.from_bytes(self.uuid.bytes[:8], "little")
        self._entries, self._seen, self._meta_count = [], set(), 0
        self._pending, self._next_pass = {name: [] for name in self.layers}, None
        self._judges = {"reference": None, "reference_variance": None}  # the one that waits for the other
        self._file = PartialFile(path, force)
        head = np.zeros((), layout.FILE_HEADER)
        head["magic"], head["major"], head["minor"] = np.void(layout.MAGIC), layout.MAJOR, layout.MINOR
        head["dump_uuid"] = np.void(self.uuid.bytes)
        try:
            self._file.append(layout.seal(head))
            self._append(b"IMAG", self.geometry.encode())
            self._append(b"CHAN", channel.encode(self.channels))
            if payload is not None:
                self.write_meta(meta)
        except BaseException:
            self._file.close()
            raise

    def __repr__(self):
        g = self.geometry
        return f"<spool.Writer {self.path}: {g.width} x {g.height} pixels, {g.spp} samples each, {', '.join(self.layers)}>"

    def __enter__(self):
        return self

    def __exit__(self, kind, *_):
        if kind is None:
            self.finish()
        else:
            self._file.close()

    def write_block(self, group, tile, begin, block):
        """One DATA record from [c][y][x][s]; `group` is a number, or the name of a layer that is alone in its group."""
        if isinstance(group, str):
            layer = self._layer(group)
            if len(layer.components) != self._groups[layer.group][2]:
                raise self._error(f"layer {group} shares its group: give the group's number and all its channels")
            group = layer.group
        group, tile, begin = (self._whole(name, value) for name, value in (("group", group), ("tile", tile), ("begin", begin)))
        if not 0 <= group < len(self._groups):
            raise self._error(f"no group {group}")
        scope, dtype, channels = self._groups[group]
        if not (0 <= tile < self.geometry.tile_count(scope) and 0 <= begin < self.geometry.sample_count(scope)
                and begin % self.geometry.block_spp == 0):
            raise self._error(f"no block starts at group {group}, tile {tile}, sample {begin}")
        if (group, tile, begin) in self._seen:
            raise self._error(f"block is written twice (group {group}, tile {tile}, sample {begin})")
        shape = self.geometry.block_shape(scope, channels, tile, begin)
        what = f"{self.path}: block of group {group}, tile {tile}, sample {begin}"
        block = convert(block, dtype, what)
        if block.shape != shape:
            raise SpoolError("usage", f"{what}: shape {block.shape} is not {shape}")
        raw = np.ascontiguousarray(block).tobytes()
        codec, filter, stored = layout.CODEC_NONE, layout.FILTER_NONE, raw
        if self._compress:
            level = [] if self._compress is True else [self._compress]
            codec, filter, stored = chunk_codec.compress(raw, dtype.itemsize, *level)
        self._append(b"DATA", stored, raw_bytes=len(raw), codec=codec, filter=filter, group=group, tile=tile,
                     sample_begin=begin, sample_count=shape[3])
        self._seen.add((group, tile, begin))

    def write_passes(self, first, arrays):
        """Whole-image passes from sample `first` on: {layer: [y][x][s][c]} of every layer of scope sample.

        Passes come in order; blocks are written as soon as they are full. One component may leave out its axis.
        """
        names = [name for name, layer in self.layers.items() if layer.scope == "sample"]
        first, arrays = self._whole("first", first), mapping(f"{self.path}: arrays", arrays)
        if set(arrays) != set(names):
            raise self._error(f"passes of {sorted(arrays)} given, {sorted(names)} needed")
        if self._next_pass is None and first % self.geometry.block_spp == 0:
            self._next_pass = first
        if first != self._next_pass:
            raise self._error(f"passes start at {first}, expected {self._next_pass or 0}")
        ready, counts = {}, set()
        for name in names:
            layer = self.layers[name]
            array = convert(arrays[name], layer.dtype, f"{self.path}: layer {name}")
            if array.ndim == 3 and len(layer.components) == 1:
                array = array[..., None]
            height, width, components = self.geometry.height, self.geometry.width, len(layer.components)
            if array.ndim != 4 or (array.shape[:2] + array.shape[3:]) != (height, width, components):
                raise self._error(f"layer {name} has shape {array.shape}, not [y][x][sample][component] of {height} rows, "
                                  f"{width} columns, any number of samples and {components} components")
            ready[name] = array
            counts.add(array.shape[2])
        if len(counts) != 1 or 0 in counts or first + max(counts) > self.geometry.spp:
            given = ", ".join(f"{name} has {array.shape[2]}" for name, array in ready.items())
            raise self._error(f"passes from {first} on: {given}: as many of each, up to the {self.geometry.spp} of the file")
        self._next_pass += counts.pop()
        for name, array in ready.items():
            self._pending[name].append(array)
        self._flush_passes(first)
        for waiting in self._pending.values():
            if waiting:  # the caller may use the array again
                waiting[-1] = waiting[-1].copy()

    def write_pixel(self, layer, array):
        """A layer of scope pixel from [y][x][c]."""
        layer = self._layer(layer, "pixel")
        self._by_group(layer, array, 3)

    def write_pass(self, layer, array):
        """A layer of scope pass from [s][c], all samples at once."""
        layer = self._layer(layer, "pass")
        self._by_group(layer, array, 2)

    def write_meta(self, meta):
        """One more meta record: a dict, or the text of a JSON object that is kept byte for byte."""
        if self._meta_count == layout.MAX_META_RECORDS:
            raise self._error(f"more than {layout.MAX_META_RECORDS} meta records")
        try:
            payload = meta_json.encode(meta)
        except SpoolError as reason:
            raise self._error(reason.message) from None
        self._append(b"meta", payload)
        self._meta_count += 1

    def finish(self):
        """Index, footer, fsync, rename. Blocks may be missing, but a pass that was begun must be whole. Once is enough."""
        if self._finished:
            return
        try:
            waiting = [name for name, arrays in self._pending.items() if arrays]
            if waiting:
                raise self._error(f"passes of {', '.join(waiting)} do not fill a block: give the rest of them")
            at, count, data = self._file.size, len(self._entries), len(self._seen)
            self._append(b"INDX", b"".join(self._entries))
            flags = layout.FLAG_COMPLETE if data == self.geometry.total_blocks(self._groups) else 0
            self._file.append(footer(at, self._file.size + 64, count + 1, data, self._dump_id, flags))
            self._file.finish()
            self._finished = True
        finally:
            self._file.close()

    def discard(self):
        """Nothing of it is kept, NAME.partial neither."""
        self._file.discard()

    def _flush_passes(self, first):
        block_spp, geometry = self.geometry.block_spp, self.geometry
        begin = first // block_spp * block_spp
        while begin < self._next_pass:
            count = min(block_spp, geometry.spp - begin)
            if begin + count > self._next_pass:
                break
            joined = {}
            for name, arrays in self._pending.items():
                if arrays:
                    whole = np.concatenate(arrays, axis=2) if len(arrays) > 1 else arrays[0]
                    joined[name], rest = whole[:, :, :count], whole[:, :, count:]
                    self._pending[name] = [rest] if rest.shape[2] else []
            for group, (scope, _, _) in enumerate(self._groups):
                if scope == "sample":
                    parts = [joined[name] for name, layer in self.layers.items() if layer.group == group]
                    self._write_image(group, begin, parts)
            begin += count

    def _write_image(self, group, begin, parts):
        """All tiles of a group for one block of samples; parts are [y][x][s][c] of its layers."""
        for tile in range(self.geometry.tile_count("sample")):
            x0, y0, x1, y1 = self.geometry.rectangle(tile)
            pieces = [part[y0:y1, x0:x1].transpose(3, 0, 1, 2) for part in parts]
            self.write_block(group, tile, begin, np.concatenate(pieces) if len(pieces) > 1 else pieces[0])

    def _by_group(self, layer, array, ndim):
        array = convert(array, layer.dtype, f"{self.path}: layer {layer.name}")
        if array.ndim == ndim - 1 and len(layer.components) == 1:
            array = array[..., None]
        leading = (self.geometry.height, self.geometry.width) if ndim == 3 else (self.geometry.spp,)
        if array.shape != leading + (len(layer.components),):
            raise self._error(f"layer {layer.name} has shape {array.shape}, not {leading + (len(layer.components),)}")
        if self._pending[layer.name]:
            raise self._error(f"layer {layer.name} is written twice")
        if layer.name in self._judges:
            judges = {**self._judges, layer.name: array}
            if judges["reference"] is not None:  # which says where its variance counts
                check_judges(self.path, *judges.values())
            both = all(judge is not None for judge in judges.values())
            self._judges = dict.fromkeys(judges) if both else {**judges, layer.name: array.copy()}  # the caller may use the array again
        self._pending[layer.name].append(array)
        members = [name for name, other in self.layers.items() if other.group == layer.group]
        if not all(self._pending[name] for name in members):  # the other layers of this group are still to come
            self._pending[layer.name] = [array.copy()]  # the caller may use the array again
            return
        parts = [self._pending[name].pop() for name in members]
        if ndim == 3:
            self._write_image(layer.group, 0, [part[:, :, None] for part in parts])
        else:
            whole = np.concatenate(parts, axis=1).T[:, None, None]
            for begin in range(0, self.geometry.spp, self.geometry.block_spp):
                self.write_block(layer.group, 0, begin, whole[..., begin:begin + self.geometry.block_spp])

    def _append(self, type, stored, raw_bytes=None, **fields):
        if len(self._entries) + 2 > layout.MAX_RECORDS and type != b"INDX":
            raise self._error(f"more than {layout.MAX_RECORDS} records")
        whole, entry = record(type, stored, len(self._entries), self._dump_id, self._file.size, raw_bytes, **fields)
        self._file.append(whole)
        self._entries.append(entry)

    def _layer(self, name, scope=None):
        if name not in self.layers:
            raise self._error(f"no layer {name}: it has {', '.join(self.layers)}")
        layer = self.layers[name]
        if scope is not None and layer.scope != scope:
            raise self._error(f"layer {name} has scope {layer.scope}, not {scope}")
        return layer

    def _whole(self, name, value):
        return whole(f"{self.path}: {name}", value, 64)

    def _error(self, text):
        return SpoolError("usage", f"{self.path}: {text}")


def _checked(channels):
    """Channels whose every value is one; any spelling of a dtype ("f4", np.float32) -> the little-endian dtype of the file."""
    result = []
    if not isinstance(channels, Iterable):
        raise wrong("channels", channels, "no list of Channels")
    for entry in channels:
        if not isinstance(entry, channel.Channel):
            raise wrong("channels", entry, "no Channel")
        text("channel", entry.name)
        whole(f"channel {entry.name}: group", entry.group)
        if not 0 <= whole(f"channel {entry.name}: semantic", entry.semantic) <= layout.MAX_SEMANTIC:
            raise wrong(f"channel {entry.name}: semantic", entry.semantic, f"not 0 to {layout.MAX_SEMANTIC}")
        choice(f"channel {entry.name}: scope", entry.scope, layout.SCOPES)
        try:
            dtype = np.dtype(entry.dtype).newbyteorder("<")
        except (TypeError, ValueError):
            raise wrong(f"channel {entry.name}: dtype", entry.dtype, "no dtype of numpy") from None
        if dtype not in layout.DTYPES.values():
            raise SpoolError("usage", f"channel {entry.name} is {dtype.name}, not float16, float32 or uint32")
        result.append(entry._replace(dtype=dtype))
    return result


def _uuid(value):
    if isinstance(value, uuid_module.UUID):
        return value
    try:
        return uuid_module.UUID(bytes=value) if isinstance(value, bytes) else uuid_module.UUID(text("uuid", value))
    except ValueError:
        raise wrong("uuid", value, "no UUID") from None
