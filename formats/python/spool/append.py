"""A meta record more in a finished file, in place: a large file need not be copied for a remark."""
import contextlib
import errno
import os

from . import meta as meta_json
from . import record_layout as layout
from .arguments import path as path_of
from .error import SpoolError
from .partial_file import fcntl
from .reader import open as open_dump
from .record_bytes import footer, record


def append_meta(path, meta):
    """`meta`: a dict, or the text of a JSON object; keys of the top level replace those of earlier records. Index and footer are
    written anew behind it. Killed in between, the file ends without a footer, and `spool recover` makes it whole."""
    path = path_of("path", path)
    with _alone(path):
        _append(path, meta)


@contextlib.contextmanager
def _alone(path):
    """One process at a time; without locks (Windows, some network folders) the caller has to see to it."""
    with contextlib.ExitStack() as held:
        with contextlib.suppress(OSError):  # the reader has the words for what is wrong with the file
            handle = os.open(path, os.O_RDWR)
            held.callback(os.close, handle)
            if fcntl is not None:
                fcntl.flock(handle, fcntl.LOCK_EX)
        yield


def _append(path, meta):
    with open_dump(path) as dump:
        old, entries, count = dump.footer, dump.index.tobytes(), len(dump.index)
        full, dump_id = len(dump.meta_records) == layout.MAX_META_RECORDS, int(old["dump_id"])
    if full or count + 2 > layout.MAX_RECORDS:
        raise SpoolError("usage", f"{path}: no more records fit: write it anew without some of its remarks")
    try:
        payload = meta_json.encode(meta)
    except SpoolError as reason:
        raise SpoolError("usage", f"{path}: {reason.message}") from None
    at = int(old["index_offset"])
    remark, entry = record(b"meta", payload, count, dump_id, at)
    index, _ = record(b"INDX", entries + entry, count + 1, dump_id, at + len(remark))
    end = footer(at + len(remark), at + len(remark) + len(index) + 64, count + 2, int(old["data_record_count"]), dump_id,
                 int(old["flags"]))
    try:
        with open(path, "r+b", buffering=0) as stream:
            _reserve(stream, int(old["file_bytes"]), len(remark + index + end) + at)
            stream.seek(at)
            stream.write(remark + index + end)
            os.fsync(stream.fileno())
    except OSError as reason:
        raise SpoolError("io", f"{path}: {reason.strerror or reason}: check disk and permissions") from None


def _reserve(stream, before, after):
    """A full disk is met while the old end still stands."""
    try:
        stream.seek(before)
        if stream.write(bytes(after - before)) != after - before:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        os.fsync(stream.fileno())
    except OSError:
        stream.truncate(before)
        raise
