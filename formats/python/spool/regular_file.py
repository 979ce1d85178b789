"""Files that are read: regular ones. A FIFO without a writer is not waited for."""
import os
import stat

from .error import SpoolError


def open_regular(path, mode="rb", **how):
    """As the built-in open, of a file on disk alone."""
    return open(path, mode, opener=_opened, **how)


def _opened(path, flags):
    handle = os.open(path, flags | getattr(os, "O_NONBLOCK", 0))
    if stat.S_ISREG(os.fstat(handle).st_mode):
        return handle
    os.close(handle)
    raise SpoolError("io", f"{path}: not a regular file: check the path")
