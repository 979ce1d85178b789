"""Files with lies in them: a record list that can be changed anywhere and is sealed with right CRCs again."""
import copy
import zlib

import numpy as np

from spool import record_layout as layout


class Container:
    """head, foot: mutable structures; records: [header, payload] without INDX. build() -> bytes of the file."""

    def __init__(self, data):
        self.head = np.frombuffer(data, layout.FILE_HEADER, 1)[0].copy()
        self.foot = np.frombuffer(data[-64:], layout.FOOTER, 1)[0].copy()
        self.records = []
        at = 64
        while True:
            header = np.frombuffer(data, layout.RECORD_HEADER, 1, at)[0].copy()
            if header["type"].tobytes() == b"INDX":
                self.index_header = header
                break
            stored = int(header["stored_bytes"])
            self.records.append([header, data[at + 64:at + 64 + stored]])
            at += 64 + layout.padded(stored)
        # Called with (entries, index header, footer) after they were computed; may change them.
        self.lie_in_index = lambda entries, header, foot: None

    def copy(self):
        return copy.deepcopy(self)

    def insert(self, at, type, payload, **fields):
        header = self.records[0][0].copy()
        header["type"] = np.void(type)
        header["stored_bytes"] = header["raw_bytes"] = len(payload)
        for name, value in fields.items():
            header[name] = value
        self.records.insert(at, [header, payload])
        self.renumber()

    def renumber(self):
        for number, (header, _) in enumerate(self.records):
            header["sequence"] = number

    def build(self):
        parts, at, entries = [layout.seal(self.head)], 64, []
        for header, payload in self.records:
            header["payload_crc32"] = zlib.crc32(payload)
            sealed = layout.seal(header)
            entries.append(at.to_bytes(8, "little") + sealed[4:60])
            parts += [sealed, payload, bytes(layout.padded(len(payload)) - len(payload))]
            at += 64 + layout.padded(len(payload))
        table = np.frombuffer(b"".join(entries), layout.INDEX_ENTRY).copy()
        header, foot = self.index_header.copy(), self.foot.copy()
        header["sequence"] = len(table)
        header["stored_bytes"] = header["raw_bytes"] = 64 * len(table)
        foot["index_offset"], foot["record_count"] = at, len(table) + 1
        foot["file_bytes"] = at + 64 + 64 * len(table) + 64
        foot["data_record_count"] = sum(record[0]["type"].tobytes() == b"DATA" for record in self.records)
        header["payload_crc32"] = zlib.crc32(table.tobytes())
        self.lie_in_index(table, header, foot)
        return b"".join(parts + [layout.seal(header), table.tobytes(), layout.seal(foot)])
