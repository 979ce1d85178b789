"""A third, deliberately plain writer of `.spool` files, only for golden files: formats/spool.md turned into struct.pack.

It shares no code with the two implementations under test, and lets every field lie before the checksums are computed.
"""
import struct
import zlib

MAGIC = b"\x89SPL\r\n\x1a\n"
SYNC = b"\x9eREC"
END = b"SPLEND\r\n"
UUID = bytes(range(16))


def sealed(body):
    assert len(body) == 60
    return body + struct.pack("<I", zlib.crc32(body))


def padded(payload):
    return payload + bytes(-len(payload) % 64)


class Record:
    """One record; attributes that are None are filled in when the file is built."""

    def __init__(self, type, payload, raw=None, codec=0, filter=0, group=0, tile=0, begin=0, count=0):
        self.type, self.payload, self.raw, self.codec, self.filter = type, payload, raw, codec, filter
        self.group, self.tile, self.begin, self.count = group, tile, begin, count
        self.sequence = self.dump_id = self.stored = self.crc = None
        self.sync, self.pad = SYNC, None

    def middle(self, sequence, dump_id):
        """Header bytes 4-59."""
        def given(value, otherwise):
            return otherwise if value is None else value
        size = len(self.payload)
        return self.type + struct.pack(
            "<QQQQIBBHIII", given(self.sequence, sequence), given(self.dump_id, dump_id), given(self.stored, size),
            given(self.raw, size), given(self.crc, zlib.crc32(self.payload)), self.codec, self.filter, self.group,
            self.tile, self.begin, self.count)


class Container:
    """A whole file. `lie_in_entries(list of bytes)` and `lie_in_footer(dict)` may change what was computed."""

    def __init__(self, records, complete=True, uuid=UUID):
        self.records, self.uuid = records, uuid
        self.magic, self.major, self.minor, self.features, self.reserved = MAGIC, 1, 0, 0, bytes(28)
        self.flags = 1 if complete else 0
        self.index = Record(b"INDX", b"")
        self.lie_in_entries = lambda entries: None
        self.lie_in_footer = lambda footer: None

    def build(self):
        dump_id = int.from_bytes(self.uuid[:8], "little")
        out = bytearray(sealed(self.magic + struct.pack("<HHI", self.major, self.minor, self.features) + self.uuid
                               + self.reserved))
        entries = []
        for number, record in enumerate(self.records):
            middle = record.middle(number, dump_id)
            entries.append(struct.pack("<Q", len(out)) + middle)
            pad = padded(record.payload)[len(record.payload):] if record.pad is None else record.pad
            out += sealed(record.sync + middle) + record.payload + pad
        at = len(out)
        self.lie_in_entries(entries)
        self.index.payload = b"".join(entries)
        pad = bytes(-len(self.index.payload) % 64) if self.index.pad is None else self.index.pad
        out += sealed(self.index.sync + self.index.middle(len(self.records), dump_id)) + self.index.payload + pad
        footer = {"index_offset": at, "file_bytes": len(out) + 64, "records": len(self.records) + 1, "dump_id": dump_id,
                  "data": sum(record.type == b"DATA" for record in self.records), "flags": self.flags,
                  "reserved": bytes(8), "end": END}
        self.lie_in_footer(footer)
        out += sealed(struct.pack("<QQQQQI8s8s", *footer.values()))
        return bytes(out)
