"""The folder of the figures: all files of a run appear together, or none does."""

import fcntl
import os
import shutil
import tempfile
from pathlib import Path

from failure import IO, USAGE, Failure


PREFIX, SUFFIX = ".figure.", ".partial"


def _lock(handle):
    """True when this process has the lock of the folder now; never where the file system has none."""
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True


class FigureFolder:
    """Files are made in `staging`, a folder inside, and renamed when the `with` block ends without an error: a link
    of the same name is replaced, not followed."""

    def __init__(self, path, force):
        self.path, self.force, self.names = path, force, []

    def __enter__(self):
        self.made = not self.path.exists()
        try:
            self.path.mkdir(parents=True, exist_ok=True)
            self._remove_abandoned()
            self.staging = Path(tempfile.mkdtemp(prefix=PREFIX, suffix=SUFFIX, dir=self.path))
        except OSError as error:
            raise self._failure(error) from error
        # Held until this process ends, however it does.
        self.lock = os.open(self.staging, os.O_RDONLY)
        _lock(self.lock)
        return self

    def __exit__(self, _, error, __):
        try:
            if error is None:
                for name in self.names:
                    os.replace(self.staging / name, self.path / name)
            elif isinstance(error, OSError):  # of a full disk: no library names the file
                raise self._failure(error) from error
        except OSError as late:
            raise self._failure(late) from late
        finally:
            shutil.rmtree(self.staging, ignore_errors=True)
            os.close(self.lock)
            if self.made and not any(self.path.iterdir()):
                self.path.rmdir()

    def file(self, name):
        """Where to write the file that gets this name; nothing is replaced unasked."""
        target = self.path / name
        if os.path.lexists(target) and (not self.force or (target.is_dir() and not target.is_symlink())):
            raise Failure(f"{target}: exists: choose another folder" + ("" if self.force else " or give --force"), USAGE)
        self.names.append(name)
        return self.staging / name

    def text(self, name, text):
        path = self.file(name)
        path.write_text(text, encoding="utf-8")
        return path

    def pictures(self, name):
        """Where to write the figure of this name, without the endings that draw_curves.save appends."""
        return [self.file(f"{name}.{kind}") for kind in ("pdf", "svg", "png")][0].with_name(name)

    def _remove_abandoned(self):
        """What a killed run left; a run that still works holds its lock."""
        for path in self.path.glob(f"{PREFIX}*{SUFFIX}"):
            if path.is_symlink() or not path.is_dir():
                continue
            handle = os.open(path, os.O_RDONLY | os.O_NOFOLLOW)
            if _lock(handle):
                shutil.rmtree(path, ignore_errors=True)
            os.close(handle)

    def _failure(self, error):
        return Failure(f"{self.path}: {error.strerror or error}: choose another folder", IO)
