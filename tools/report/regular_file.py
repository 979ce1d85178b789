"""Opens a text file of a folder from elsewhere: a FIFO or a device in its place is not waited for."""

import os
import stat

from tools.report.failure import IO, Failure


def open_regular(path, **how):
    """As open() for reading."""
    return open(path, encoding="utf-8", opener=_opened, **how)


def _opened(path, flags):
    handle = os.open(path, flags | os.O_NONBLOCK)  # a FIFO without a writer must not hang us
    if stat.S_ISREG(os.fstat(handle).st_mode):
        return handle
    os.close(handle)
    raise Failure(f"{path}: is no regular file: delete it", IO)
