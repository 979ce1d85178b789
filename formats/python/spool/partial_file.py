"""An append-only file under the name NAME.partial that becomes NAME when it is complete (section 8, Write)."""
import errno
import os
import time

from .arguments import absolute
from .error import SpoolError

try:
    import fcntl
except ImportError:  # Windows: O_EXCL alone keeps a second writer out
    fcntl = None

_SYNC_BYTES = 256 << 20
_SYNC_SECONDS = 30


class PartialFile:
    """size: bytes of whole records so far. After a write or fsync that failed, or that was interrupted, every further call fails."""

    _handle = None

    def __init__(self, path, force):
        self.path = absolute(os.fspath(path))
        self.name = os.fspath(path)
        self.partial = self.path + ".partial"
        self.size = 0
        self._force = force
        self._failed = None
        self._synced, self._synced_at = 0, time.monotonic()
        if not force and os.path.lexists(self.path):
            raise self.error("usage", "exists: choose another name or give force=True")
        if os.path.exists(self.path) and not os.path.isfile(self.path):  # a device would be lost
            raise self.error("usage", "is no regular file: give the name of a file")
        flags = os.O_RDWR | getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_BINARY", 0)
        try:
            self._handle = os.open(self.partial, flags | (os.O_CREAT if force else os.O_CREAT | os.O_EXCL), 0o666)
        except FileExistsError:
            raise SpoolError("usage", f"{self.name}.partial: exists, another recording runs or was cut: "
                                      "recover or remove it") from None
        except OSError as reason:
            raise self.error("io", f"{reason.strerror or reason}: check the folder and its permissions") from None
        try:
            self._lock()
            if not self._is_partial():  # its writer finished it between the two calls: it is NAME by now
                self.close()
                raise SpoolError("usage", f"{self.name}.partial: another recording wrote it: wait for it")
            os.ftruncate(self._handle, 0)  # a stale partial file, with force
        except OSError as reason:
            self.close()
            if reason.errno in (errno.EAGAIN, errno.EACCES):
                raise SpoolError("usage", f"{self.name}.partial: another recording writes it: wait for it") from None
            raise self.error("io", f"{reason.strerror or reason}: check the folder and its permissions") from None

    def error(self, kind, text):
        return SpoolError(kind, f"{self.name}: {text}")

    def append(self, record):
        """One whole record; after a failure, Ctrl-C too, the file ends where the last whole record ended, and takes no more."""
        self._alive()
        view = memoryview(record)
        try:
            while view:
                written = os.write(self._handle, view)  # Python itself retries EINTR (PEP 475)
                view = view[written:]
        except BaseException as reason:
            self._fail(reason)
            try:
                os.ftruncate(self._handle, self.size)
            except OSError:
                pass
            if not isinstance(reason, OSError):
                raise
            advice = "free space and record again" if reason.errno == errno.ENOSPC else "check the disk"
            raise self.error("io", f"{self._failed} (byte {self.size}): {advice}, whole records are in "
                                   f"{self.name}.partial") from None
        self.size += len(record)
        if self.size - self._synced >= _SYNC_BYTES or time.monotonic() - self._synced_at >= _SYNC_SECONDS:
            self._sync()

    def finish(self):
        """fsync, rename to the final name, fsync of the folder."""
        self._alive()
        self._sync()
        try:
            if not self._force and os.path.lexists(self.path):
                raise self.error("usage", f"appeared during the recording: rename {self.name}.partial")
            if fcntl is None:
                self.close()  # Windows does not rename an open file
            os.replace(self.partial, self.path)
            self._sync_folder()
        except OSError as reason:
            raise self.error("io", f"{reason.strerror or reason}: rename {self.name}.partial by hand") from None
        finally:
            self.close()

    def close(self):
        if self._handle is not None:
            os.close(self._handle)
            self._handle = None

    def discard(self):
        """Of a file that was never begun in earnest: what there is of it goes."""
        if self._handle is not None:
            os.unlink(self.partial)
        self.close()

    def __del__(self):  # its lock goes with a writer that was not closed
        self.close()

    def _lock(self):
        try:
            if fcntl is not None:
                fcntl.flock(self._handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as reason:
            if reason.errno in (errno.EAGAIN, errno.EACCES):
                raise
            # No locks in this file system (NFS, some of FUSE): O_EXCL alone keeps a second writer out.

    def _is_partial(self):
        try:
            own, named = os.fstat(self._handle), os.lstat(self.partial)
        except FileNotFoundError:
            return False
        return os.path.samestat(own, named)

    def _alive(self):
        if self._failed or self._handle is None:
            raise self.error("io", f"not writable after: {self._failed or 'close'}: record again")

    def _fail(self, reason):
        self._failed = getattr(reason, "strerror", None) or str(reason) or type(reason).__name__

    def _sync(self):
        try:
            os.fsync(self._handle)
        except BaseException as reason:
            # Never repeated: the kernel may have dropped the pages and report success the second time.
            self._fail(reason)
            if not isinstance(reason, OSError):  # the index lacks the record that was to be kept
                raise
            raise self.error("io", f"fsync failed, {self._failed}: check the disk, then recover "
                                   f"{self.name}.partial") from None
        self._synced, self._synced_at = self.size, time.monotonic()

    def _sync_folder(self):
        if fcntl is None:
            return
        folder = os.open(os.path.dirname(self.path), os.O_RDONLY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)
