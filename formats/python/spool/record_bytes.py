"""Records and the footer of a file, as the bytes that are appended."""
import zlib

import numpy as np

from . import record_layout as layout


def record(type, stored, sequence, dump_id, offset, raw_bytes=None, **fields):
    """(bytes of a record that begins at `offset`, its entry in the index)"""
    head = np.zeros((), layout.RECORD_HEADER)
    head["sync"], head["type"] = np.void(layout.SYNC), np.void(type)
    head["sequence"], head["dump_id"] = sequence, dump_id
    head["stored_bytes"], head["raw_bytes"] = len(stored), len(stored) if raw_bytes is None else raw_bytes
    head["payload_crc32"] = zlib.crc32(stored)
    for name, value in fields.items():
        head[name] = value
    sealed = layout.seal(head)
    return (b"".join((sealed, stored, bytes(layout.padded(len(stored)) - len(stored)))),
            offset.to_bytes(8, "little") + sealed[4:60])


def footer(index_offset, file_bytes, record_count, data_record_count, dump_id, flags):
    foot = np.zeros((), layout.FOOTER)
    foot["index_offset"], foot["file_bytes"] = index_offset, file_bytes
    foot["record_count"], foot["data_record_count"] = record_count, data_record_count
    foot["dump_id"], foot["end_magic"], foot["flags"] = dump_id, np.void(layout.END_MAGIC), flags
    return layout.seal(foot)
