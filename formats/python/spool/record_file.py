"""The container: a complete file as a list of verified records, without knowing what an image is.

Opening follows section 7 of the specification step by step, as far as it needs no geometry. Ordinary reads are
positional and may come from several threads; payload CRCs are verified at each read.
"""
import mmap
import os
import threading
import uuid as uuid_module

import numpy as np

from . import chunk_codec
from . import record_layout as layout
from .arguments import path as path_of
from .error import ADVICE, SpoolError, open_regular

try:
    from ._core import crc32  # of the package with the library: several times as fast
except ImportError:
    from zlib import crc32


class RecordFile:
    """entries: the index, one row per record before INDX; uuid, version; newer_minor: reserved bytes are ignored; file_id:
    what only this file has, whatever its name."""

    def __init__(self, path):
        self.path = path_of("path", path)
        self._lock = threading.Lock()
        self._map = None
        self._file = None
        try:
            self._file = open_regular(self.path, buffering=0)
            status = os.fstat(self._handle())
            self.bytes, self.file_id = status.st_size, (status.st_dev, status.st_ino)
            self._open_header()
            self._open_footer()
            self._open_index()
            self._open_records()
        except OSError as reason:
            self.close()
            raise self.error("io", f"{reason.strerror or reason}: check the path and its permissions") from None
        except SpoolError:
            self.close()
            raise

    def close(self):
        self._map = None  # views handed out keep the mapping itself alive
        if self._file is not None:
            self._file.close()

    def _handle(self):
        if self._file is None or self._file.closed:
            raise self.error("usage", "is closed: open it again")
        return self._file.fileno()

    def error(self, kind, text):
        advice = ADVICE.get(kind)
        return SpoolError(kind, f"{self.path}: {text}: {advice}" if advice else f"{self.path}: {text}")

    def payload(self, row, itemsize=1, scratch=None):
        """Decoded bytes of a record; its CRC is verified. `scratch`, large enough, takes what is read."""
        entry = self.entries[row]
        offset, stored = int(entry["offset"]), int(entry["stored_bytes"])
        payload = self.read_at(offset + 64, stored, scratch)
        if crc32(payload) != int(entry["payload_crc32"]):
            raise self.error("damaged", f"payload of record {row} is damaged (byte {offset + 64})")
        if int(entry["codec"]) == layout.CODEC_NONE:
            return payload
        try:
            return chunk_codec.decompress(payload, int(entry["raw_bytes"]), int(entry["filter"]), itemsize)
        except SpoolError as reason:
            raise self.error(reason.kind, f"{reason.message} (record {row}, byte {offset + 64})") from None

    def pad(self, row):
        """The bytes after a payload, up to the next record."""
        stored = int(self.entries[row]["stored_bytes"])
        return self.read_at(int(self.entries[row]["offset"]) + 64 + stored, layout.padded(stored) - stored)

    def mapped(self, row):
        """The stored bytes of a record as a read-only view of the file; the caller has verified them before."""
        with self._lock:
            if self._map is None:
                self._map = np.frombuffer(mmap.mmap(self._handle(), 0, access=mmap.ACCESS_READ), np.uint8)
            whole = self._map
        entry = self.entries[row]
        at = int(entry["offset"]) + 64
        return whole[at:at + int(entry["stored_bytes"])]

    def read_at(self, offset, count, scratch=None):
        parts = []
        try:
            if scratch is not None and hasattr(os, "preadv"):
                whole = memoryview(scratch)[:count]
                if os.preadv(self._handle(), [whole], offset) == count:
                    return whole
            while count:
                if hasattr(os, "pread"):
                    part = os.pread(self._handle(), count, offset)
                else:
                    with self._lock:
                        self._file.seek(offset)
                        part = self._file.read(count)
                if not part:
                    raise self.error("damaged", f"file ends early (byte {offset})")
                parts.append(part)
                offset += len(part)
                count -= len(part)
        except OSError as reason:
            raise self.error("io", f"{reason.strerror or reason} (byte {offset}): check the disk") from None
        return parts[0] if len(parts) == 1 else b"".join(parts)

    # Steps 1 to 3
    def _open_header(self):
        start = self.read_at(0, min(64, self.bytes))
        if len(start) < 64:
            magic = layout.MAGIC[:len(start)]
            if start[:len(magic)] == magic:
                raise self.error("incomplete", f"file of {self.bytes} bytes is shorter than its header (byte 0)")
            raise self.error("not_spool", "not a .spool file (byte 0)")
        head, sealed = layout.parse(layout.FILE_HEADER, start)
        if start[:8] != layout.MAGIC:
            if layout.parse(layout.FILE_HEADER, layout.MAGIC + start[8:])[1] or _lines_translated(start):
                raise self.error("damaged", "first bytes are damaged, as by a transfer in text mode (byte 0)")
            raise self.error("not_spool", "not a .spool file (byte 0)")
        if not sealed:
            raise self.error("damaged", "file header is damaged (byte 0)")
        self.version = int(head["major"]), int(head["minor"])
        self.newer_minor = self.version[1] > layout.MINOR
        if self.version[0] != layout.MAJOR:
            raise self.error("unsupported", f"format {self.version[0]}.{self.version[1]} (byte 8)")
        unknown = int(head["required_features"]) & ~layout.KNOWN_FEATURES
        if unknown:
            raise self.error("unsupported", f"needs feature bit {(unknown & -unknown).bit_length() - 1} (byte 12)")
        if head["reserved"].tobytes().strip(b"\0") and not self.newer_minor:
            raise self.error("invalid", "reserved bytes of the file header are not zero (byte 32)")
        self.uuid = uuid_module.UUID(bytes=head["dump_uuid"].tobytes())
        self._dump_id = int.from_bytes(self.uuid.bytes[:8], "little")

    # Steps 4 and 5
    def _open_footer(self):
        at = self.bytes - 64
        if at < 64:
            raise self.error("incomplete", "no footer, the recording was cut or never finished (byte 64)")
        foot, sealed = layout.parse(layout.FOOTER, self.read_at(at, 64))
        if foot["end_magic"].tobytes() != layout.END_MAGIC:
            raise self.error("incomplete", f"no footer, the recording was cut or never finished (byte {at})")
        if not sealed:
            raise self.error("damaged", f"footer is damaged (byte {at})")
        count = int(foot["record_count"])
        for wrong, what in (
                (int(foot["dump_id"]) != self._dump_id, "footer belongs to another file"),
                (int(foot["file_bytes"]) != self.bytes, f"footer says {foot['file_bytes']} bytes, the file has {self.bytes}"),
                (not 3 <= count <= layout.MAX_RECORDS, f"footer counts {count} records"),
                (int(foot["index_offset"]) + 64 + 64 * (count - 1) + 64 != self.bytes or int(foot["index_offset"]) % 64,
                 f"index at byte {foot['index_offset']} does not end at the footer"),
                (foot["reserved"].tobytes().strip(b"\0") and not self.newer_minor, "reserved bytes are not zero"),
                (int(foot["flags"]) & ~layout.FLAG_COMPLETE and not self.newer_minor, "unknown flags")):
            if wrong:
                raise self.error("damaged", f"{what} (byte {at})")
        self.foot = foot

    # Step 6
    def _open_index(self):
        at, count = int(self.foot["index_offset"]), int(self.foot["record_count"]) - 1
        head, sealed = layout.parse(layout.RECORD_HEADER, self.read_at(at, 64))
        expected = np.zeros((), layout.RECORD_HEADER)
        for name, value in (("sync", np.void(layout.SYNC)), ("type", np.void(b"INDX")), ("sequence", count),
                            ("dump_id", self._dump_id), ("stored_bytes", 64 * count), ("raw_bytes", 64 * count),
                            ("payload_crc32", head["payload_crc32"]), ("crc32", head["crc32"])):
            expected[name] = value
        if not sealed or head.tobytes() != expected.tobytes():
            raise self.error("damaged", f"header of the index is damaged (byte {at})")
        payload = self.read_at(at + 64, 64 * count)
        if crc32(payload) != int(head["payload_crc32"]):
            raise self.error("damaged", f"index is damaged (byte {at + 64})")
        self.entries = np.frombuffer(payload, layout.INDEX_ENTRY)

    # Step 7
    def _open_records(self):
        entries, end = self.entries, int(self.foot["index_offset"])
        # The bound keeps the running sum far below 2^64; a record beyond it is refused for its size.
        stored = np.minimum(entries["stored_bytes"], np.uint64(layout.MAX_RAW_BYTES + 64))
        ends = np.cumsum(64 + (stored + np.uint64(63)) // np.uint64(64) * np.uint64(64), dtype=np.uint64) + np.uint64(64)
        starts = np.concatenate([np.array([64], np.uint64), ends[:-1]])
        stray = np.flatnonzero((entries["offset"] != starts) | (starts + np.uint64(64) > np.uint64(end)))
        beyond = np.flatnonzero(ends > np.uint64(end))
        count = min([len(entries), *stray[:1].tolist(), *(beyond[:1] + 1).tolist()])
        # A record that does not match its entry says more than an index that does not add up.
        self._check_records(entries[:count], starts[:count])
        if count < len(entries) or beyond.size:
            row = min([*stray[:1].tolist(), *beyond[:1].tolist()])
            raise self.error("damaged", f"index entry does not touch its neighbour (record {row}, byte {int(entries[row]['offset'])})")
        if int(ends[-1]) != end:
            raise self.error("damaged", f"last record does not end at the index (byte {end})")
        self.names = entries["type"].copy().view("S4").ravel()

    def _check_records(self, entries, starts):
        """Each record by itself; the first one in the file with a fault decides, and of its faults the first listed."""
        # One read per header: the headers are the truth, and a stale index must not go unnoticed.
        headers = b"".join([self.read_at(offset, 64) for offset in starts.tolist()])
        table = np.frombuffer(headers, layout.RECORD_HEADER)
        crc = [crc32(headers[at:at + 60]) for at in range(0, len(headers), 64)]
        both = [np.frombuffer(part, np.uint8).reshape(-1, 64) for part in (headers, entries.tobytes())]
        letters = both[1][:, 8:12]
        small = letters | 0x20
        names = letters.copy().view("S4").ravel()
        known = np.isin(names, (b"IMAG", b"CHAN", b"DATA", b"INDX"))
        stored, raw = entries["stored_bytes"], entries["raw_bytes"]
        codec, filter, data = entries["codec"], entries["filter"], names == b"DATA"
        faults = (
            ("damaged", (table["crc32"] != np.array(crc, np.uint32)) | (table["sync"] != np.void(layout.SYNC)), "record header is damaged"),
            ("damaged", (both[0][:, 4:60] != both[1][:, 8:]).any(axis=1), "record header disagrees with the index"),
            ("damaged", entries["sequence"] != np.arange(len(entries), dtype=np.uint64), "sequence number is wrong"),
            ("damaged", entries["dump_id"] != np.uint64(self._dump_id), "record belongs to another file"),
            ("damaged", ((small < ord("a")) | (small > ord("z"))).any(axis=1), "record type is not four letters"),
            ("unsupported", ((letters[:, 0] & 0x20) == 0) & ~known, "unknown critical record type"),
            ("unsupported", (codec > layout.CODEC_ZSTD) | (filter > layout.FILTER_SHUFFLE), "unknown codec or filter"),
            ("damaged", stored == 0, "stored_bytes is 0"),
            ("damaged", stored > layout.MAX_RAW_BYTES, "stored_bytes is larger than 64 MiB"),
            ("damaged", raw > layout.MAX_RAW_BYTES, "raw_bytes is larger than 64 MiB"),
            ("damaged", (codec == 0) & (stored != raw), "plain record has stored_bytes other than raw_bytes"),
            ("damaged", (codec == 1) & (stored >= raw), "compressed record is not smaller than its contents"),
            ("damaged", (codec == 0) & (filter != 0), "filter without codec"),
            ("damaged", ~data & (codec != 0), "codec in a record that is not DATA"),
            ("damaged", ~data & ((entries["group"] != 0) | (entries["tile"] != 0) | (entries["sample_begin"] != 0)
                                 | (entries["sample_count"] != 0)), "tile or samples in a record that is not DATA"))
        found = np.flatnonzero(np.logical_or.reduce([bad for _, bad, _ in faults]))
        if found.size:
            row = int(found[0])
            kind, what = next((kind, what) for kind, bad, what in faults if bad[row])
            raise self.error(kind, f"{what} (record {row}, byte {int(entries[row]['offset'])})")


def _lines_translated(start):
    """The magic after CR LF became LF, or LF became CR LF."""
    return start.startswith((b"\x89SPL\n", b"\x89SPL\r\r\n"))
